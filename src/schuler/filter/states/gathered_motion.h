// What the inertial unit has done since the covariance was propagated last, as the integrals of which the transition is made.
//
// At the rate of the unit only these are kept up; the covariance follows in one step when a measurement or an output wants it. Within
// such a span (a tenth of a second at most) the Earth's part of the dynamics is constant to 1e-6 of its effect, while specific force and
// attitude are integrated sample by sample, so that the transition is that of the product of all steps.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/filter/states/layout.h"
#include "schuler/ins/error_model.h"

#include <Eigen/Core>

namespace schuler::filter {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Seconds that a transition is gathered over at most.
inline constexpr double longest_span = 0.1;

/// Two-sided densities of what drives the biases of the inertial sensors.
struct BiasNoise {
    double gyro_bias_psd = 0.0;   ///< rad^2/s^3
    double accel_bias_psd = 0.0;  ///< m^2/s^5
};

/// A plain copyable struct. Vectors and matrices are in the axes of the mechanization's frame.
struct GatheredMotion {
    using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 9>;

    double time = 0.0;                                      ///< s
    double distance = 0.0;                                  ///< m (or s) of the way, where the disturbance of gravity is a state
    Eigen::Vector3d force = Eigen::Vector3d::Zero();        ///< integral of specific force, m/s
    Eigen::Vector3d force_twice = Eigen::Vector3d::Zero();  ///< its integral, m
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();         ///< integral of C: attitude by gyro bias, s
    Eigen::Matrix3d turn_twice = Eigen::Matrix3d::Zero();   ///< its integral, s^2
    Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero();  ///< by gyro bias, m
    Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero();  ///< m s
    /// The same by scale factors and misalignments, scale first; no columns where they are no states.
    Columns gain_turn, gain_velocity_by_gyro, gain_position_by_gyro, gain_velocity_by_accel, gain_position_by_accel;
    double gyro_variance = 0.0, accel_variance = 0.0;  ///< integrals of the white noises' densities, rad^2, m^2/s^2

    GatheredMotion() = default;
    explicit GatheredMotion(const Layout& layout);
    void reset();
    /// Whether a step of `next` s would make the span longer than it may be, by more than rounding.
    [[nodiscard]] bool is_full(double next) const { return time > 0.0 && time + next > longest_span + 1e-9; }

    /// One step: `C` the mean attitude over it, df its velocity increment in the frame's axes (m/s), w_b and f_b the mean rate and
    /// specific force in body axes that the sensors' gain errors act on.
    void add(const Layout& layout, double dt, const Eigen::Matrix3d& C, const Eigen::Vector3d& df, const Eigen::Vector3d& w_b,
             const Eigen::Vector3d& f_b, double gyro_psd, double accel_psd);

    /// Rows and `driven` of Phi over a span that is not empty, the Earth's part of the dynamics left out.
    void fill(const Layout& layout, estim::Transition& phi) const;
    /// Puts the Earth's part of the dynamics (that without specific force) half before and half behind the rest, which is filled.
    /// What is left out is of the order of (T w_ie)^2: 1e-10 in a tenth of a second.
    void add_earth(const ins::ErrorDynamics& earth, estim::Transition& phi) const;

    /// Covariance of position, velocity and attitude that white noise and the biases' walks have made over the span: exact for the
    /// attitude and to the leading orders in T for the others, with the mean specific force in the terms of third order.
    [[nodiscard]] Matrix9 noise(const BiasNoise& biases) const;
    /// Adds it to P, with what the biases' walks share with their states; their own variances not.
    void add_noise(const BiasNoise& biases, estim::StateMatrix& P) const;
};

}  // namespace schuler::filter
