// The disturbance of gravity (gravity less normal gravity) as states: how it changes along the track, and what that makes of the
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
    FirstOrder,              ///< and a first-order Gauss-Markov process: the paper's
    RampAndFirstOrder,       ///< constant + ramp + first order (no more than the polynomial where sigma is zero)
    QuadraticAndFirstOrder,  ///< constant + ramp + parabola + first order
    SecondOrder,             ///< constant + second-order Gauss-Markov, correlation (1 + x) exp(-x), x = distance / length
    ThirdOrder,              ///< constant + third order, (1 + x + x^2/3) exp(-x): smooth enough for a slope of a slope
};

/// In which axes the disturbance's components follow their model. The paper's are Earth-fixed: what is constant in them turns
/// against the vertical as the vehicle moves. A field of the ground, and every simulated one here, is told east, north and up.
enum class DisturbanceAxes { LocalLevel, EarthFixed };

/// A component's value and the derivatives by distance that belong to it, each driving the one before.
struct DisturbanceChain {
    bool random = false;  ///< a process; otherwise a polynomial
    int order = 1;        ///< value, slope, curvature: how many of them there are
    double rate = 0.0;    ///< 1/m of a process: 1/length

    /// Derivative of (value, slope, curvature) by distance.
    [[nodiscard]] Eigen::Matrix3d dynamics() const;
    /// exp(dynamics distance), exact; the distance may be negative.
    [[nodiscard]] Eigen::Matrix3d growth(double distance) const;
    /// Density, by distance, of the white noise that drives the last of them, for unit sigma of the value.
    [[nodiscard]] double psd() const;
};

/// How the disturbance of gravity changes along the track.
struct DisturbanceModel {
    DisturbanceKind kind = DisturbanceKind::Constant;
    double length = 0.0;  ///< correlation length of the random part, m (s where `by_time`); infinity: it is constant
    Eigen::Vector3d sigma_n = Eigen::Vector3d::Zero();  ///< of the random part, north, east, down, m/s^2
    bool by_time = false;  ///< the process runs with time, as the paper's mu = 1/length, instead of along the track
    DisturbanceAxes axes = DisturbanceAxes::LocalLevel;  ///< of the states (north, east, down, or Earth-fixed)

    /// Throws Error(Input) naming the value that is unusable.
    void check() const;
    /// Of the polynomial along the track that the systematic part is.
    [[nodiscard]] int degree() const {
        return kind == DisturbanceKind::QuadraticAndFirstOrder ? 2 : kind == DisturbanceKind::RampAndFirstOrder ? 1 : 0;
    }
    [[nodiscard]] bool has_random_part() const { return kind != DisturbanceKind::Constant; }
    [[nodiscard]] DisturbanceChain systematic_part() const { return {false, degree() + 1, 0.0}; }
    /// has_random_part() only.
    [[nodiscard]] DisturbanceChain random_part() const;
    /// Metres along the track (seconds where by_time) in a second at a velocity against the Earth.
    [[nodiscard]] double pace(const Eigen::Vector3d& v) const { return by_time ? 1.0 : v.norm(); }
    /// The disturbance's components to Earth-fixed axes, at a place with this C_en.
    [[nodiscard]] Eigen::Matrix3d to_earth_fixed(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? C_en : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    }
    /// North, east, down to the disturbance's axes.
    [[nodiscard]] Eigen::Matrix3d from_local_level(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : C_en;
    }
    /// Stationary covariance of (value, slope, curvature) of a component with unit sigma; orders that are not there are zero.
    [[nodiscard]] Eigen::Matrix3d stationary() const;
};

/// Estimating it.
struct DisturbanceSettings {
    bool estimate = false;
    DisturbanceModel model;
    /// One sigma at the start: of the systematic part north, east, down, m/s^2; of a polynomial's slope, m/s^2 per metre (per second
    /// where it runs by time), and of its second derivative, m/s^2 per square metre (or second), each axis.
    Eigen::Vector3d prior_n = Eigen::Vector3d::Constant(1e-4);
    double slope = 0.0, curvature = 0.0;
};

/// Appends the blocks that the model has. @throws Error(Input) where the filter would become too large.
void add_disturbance(const DisturbanceModel& model, Layout& layout);

/// The disturbance in the axes of its model, m/s^2, of the nominal values of a layout that has it.
[[nodiscard]] Eigen::Vector3d disturbance_of(const Layout& layout, const estim::StateVector& parameters);

/// Nominal values after so many metres (seconds) of the way.
void advance_disturbance(const DisturbanceModel& model, const Layout& layout, double distance, estim::StateVector& parameters);

/// What a span of `time` (s) and `distance` (m, or s) does to the states, in the form of a transition: D, the shears, and the rows of
/// position and velocity, for which `to_frame` turns the disturbance's axes to the frame's. phi's shears are appended to.
void fill_disturbance(const DisturbanceModel& model, const Layout& layout, double time, double distance,
                      const Eigen::Matrix3d& to_frame, estim::Transition& phi);

/// Covariance that the process's driving noise has made over that span: of its states, and of the velocity to its leading order.
/// `from_local_level`: of the model.
void add_disturbance_noise(const DisturbanceModel& model, const Layout& layout, double time, double distance,
                           const Eigen::Matrix3d& from_local_level, const Eigen::Matrix3d& to_frame, estim::StateMatrix& P);

/// Covariance at the start; the random part is in its stationary state.
void start_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Eigen::Matrix3d& C_en,
                       estim::StateMatrix& P);

/// The systematic part may have changed by its prior.
void open_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Eigen::Matrix3d& C_en,
                      estim::StateMatrix& P);

}  // namespace schuler::filter
