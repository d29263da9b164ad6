// Error-state inertial filter: nominal state, covariance, propagation with every IMU increment, feedback of the estimated errors.
// It depends on no sensor but the IMU; measurements are supplied as rows (filter/measurement). The sole owner of the covariance.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"
#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/corrections.h"
#include "schuler/filter/states/disturbance.h"
#include "schuler/filter/states/frame.h"
#include "schuler/filter/states/gathered_motion.h"
#include "schuler/filter/states/heading_force.h"
#include "schuler/filter/states/layout.h"
#include "schuler/filter/states/recent_change.h"
#include "schuler/filter/states/recent_mean.h"
#include "schuler/filter/states/sustained_force.h"
#include "schuler/sensor/grades.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::filter {

using estim::StateMatrix;
using estim::StateVector;

/// First-order process of one state: d' = -decay d + white noise; without decay a random walk.
struct StateProcess {
    double decay = 0.0;  ///< 1/s (0: constant or random walk)
    double psd = 0.0;    ///< unit^2/s

    /// Stationary process of a given sigma and correlation time (s).
    [[nodiscard]] static StateProcess markov(double sigma, double time) { return {1.0 / time, 2.0 * sigma * sigma / time}; }
    /// Sigma of a stationary process; 0 of one without decay.
    [[nodiscard]] double sigma() const { return decay > 0.0 ? std::sqrt(0.5 * psd / decay) : 0.0; }
};

/// Parameters that are constant in a run.
struct InertialModel {
    earth::Earth earth;
    Layout layout;
    double gyro_psd = 0.0;   ///< rad^2/s
    double accel_psd = 0.0;  ///< m^2/s^3
    /// One sigma of scale factors and misalignments that are not states: noise during manoeuvres.
    double gyro_gain = 0.0, accel_gain = 0.0;
    double gyro_g = 0.0;                                 ///< likewise of the gyro bias per unit of specific force, rad/s/(m/s^2)
    double gyro_vibration = 0.0, accel_vibration = 0.0;  ///< ImuSettings, scaled as the noise
    double found_mounting_std = 0.0;                     ///< rad, ImuSettings
    Eigen::Vector3d found_lever_arm_std = Eigen::Vector3d::Zero();  ///< m, GnssSettings
    bool at_antenna = false;                                        ///< the solution is that of the antenna
    double leeway_std = 0.0;                                        ///< rad, if the heading sensor is the course of a ship
    std::array<StateProcess, estim::max_states> process{};          ///< of the states from index 9 on
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();          ///< m, of the GNSS antenna; of its state the first value
    double clock_psd = 0.0, drift_psd = 0.0;                        ///< m^2/s, m^2/s^3
    sensor::GnssErrorModel gnss;                                    ///< of the receiver states; their decay may depend on speed
    DisturbanceModel disturbance;                                   ///< gravity disturbance, if the layout includes it
    Loop loop = Loop::Closed;
    StateVector floor;  ///< least variances after an update

    InertialModel(const earth::Earth& earth_, const Layout& layout_, const sensor::ImuErrorModel& imu);
    /// Sets the process of `count` states starting at an offset; no effect if the offset is negative.
    void set_process(int offset, int count, StateProcess process_);
    [[nodiscard]] bool eccentric() const { return layout.lever_arm >= 0 || !lever_arm_b.isZero(0.0); }
    [[nodiscard]] bool late() const { return layout.gnss_latency >= 0 || layout.gnss_velocity_latency >= 0; }
};

/// Additional noise of a step over bridged data (IMU gap), added to the densities of the model.
struct BridgeNoise {
    double gyro_psd = 0.0;
    double accel_psd = 0.0;
    bool standing = false;  ///< the body has been stationary until now
};

