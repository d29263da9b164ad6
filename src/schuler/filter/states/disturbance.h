// The gravity disturbance (gravity minus normal gravity) as states: its change along the track, and its contributions to the
// filter's transition, noise and nominal values. [PaperE] has the constant and the first-order process, [Jordan1972] the others.
#pragma once

#include "schuler/estim/state.h"
#include "schuler/estim/transition.h"
#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

#include <array>

namespace schuler::filter {

enum class DisturbanceKind {
    Constant,                ///< the systematic part alone
    FirstOrder,              ///< plus a first-order Gauss-Markov process: the paper's
    RampAndFirstOrder,       ///< constant + ramp + first order (the polynomial alone if sigma is zero)
    QuadraticAndFirstOrder,  ///< constant + ramp + parabola + first order
    SecondOrder,             ///< constant + second-order Gauss-Markov, correlation (1 + x) exp(-x), x = distance / length
    ThirdOrder,              ///< constant + third order, (1 + x + x^2/3) exp(-x): twice differentiable
};

/// Axes in which the components of the disturbance follow their model. The paper's are Earth-fixed: a constant in them rotates
/// against the vertical as the vehicle moves. A field of the ground, and every simulated one here, is defined in east, north, up.
enum class DisturbanceAxes { LocalLevel, EarthFixed };

/// The value of a component and its derivatives by distance, each driving the preceding one.
struct DisturbanceChain {
    bool random = false;  ///< a random process; otherwise a polynomial
    int order = 1;        ///< number of elements (value, slope, curvature)
    double rate = 0.0;    ///< 1/m, of a process: 1/length

    /// Derivative of (value, slope, curvature) by distance.
    [[nodiscard]] Eigen::Matrix3d dynamics() const;
    /// exp(dynamics distance), exact; the distance may be negative.
    [[nodiscard]] Eigen::Matrix3d growth(double distance) const;
    /// Density, per distance, of the white noise that drives the last element, for unit sigma of the value.
    [[nodiscard]] double psd() const;
};

/// Variation of the gravity disturbance along the track.
struct DisturbanceModel {
    DisturbanceKind kind = DisturbanceKind::Constant;
    double length = 0.0;  ///< correlation length of the random part, m (s if `by_time`); infinity: constant
    Eigen::Vector3d sigma_n = Eigen::Vector3d::Zero();  ///< of the random part, north, east, down, m/s^2
    bool by_time = false;  ///< the process depends on time, as the paper's mu = 1/length, instead of distance
    DisturbanceAxes axes = DisturbanceAxes::LocalLevel;  ///< of the states (north, east, down, or Earth-fixed)

    /// Throws Error(Input) that names the invalid value.
    void check() const;
    /// Degree of the polynomial along the track that forms the systematic part.
    [[nodiscard]] int degree() const {
        return kind == DisturbanceKind::QuadraticAndFirstOrder ? 2 : kind == DisturbanceKind::RampAndFirstOrder ? 1 : 0;
    }
    [[nodiscard]] bool has_random_part() const { return kind != DisturbanceKind::Constant; }
    [[nodiscard]] DisturbanceChain systematic_part() const { return {false, degree() + 1, 0.0}; }
    /// Only if has_random_part().
    [[nodiscard]] DisturbanceChain random_part() const;
    /// Metres along the track per second (seconds if by_time) at a velocity relative to the Earth.
    [[nodiscard]] double pace(const Eigen::Vector3d& v) const { return by_time ? 1.0 : v.norm(); }
    /// Maps the disturbance's components to Earth-fixed axes, at a position with this C_en.
    [[nodiscard]] Eigen::Matrix3d to_earth_fixed(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? C_en : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    }
    /// Maps north, east, down to the disturbance's axes.
    [[nodiscard]] Eigen::Matrix3d from_local_level(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : C_en;
    }
    /// Stationary covariance of (value, slope, curvature) of a component with unit sigma; orders not present are zero.
    [[nodiscard]] Eigen::Matrix3d stationary() const;
};

/// Settings for its estimation.
struct DisturbanceSettings {
    bool estimate = false;
    bool keep_before = false;  ///< the disturbance before its last change (open_disturbance) as states too: a clone
    DisturbanceModel model;
    /// Initial one sigma: of the systematic part north, east, down, m/s^2; of a polynomial's slope, m/s^2 per metre (per second
    /// if by time), and of its second derivative, m/s^2 per square metre (or second), each axis.
    Eigen::Vector3d prior_n = Eigen::Vector3d::Constant(1e-4);
    double slope = 0.0, curvature = 0.0;
};

/// Appends the blocks of the model. @throws Error(Input) if the filter would become too large.
void add_disturbance(const DisturbanceModel& model, Layout& layout);

/// The disturbance in the axes of its model, m/s^2, from the nominal values of a layout that includes it.
[[nodiscard]] Eigen::Vector3d disturbance_of(const Layout& layout, const estim::StateVector& parameters);

/// Propagates the nominal values over this number of metres (seconds) along the track.
void advance_disturbance(const DisturbanceModel& model, const Layout& layout, double distance, estim::StateVector& parameters);

/// Transition of the states over `time` (s) and `distance` (m, or s): D, the shears, and the rows of position and velocity, for
/// which `to_frame` rotates the disturbance's axes to the frame's. The shears are appended to those of phi.
void fill_disturbance(const DisturbanceModel& model, const Layout& layout, double time, double distance,
                      const Eigen::Matrix3d& to_frame, estim::Transition& phi);

/// Covariance of the process's driving noise over that interval: of its states, and of the velocity to leading order.
/// `from_local_level`: of the model.
void add_disturbance_noise(const DisturbanceModel& model, const Layout& layout, double time, double distance,
                           const Eigen::Matrix3d& from_local_level, const Eigen::Matrix3d& to_frame, estim::StateMatrix& P);

/// Initial covariance; the random part is in its stationary state.
void start_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Eigen::Matrix3d& C_en,
                       estim::StateMatrix& P);

/// Increases the uncertainty of the systematic part by its prior.
void open_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Eigen::Matrix3d& C_en,
                      estim::StateMatrix& P);

}  // namespace schuler::filter
