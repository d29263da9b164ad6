// GNSS position and velocity at the antenna.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Which of north, east, down take part.
struct Components {
    bool north = true, east = true, down = true;
    [[nodiscard]] bool operator[](int i) const { return i == 0 ? north : i == 1 ? east : down; }
};

/// Antenna position against a measured geodetic position; variance in m^2 (NED). math.md 5.3 with u = each axis. Where the latency is a
/// state, the turning of the lever arm during it is left out.
[[nodiscard]] Measurement gnss_position(const Estimate& estimate, const Geodetic& measured, const Eigen::Vector3d& variance,
                                        const Eigen::Vector3d& lever_arm_b, Components use);

/// Antenna velocity against a measured north-east-down velocity; variance in m^2/s^2. latency: the state that its
/// latency's error is, or -1; the acceleration is taken without its dependence on the attitude.
[[nodiscard]] Measurement gnss_velocity(const Estimate& estimate, const Eigen::Vector3d& measured,
                                        const Eigen::Vector3d& variance, const Eigen::Vector3d& lever_arm_b, int latency,
                                        Components use);

}  // namespace schuler::filter
