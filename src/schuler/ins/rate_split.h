// Paper A's strapdown algorithm in three rates (section 1.3, equations 1.3.6 to 1.3.14): for comparison with step_n.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/ins/integrators.h"

#include <Eigen/Core>

namespace schuler::ins::paper_a {

/// Number of fast steps per medium step, and of medium steps per slow step. 1 and 1: all at the rate of the increments.
struct RateSplit {
    int fast_per_medium = 4;
    int medium_per_slow = 5;
};

/// The state of the split algorithm, in the paper's axes (north-up-east, forward-up-right), with the values held by slower rates.
/// Held values are on average half a slow period old: the algorithm is of first order in that period.
struct SplitState {
    Time time;
    Geodetic position;
    Eigen::Vector3d v_nhe = Eigen::Vector3d::Zero();  ///< m/s
    Angles angles{0.0, 0.0, 0.0};
    Eigen::Vector3d w_rel = Eigen::Vector3d::Zero();         ///< transport rate in local level, rad/s (1.3.12)
    Eigen::Vector3d w_earth = Eigen::Vector3d::Zero();       ///< the Earth's rate in local level, rad/s (1.3.12)
    Eigen::Vector3d g_nhe = Eigen::Vector3d::Zero();         ///< gravity, m/s^2
    Eigen::Vector3d w_level_b = Eigen::Vector3d::Zero();     ///< rate of local level in body axes, rad/s (1.3.13)
    Eigen::Matrix3d B_medium = Eigen::Matrix3d::Identity();  ///< B at the last medium step
    Eigen::Vector3d dv_b = Eigen::Vector3d::Zero();          ///< velocity increments since then, body axes, m/s
    Eigen::Vector3d v_slow = Eigen::Vector3d::Zero();        ///< velocity at the last slow step, m/s
    double since_medium = 0.0;                               ///< s
    double since_slow = 0.0;                                 ///< s
    int fast_steps = 0, medium_steps = 0;
};

[[nodiscard]] SplitState split_from(const earth::Earth& earth, const NavState& state);
[[nodiscard]] NavState nav_state_of(const SplitState& state);

/// Fast: rate relative to local level (1.3.6), angles (1.3.7). Increment in the program's body axes; no coning correction, as in
/// the paper.
[[nodiscard]] SplitState fast_step(const SplitState& state, const ImuIncrement& increment);
/// Medium: acceleration through the mean of B at both ends (1.3.9), velocity (1.3.10) with the Coriolis signs reversed
/// (math.md E2.21).
[[nodiscard]] SplitState medium_step(const SplitState& state);
/// Slow: position (1.3.11) by the mean velocity, rates of local level (1.3.12), (1.3.13) and gravity from `earth` in place of the
/// series (1.3.14), which is in earth/paper_series.h.
[[nodiscard]] SplitState slow_step(const earth::Earth& earth, const SplitState& state);

/// Processes one increment: the fast step, and the slower ones when due.
[[nodiscard]] SplitState split_step(const earth::Earth& earth, const SplitState& state, const ImuIncrement& increment,
                                    const RateSplit& split);

}  // namespace schuler::ins::paper_a
