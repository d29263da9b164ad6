// Ideal output of an inertial measurement unit on a truth path: inverse kinematics, never a mechanization.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>

namespace schuler::sim {

/// Angular rate of the body relative to inertial space and specific force, body axes, rad/s and m/s^2.
struct InertialInput {
    Eigen::Vector3d w_ib_b;
    Eigen::Vector3d f_b;
};

/// w_ib_b = w_nb_b + C_bn (w_ie_n + w_en_n), f_b = C_bn (dv + (2 w_ie_n + w_en_n) x v - g_n); Groves 2013, section 5.4; paper A,
/// (4.2.3) in other axes.
[[nodiscard]] InertialInput inertial_input(const earth::Earth& earth, const Kinematics& kinematics);

/// Angular rate of the body relative to the local level in body axes from the rates of roll, pitch, heading (rad/s).
[[nodiscard]] Eigen::Vector3d body_rate(const Eigen::Vector3d& rpy, const Eigen::Vector3d& rpy_rate);

/// Integrals of both over (from, to], seconds of the path: the output of incremental gyros and accelerometers.
/// Four-point Gauss-Legendre: relative error (w dt)^8 / 2e9 of a motion at w rad/s.
struct ExactIncrement {
    Eigen::Vector3d dtheta;  ///< rad
    Eigen::Vector3d dv;      ///< m/s
};
[[nodiscard]] ExactIncrement exact_increment(const earth::Earth& earth, const TruthPath& path, double from, double to);

}  // namespace schuler::sim
