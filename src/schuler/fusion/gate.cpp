#include "schuler/fusion/gate.h"

#include <cmath>

namespace schuler::fusion {

GateDecision decide(GateState& state, const GateLimits& limits, Time time, int dof, double nis, const Eigen::Vector3d& innovation,
                    const Eigen::Vector3d& measurement_sigma, double drift_sigma) {
    if (nis <= limits.chi_square[dof]) {
        state.run = 0;
        return GateDecision::Accept;
    }
    // Two rejected measurements agree with each other when the change of their innovations is explained by their noise and by
    // the drift of the estimate between them: then it is the estimate that is off.
    const double dt = (time - state.last).seconds();
    const double tolerance = 4.0 * std::sqrt(2.0) * measurement_sigma.maxCoeff() + 4.0 * drift_sigma * dt;
    const bool agrees = state.run > 0 && (innovation - state.innovation).norm() < tolerance + 0.1 * innovation.norm();
    if (!agrees) {
        state.run = 0;
        state.since = time;
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

}  // namespace schuler::fusion
