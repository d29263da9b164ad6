#include "schuler/filter/integrity/gate.h"

#include <cmath>

namespace schuler::filter {

GateDecision decide(GateState& state, const GateLimits& limits, Time time, int dof, double nis, const Eigen::Vector3d& innovation,
                    const Eigen::Vector3d& measurement_sigma, double drift_sigma) {
    if (nis <= limits.chi_square[dof]) {
        state.run = 0;
        return GateDecision::Accept;
    }
    // Rejected measurements are mutually consistent if the change of their innovations is explained by their noise and by the
    // drift of the estimate between them, or continues as before (an estimate captured by an outlier has a wrong velocity not
    // reflected in its covariance): the estimate is then in error.
    const double dt = (time - state.last).seconds();
    const double tolerance = 4.0 * std::sqrt(2.0) * measurement_sigma.maxCoeff() + 4.0 * drift_sigma * dt;
    const Eigen::Vector3d change = innovation - state.innovation;
    const double allowed = tolerance + 0.1 * innovation.norm();
    const bool agrees =
        state.run > 0 && (change.norm() < allowed || (state.run > 1 && (change - dt * state.rate).norm() < allowed));
    state.rate = state.run > 0 && dt > 0.0 ? Eigen::Vector3d(change / dt) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    if (!agrees) {
        state.run = state.run > 0 ? 1 : 0;  // the last one and this one may start a new run
        state.since = state.run > 0 ? state.last : time;
    }
    ++state.run;
    state.last = time;
    state.innovation = innovation;
    if (state.run >= limits.recovery_count && (time - state.since).seconds() >= limits.recovery_time) {
        state.run = 0;
        return GateDecision::Recover;
    }
    return GateDecision::Reject;
}

}  // namespace schuler::filter
