// Gating of a measurement channel with recovery: a consistent run of rejected fixes is finally accepted, an isolated cluster not.
#pragma once

#include "schuler/core/time.h"

#include <Eigen/Core>

namespace schuler::filter {

/// Memory of one channel; plain and copyable.
struct GateState {
    int run = 0;   ///< consecutive rejected, mutually consistent measurements
    Time since{};  ///< time of the first of them
    Time last{};
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();  ///< of the last of them
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();        ///< change per second from the one before; zero for the first
};

enum class GateDecision { Accept, Reject, Recover };

struct GateLimits {
    double chi_square[4] = {0, 0, 0, 0};  ///< limit of the normalised innovation squared for 1, 2, 3 degrees of freedom
    double recovery_time = 10.0;          ///< s
    int recovery_count = 10;
};

/// Decides on one measurement. innovation, measurement_sigma: its used components first, unused ones zero; drift_sigma: rate at
/// which the estimate may drift (unit/s, one sigma). Updates the memory.
[[nodiscard]] GateDecision decide(GateState& state, const GateLimits& limits, Time time, int dof, double nis,
                                  const Eigen::Vector3d& innovation, const Eigen::Vector3d& measurement_sigma,
                                  double drift_sigma);

}  // namespace schuler::filter
