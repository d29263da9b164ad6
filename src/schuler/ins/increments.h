// From raw IMU increments to rotation vectors and velocity increments free of coning and sculling error.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <span>

namespace schuler::ins {

/// Input of a mechanization step: the motion of the body over (time - dt, time].
struct CompensatedIncrement {
    Time time;
    double dt;              ///< s
    Eigen::Vector3d theta;  ///< rotation vector of the body over the step (including coning), rad
    Eigen::Vector3d dv;     ///< integral of specific force in body axes AT THE START of the step (including sculling), m/s
};

/// Number of raw increments per step and the cross products that correct them. Beside each: the remaining drift under
/// classical coning relative to the coning drift itself, leading order in lambda = coning frequency (rad/s) x raw interval.
enum class IncrementAlgorithm {
    OneSample,              ///< no coning or sculling correction, exact for constant rates; lambda^2/6
    OneSamplePlusPrevious,  ///< corrected with the previous raw increment; lambda^4/30
    TwoSample,              ///< lambda^4/30
    ThreeSample,            ///< lambda^6/140 (Miller 1983)
    FourSample,             ///< lambda^8/630
};

/// Raw increments per step: 1 to 4 (OneSamplePlusPrevious: 1, the previous one is not consumed).
[[nodiscard]] int samples_per_step(IncrementAlgorithm algorithm);

/// One-sample-plus-previous compensation (P. G. Savage, "Strapdown inertial navigation integration algorithm design", parts 1
/// and 2, J. Guidance, Control, and Dynamics 21, 1998): coning 1/12 dtheta_prev x dtheta and sculling
/// 1/12 (dtheta_prev x dv + dv_prev x dtheta); rotation of the specific force exact for constant rates. Local error of the
/// fourth order in dt for smooth motion.
/// `previous` ends where `current` starts. Its length may differ: the linear motion determined by both is used. previous.dt <= 0
/// means there is none (at the start, or after a gap): constant rates over `current` are assumed.
/// current.dt > 0; |dtheta| below 1 rad for full accuracy (relative error 1e-9 there, 1e-13 below 0.3 rad).
[[nodiscard]] CompensatedIncrement compensate(const ImuIncrement& previous, const ImuIncrement& current);

/// One step from consecutive raw increments, oldest first: samples_per_step() of them, or for OneSamplePlusPrevious two
/// (previous, current). The coefficients are optimal for classical coning (R. B. Miller, "A new strapdown attitude
/// algorithm", J. Guidance 6, 1983; M. B. Ignagni, "Optimal strapdown attitude integration algorithms", J. Guidance 13, 1990),
/// spread symmetrically in time; sculling by the equivalence of K. M. Roscoe (J. Guidance 24, 2001). The derivation is beside the
/// code. Intervals must be equal within 1 %; otherwise the samples are compensated individually with a neighbour and combined.
/// Allocates nothing.
/// @throws Error(Input) if the number of samples does not match the algorithm.
[[nodiscard]] CompensatedIncrement compensate(std::span<const ImuIncrement> samples, IncrementAlgorithm algorithm);

/// Two consecutive steps combined: rotations composed, the second velocity increment resolved in the axes at the first's start.
/// Exact. The combined rotation must stay below pi.
[[nodiscard]] CompensatedIncrement combined(const CompensatedIncrement& first, const CompensatedIncrement& second);

}  // namespace schuler::ins
