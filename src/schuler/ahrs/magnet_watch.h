// A magnet on the sensor, or none? The heading channel expects a small hard iron, which is right for most logs and lets it trust the
// field at once. Beside it runs a second one that expects a magnet. Which is right the samples say, as soon as the sensor turns: each
// channel keeps count of how probable they were to it, and what the second gains is taken over once it is clearly ahead.
#pragma once

#include "schuler/ahrs/heading_channel.h"

#include <optional>

namespace schuler::ahrs {

class MagnetWatch {
public:
    MagnetWatch(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis);

    /// Before the heading channel closes a block.
    void share(const HeadingChannel& heading);
    /// After it has: the second channel closes the block too; `heading` may become what that one believes.
    void close(HeadingChannel& heading, const Block& block, const Eigen::Vector3d& bias, Counters& counters);

private:
    HeadingSettings settings_;
    std::optional<HeadingChannel> magnet_;
    double begin_ = 0.0;                         ///< evidence of the heading channel when the second one began
    double age_ = 0.0;                           ///< s, of the second, or since the last
};

}  // namespace schuler::ahrs
