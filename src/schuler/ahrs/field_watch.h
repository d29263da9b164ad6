// Tests of hypotheses about the field: a magnet on the sensor, or a change of place. The heading channel assumes a small hard
// iron and a constant local field, which is correct for most logs and allows immediate use of the field. From the start a second
// channel that assumes a magnet runs in parallel, and in a lasting disturbance a third that assumes a new place. The samples
// discriminate between them as soon as the sensor turns: each channel accumulates its likelihood, and one that is clearly ahead
// replaces the estimate. If two cannot be separated for long, the uncertainty of the heading channel is increased to cover both.
#pragma once

#include "schuler/ahrs/heading_channel.h"

#include <optional>

namespace schuler::ahrs {

class FieldWatch {
public:
    FieldWatch(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis);

    /// Before the heading channel closes a block.
    void share(const HeadingChannel& heading);
    /// After it has done so: the other channels close the block too; `heading` may adopt their estimate.
    void close(HeadingChannel& heading, const Block& block, const Eigen::Vector3d& bias, Counters& counters);

private:
    HeadingSettings settings_;
    std::optional<HeadingChannel> magnet_, place_;
    double begin_ = 0.0;   ///< evidence of the heading channel when the others started
    double age_ = 0.0;     ///< s, of the others, or since the last ones
    double turned_ = 0.0;  ///< rad, since the third started
};

}  // namespace schuler::ahrs
