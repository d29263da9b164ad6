// Inertial motion since the last propagation of the covariance, as the integrals that form the transition.
//
// At the IMU rate only these are updated; the covariance follows in one step when a measurement or an output requires it. Within
// such an interval (at most a tenth of a second) the Earth terms of the dynamics are constant to 1e-6 of their effect, while
// specific force and attitude are integrated sample by sample, so that the transition equals the product of all steps.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/filter/states/layout.h"
#include "schuler/ins/error_model.h"

#include <Eigen/Core>

namespace schuler::filter {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Longest interval of one transition, s.
inline constexpr double longest_span = 0.1;

/// Two-sided densities of the noise that drives the sensor biases.
struct BiasNoise {
    double gyro_bias_psd = 0.0;   ///< rad^2/s^3
    double accel_bias_psd = 0.0;  ///< m^2/s^5
};

/// Plain and copyable. Vectors and matrices are in the axes of the mechanization's frame.
struct GatheredMotion {
    using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 9>;

    double time = 0.0;                                       ///< s
    double distance = 0.0;                                   ///< m (or s) along the track, if the gravity disturbance is a state
    Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< integral of specific force, m/s
    Eigen::Vector3d force_twice = Eigen::Vector3d::Zero();   ///< its integral, m
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< change of the computed velocity, m/s
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();      ///< change of C, if the model has a lever arm
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();          ///< integral of C: attitude by gyro bias, s
    Eigen::Matrix3d turn_twice = Eigen::Matrix3d::Zero();    ///< its integral, s^2
    Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero();  ///< by gyro bias, m
    Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero();  ///< m s
    /// The same for scale factors and misalignments, scale first; no columns if they are not states.
    Columns gain_turn, gain_velocity_by_gyro, gain_position_by_gyro, gain_velocity_by_accel, gain_position_by_accel;
    double gyro_variance = 0.0, accel_variance = 0.0;  ///< integrals of the white noises' densities, rad^2, m^2/s^2

    GatheredMotion() = default;
    explicit GatheredMotion(const Layout& layout);
    void reset();
    /// True if a step of `next` s would exceed the longest interval by more than rounding.
    [[nodiscard]] bool is_full(double next) const { return time > 0.0 && time + next > longest_span + 1e-9; }

    /// Adds one step: `C` the mean attitude over it, df its velocity increment in the frame's axes (m/s), w_b and f_b the mean
    /// rate and specific force in body axes to which the sensors' gain errors apply.
    void add(const Layout& layout, double dt, const Eigen::Matrix3d& C, const Eigen::Vector3d& df, const Eigen::Vector3d& w_b,
             const Eigen::Vector3d& f_b, double gyro_psd, double accel_psd);

    /// Rows and `driven` of Phi over a non-empty interval, without the Earth terms of the dynamics.
    void fill(const Layout& layout, estim::Transition& phi) const;
    /// Applies the Earth terms of the dynamics (without specific force) half before and half after the filled part. The neglected
    /// terms are of the order of (T w_ie)^2: 1e-10 in a tenth of a second.
    void add_earth(const ins::ErrorDynamics& earth, estim::Transition& phi) const;

    /// Covariance of position, velocity and attitude from white noise and the random walks of the biases over the interval: exact
    /// for the attitude and to leading orders in T for the others, with the mean specific force in the third-order terms.
    [[nodiscard]] Matrix9 noise(const BiasNoise& biases) const;
    /// Adds it to P, including the cross-covariances with the bias states; not the variances of the bias random walks themselves.
    void add_noise(const BiasNoise& biases, estim::StateMatrix& P) const;
};

}  // namespace schuler::filter
