// GNSS position and velocity at the antenna.
#pragma once

#include "schuler/filter/measurement/measurement.h"

namespace schuler::filter {

/// Selection of north, east, down components.
struct Components {
    bool north = true, east = true, down = true;
    [[nodiscard]] bool operator[](int i) const { return i == 0 ? north : i == 1 ? east : down; }
};

/// Antenna position compared with a measured geodetic position; variance in m^2 (NED). math.md 5.3 with u = each axis. If the
/// latency is a state, acceleration and rate during it are constant; the dependence of the acceleration on attitude is neglected.
[[nodiscard]] Measurement gnss_position(const Estimate& estimate, const Geodetic& measured, const Eigen::Vector3d& variance,
                                        const Eigen::Vector3d& lever_arm_b, Components use);

/// Antenna velocity compared with a measured north-east-down velocity; variance in m^2/s^2. latency_state: index of the
/// state of the latency error, or -1; the unit's acceleration and the antenna's turning about it are constant during it, and the
/// dependence of the former on attitude is neglected.
[[nodiscard]] Measurement gnss_velocity(const Estimate& estimate, const Eigen::Vector3d& measured,
                                        const Eigen::Vector3d& variance, const Eigen::Vector3d& lever_arm_b, int latency_state,
                                        Components use);

}  // namespace schuler::filter