/// s, width of the mean specific force without a latency as a state: the averaging time of a receiver's velocity.
inline constexpr double force_width = 0.025;
/// s, width of the means of force and rate with a latency as a state, from the frequency (Hz) of the oscillation. They leave out
/// vibrations, which determine the latency within their period only: with an error of a whole period the fixes agree as well, and a filter
/// that takes them as information may settle there, sure and wrong. Steps and swings remain, almost in their phase.
[[nodiscard]] inline double latency_width(double frequency) {
    constexpr double swing = 3.0, vibration = 6.0, least = 0.02, most = 0.05;  // Hz, Hz, s, s
    return least + (most - least) * std::clamp((frequency - swing) / (vibration - swing), 0.0, 1.0);
}

/// Plain and copyable: a copy is a saved filter.
template <class Frame>
struct InertialFilter {
    typename Frame::State nav;
    StateVector parameters;  ///< nominal values of the states from index 9 on
    StateVector error;       ///< estimated errors of nav and parameters not yet fed back (zero in the closed loop)
    StateMatrix P;           ///< of the errors, estimate minus truth, before the motion in `gathered`
    GatheredMotion gathered;
    int used = 0;  ///< leading states in use, a multiple of four; the others are uncorrelated with them

    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();                                   ///< body to frame, of nav
    ImuIncrement previous{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< corrected for the sensor errors
    Eigen::Vector3d w_ib_b = Eigen::Vector3d::Zero();      ///< corrected rate at the end of the last step, rad/s
    RecentMean mean_rate;                                  ///< of the rate, rad/s, with a lever arm and a latency
    RecentChange recent_rate;                              ///< of the rate, rad/s, with a lever arm
    RecentChange force_change;                             ///< of the specific force, frame axes, m/s^2, with a latency
    Eigen::Vector3d last_force = Eigen::Vector3d::Zero();  ///< of the last increment, likewise
    Eigen::Vector3d mean_force = Eigen::Vector3d::Zero();  ///< specific force over the last interval, frame axes, m/s^2
    RecentMean recent_force;                               ///< likewise, independent of the intervals of measurements
    SustainedForce sustained_force;                        ///< with a g-dependent gyro bias
    Corrections corrections;
    Withheld withheld;          ///< from the column of the heading
    double cached_time = -1.0;  ///< of decay and noise below, s
    StateVector cached_diagonal, cached_q;
    std::array<StateProcess, Layout::slots> slot_process{};  ///< of the source block, whose states are reassigned

    /// Zero covariance and nominal values for the states of the model.
    explicit InertialFilter(const InertialModel& model);
    InertialFilter() = default;

    [[nodiscard]] Time time() const { return nav.time; }
    void set_nav(const typename Frame::State& state);

    /// The increment corrected for the estimated sensor errors.
    [[nodiscard]] ImuIncrement corrected(const InertialModel& model, const ImuIncrement& raw) const;

    /// Advances the nominal state by one raw increment; the covariance remains at its own time.
    void propagate(const InertialModel& model, const ImuIncrement& raw, const BridgeNoise& bridge);

    /// Propagates covariance, errors not fed back and parameters to the time of the nominal state; `phi` is the transition. False
    /// if they are already there.
    bool propagate_covariance(const InertialModel& model, estim::Transition& phi);

    /// Covariance of position, velocity and attitude at the time of the nominal state, local level. If motion has been gathered
    /// since the last propagation, only that block is propagated: for outputs.
    [[nodiscard]] Matrix9 local_covariance(const InertialModel& model) const;

    [[nodiscard]] Eigen::Vector3d lever_arm(const InertialModel& model) const;  ///< of the antenna by the estimate, body axes, m

    /// Variance of an axis of w_ib_b as the rate at the time of a receiver's velocity, rad^2/s^2: white noise, and the change between
    /// that time and the stamp (less what was given of the latency).
    [[nodiscard]] double rate_variance(const InertialModel& model) const;
    /// Two sigma of a rate of this variance, rad/s: the motion of a lever arm at a lower one gives no information.
    [[nodiscard]] double uncertain_rate(double rate_variance) const;
    [[nodiscard]] double heading_variance(const InertialModel& model) const;  ///< rad^2
    /// Mean square change of the specific force within a time of mean square `time2` (s^2), local level, m^2/s^4. With Earth-fixed
    /// axes the sum is right, its directions are mixed: the squares are kept without the correlations of the axes.
    [[nodiscard]] Eigen::Vector3d force_change_square(const InertialModel& model, double time2) const;

    // The following functions require the covariance at the time of the nominal state.

    /// Converts rows of a measurement from local-level errors to the filter's own errors.
    [[nodiscard]] Measurement to_own(const InertialModel& model, const Measurement& local) const;

    /// Innovation covariance (dof x dof used, the rest identity) of a measurement in the filter's own errors.
    [[nodiscard]] Eigen::Matrix3d innovation_covariance(const Measurement& m) const;

    /// One sigma of the innovations of a position (own errors; components in the order north, east, down), as if its slow errors
    /// were not states: from the states without them, the `undecided` hypotheses, and the total error of the fix.
    [[nodiscard]] Eigen::Vector3d sigma_apart(const InertialModel& model, const Measurement& m, const Matrix9& undecided) const;

    /// Sequential update and closed-loop correction. `record(RowUpdate)` is called for each scalar. Returns the estimated error.
    template <class Record>
    StateVector update(const InertialModel& model, const Measurement& m, Record&& record) {
        StateVector dx = StateVector::Zero(P.rows());
        for (int i = 0; i < m.dof; ++i)
            record(estim::update(dx, P, m.rows[static_cast<std::size_t>(i)], m.innovation(i), m.variance(i), used));
        keep_above_floor(model);
        apply(model, dx);
        return dx;
    }

    /// Correction with given gain columns; the covariance update is valid for any gain.
    template <class Gains>
    void correct(const InertialModel& model, const Measurement& m, const Gains& gains) {
        StateVector dx = StateVector::Zero(P.rows());
        for (int i = 0; i < m.dof; ++i)
            (void)estim::update_with_gain(dx, P, m.rows[static_cast<std::size_t>(i)], m.innovation(i), m.variance(i),
                                          gains.col(i), used);
        apply(model, dx);
    }

    /// No variance below the model's floor.
    void keep_above_floor(const InertialModel& model) {
        P.diagonal() = estim::as_double(P.diagonal()).cwiseMax(model.floor).template cast<estim::CovarianceScalar>();
    }
    /// Three rows and columns of P, in double precision.
    [[nodiscard]] Eigen::Matrix3d covariance_of(int row, int column) const {
        return estim::as_double(P.template block<3, 3>(row, column));
    }
    /// Corrects the estimate by dx: the nominal state in the closed loop, `error` otherwise.
    void apply(const InertialModel& model, const StateVector& dx);
    /// nominal <- corrected(nominal, error): the correction of the open or mixed loop. The estimate is unchanged. The remaining
    /// attitude error refers to the new nominal attitude: e + a x e/2 for a correction by a. A tilt of 1e-4 rad converts an
    /// azimuth error of 1e-3 into 1e-7 rad of tilt: significant then, but not after a single measurement. Returns that rotation.
    estim::Transition feed_back(const InertialModel& model);
    /// Reassigns a state: value 0, the given variance, no correlation.
    void renew(int state, double variance);
    /// Replaces three states by the combinations `rows` of the others, with all present knowledge of these
    /// [RoumeliotisBurdick2002]; `value`: their nominal values.
    void clone(int first, const std::array<estim::Row, 3>& rows, const Eigen::Vector3d& value);
    /// The process of a slot of the source block.
    void set_slot_process(std::size_t slot, StateProcess process_) {
        slot_process[slot] = process_;
        cached_time = -1.0;
    }

    /// The estimate: nominal state and parameters, corrected by `error`.
    [[nodiscard]] typename Frame::State estimated(const InertialModel& model) const;
    [[nodiscard]] StateVector estimated_parameters() const;
    [[nodiscard]] Estimate estimate(const InertialModel& model) const;
    [[nodiscard]] NavState geographic(const InertialModel& model) const {
        return Frame::geographic(model.earth, estimated(model));
    }

    /// 9 x 9 map of the filter's first nine errors to north-east-down errors (identity in the geographic frame).
    [[nodiscard]] Matrix9 to_local_level(const InertialModel& model) const;

private:
    /// Rows and gravity disturbance of the transition over the gathered motion, after these corrections; D and shears of phi are those
    /// of the other states.
    void fill_transition(const InertialModel& model, const HeadingForce& force, const Corrections& after,
                         estim::Transition& phi) const;
    [[nodiscard]] Eigen::Vector3d down_axis(const InertialModel& model) const;
    /// Refers the covariance to the antenna: corrections of the attitude, and turns within the gyros' errors, tell neither the heading
    /// nor the lever arm.
    void withhold_lever_arm(const InertialModel& model, const Eigen::Vector3d& down, const Corrections& after,
                            estim::Transition& phi) const;
    /// Information of the gathered motion about the heading.
    [[nodiscard]] HeadingForce force_for_heading(const InertialModel& model) const;
    /// Nominal gravity disturbance and `gathered.distance` after dt at the current velocity.
    void follow_disturbance(const InertialModel& model, double dt);
    /// The disturbance as sensed by the accelerometers over dt: m/s, body axes.
    [[nodiscard]] Eigen::Vector3d felt_disturbance(const InertialModel& model, double dt) const;
    /// Velocity increment that drives the error growth of a stationary body: the horizontal part of the measured one is noise, and a
    /// transition formed with it would derive heading information from noise (as many radians as the relative noise, at each measurement).
    [[nodiscard]] Eigen::Vector3d vertical_part(const InertialModel& model, const Eigen::Vector3d& df, double dt) const;
    /// Rotation from the axes of the disturbance model to those of the frame.
    [[nodiscard]] Eigen::Matrix3d disturbance_axes(const InertialModel& model) const;
};

/// Adds to P (position, velocity, attitude, local level) the effect of an attitude error of covariance `turn` on a position that
/// was derived from that of the antenna; `turn` itself is in P already. l_n: lever arm, m.
inline void turn_about_antenna(const Eigen::Vector3d& l_n, const Eigen::Matrix3d& turn, Matrix9& P) {
    const Eigen::Matrix3d S = math::skew(l_n), cross = S * turn;
    P.block<3, 3>(Layout::position, Layout::position) += cross * S.transpose();
    P.block<3, 3>(Layout::position, Layout::attitude) -= cross;
    P.block<3, 3>(Layout::attitude, Layout::position) -= cross.transpose();
}

/// Reported covariance of position, velocity and attitude, local level: the filter's, the `undecided` hypotheses, the leeway of a
/// ship whose heading is known by its course only, the uncertainty of an estimated mounting about the vehicle's right and down axes, and
/// that of a lever arm that was found.
template <class Frame>
[[nodiscard]] Matrix9 reported_covariance(const InertialModel& model, const InertialFilter<Frame>& f, const Matrix9& undecided) {
    Matrix9 P = f.local_covariance(model) + undecided;
    if (!(model.found_mounting_std > 0.0 || model.leeway_std > 0.0) && model.found_lever_arm_std.isZero(0.0)) return P;
    const Eigen::Matrix3d C_nb = f.geographic(model).q_nb.toRotationMatrix();
    P.template topLeftCorner<3, 3>() += C_nb * model.found_lever_arm_std.cwiseAbs2().asDiagonal() * C_nb.transpose();
    const Eigen::Matrix<double, 3, 2> across = model.found_mounting_std * C_nb.template rightCols<2>();
    Eigen::Matrix3d more = across * across.transpose();
    more(2, 2) += model.leeway_std * model.leeway_std;
    P.template block<3, 3>(Layout::attitude, Layout::attitude) += more;
    if (model.eccentric()) turn_about_antenna(C_nb * f.lever_arm(model), more, P);
    return P;
}

}  // namespace schuler::filter
