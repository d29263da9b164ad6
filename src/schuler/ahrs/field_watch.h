// A magnet on the sensor, or none; the same place, or another? The heading channel expects a small hard iron and a room that stays as it
// is, which is right for most logs and lets it trust the field at once. Beside it runs from the start a second one that expects a magnet,
// and in a disturbance that lasts a third that expects another room. Which is right the samples say as soon as the sensor turns: each
// channel keeps count of how probable they were to it, and the one that is clearly ahead is taken over. Where two are, and nothing tells
// them apart for long, the heading channel is opened for both.
#pragma once

#include "schuler/ahrs/heading_channel.h"

#include <optional>

namespace schuler::ahrs {

class FieldWatch {
public:
    FieldWatch(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis);

    /// Before the heading channel closes a block.
    void share(const HeadingChannel& heading);
    /// After it has: the other channels close the block too; `heading` may take over their estimate.
    void close(HeadingChannel& heading, const Block& block, const Eigen::Vector3d& bias, Counters& counters);

private:
    HeadingSettings settings_;
    std::optional<HeadingChannel> magnet_, place_;
    double begin_ = 0.0;   ///< evidence of the heading channel when the others began
    double age_ = 0.0;     ///< s, of the others, or since the last
    double turned_ = 0.0;  ///< rad, since the third began
};

}  // namespace schuler::ahrs
