// Faults of one channel of a scenario as functions of time.
#pragma once

#include "schuler/math/random.h"
#include "schuler/sim/simulate.h"

#include <vector>

namespace schuler::sim {

class ChannelFaults {
public:
    ChannelFaults(const Scenario& scenario, Channel channel);

    /// Error of the position (receiver: north, east, down) or of the height (barometer: the first component) at t seconds. Draws
    /// noise: must be called once per sample.
    [[nodiscard]] Eigen::Vector3d offset(double t);
    /// Error of the receiver's velocity.
    [[nodiscard]] Eigen::Vector3d velocity_offset(double t) const;
    /// Mean error of the gyros, of the accelerometers.
    [[nodiscard]] Eigen::Vector3d sensor_offset(FaultKind kind, double t) const;
    [[nodiscard]] bool any(FaultKind kind, double t) const;

private:
    std::vector<Fault> faults_;  ///< of the channel, directions normalised to unit vectors
    math::Random random_;
};

}  // namespace schuler::sim
