// User settings for the processing of one data set, SI units and radians. Defaults here, key names and help in settings/config.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/estim/loop.h"
#include "schuler/filter/ranging_settings.h"
#include "schuler/filter/states/disturbance.h"
#include "schuler/sensor/gnss_errors.h"
#include "schuler/sensor/grades.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace schuler::filter {

enum class VehicleKind { Car, Air, Ship, Hand, Static };
enum class Mechanization { Geographic, Ecef };
using estim::Loop;
/// Coupling of receiver and inertial unit (paper A, 1.1). Both have their own solutions: one filter estimates the errors (Loose),
/// or the mechanization is merely reset to the receiver's solution, at intervals or continuously (Separate). Tight: one filter
/// uses the ranges themselves. Intermediate: in addition, a filter of the receiver alone (fusion/intermediate_run.h). Deep: the
/// filter also steers the receiver's channels (filter/update/receiver_in_loop.h).
enum class Coupling { Loose, Separate, Tight, Intermediate, Deep };
/// Couplings whose filter uses the ranges themselves.
[[nodiscard]] constexpr bool uses_ranges(Coupling coupling) {
    return coupling == Coupling::Tight || coupling == Coupling::Intermediate || coupling == Coupling::Deep;
}
/// A fix is used at its own time (Standard), or extrapolated with the inertial accelerations and used in parts until the next one
/// (Aggressive).
enum class LooseKind { Standard, Aggressive };
enum class HeightKind { Ellipsoidal, Msl, Relative };

/// IMU: conversion of logged values to body increments, and the quality of the sensors.
struct ImuSettings {
    ImuKind kind = ImuKind::Rates;
    ImuStamp stamp = ImuStamp::End;
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();      ///< sensor axes to forward-right-down, from `axes`
    Eigen::Vector3d mounting_rpy = Eigen::Vector3d::Zero();  ///< rad, roll, pitch, yaw from body to sensor (after `axes`)
    double mounting_std = 0.03;                              ///< rad, of the given or estimated forward axis
    bool estimate_mounting = false;                          ///< estimate the mounting (requires motion)
    /// rad, of pitch and yaw of an estimated mounting, included in the reported vehicle attitude. A given mounting is exact.
    double found_mounting_std = 0.0;
    sensor::ImuErrorModel errors;  ///< assumed by the filter
    bool estimate_noise = false;   ///< fit the white noise to the innovations (a grade is only an estimate)
    /// Factors on the noise that drives the errors of free inertial navigation (white noise and bias random walk) relative to
    /// `errors`: 1 if not given. The initial uncertainty is unaffected.
    std::optional<double> gyro_noise_scale, accel_noise_scale;
    /// Fraction (of the root) of the difference of successive samples that is noise in addition to `errors`: 0 none, 1 all
    /// (filter/update/vibration.h). Not given: none, or fitted together with the noise.
    std::optional<double> gyro_vibration, accel_vibration;
    double gap_factor = 3.0;  ///< an interval longer than this multiple of the median is a gap
    /// The unit is simulated without noise, whatever `errors` assumes: rows that repeat to the last digit are no sign that it hung.
    /// Set where the given noise is zero.
    bool noiseless = false;
};

/// GNSS: antenna, ages and noise.
struct GnssSettings {
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< m, IMU to antenna, forward-right-down
    double lever_arm_std = 1.0;                             ///< m, one sigma of each component, if it is a state
    /// m, body axes, one sigma: what a lever arm that was found may be wrong by beyond the sigma of its state; part of the reported
    /// position alone.
    Eigen::Vector3d found_lever_arm_std = Eigen::Vector3d::Zero();
    double latency = 0.0;                         ///< s, all channels: valid at stamp - latency
    std::optional<double> velocity_latency;       ///< s, replaces latency for the velocity
    std::optional<double> height_latency;         ///< s, replaces latency for the height
    std::optional<double> velocity_down_latency;  ///< s, replaces velocity_latency for the down component
    double latency_std = 0.0;  ///< s, one sigma of the position latency; if above 0, the latency error is a state
    /// s, one sigma of the velocity latency: if above 0, its error is a separate state; otherwise a velocity without a latency of
    /// its own is assumed to have that of the position.
    double velocity_latency_std = 0.0;
    bool latency_found = false;  ///< the latencies were not given: those that are states may be corrected before a run
    /// s, one sigma of the white error of the fix times, by which positions vary with the velocity and velocities with the
    /// acceleration. Not given: the part not covered by the latency sigma, or fitted together with the noise.
    std::optional<double> jitter;
    bool estimate_latency = false;  ///< estimate the latencies that are not given
    HeightKind height = HeightKind::Ellipsoidal;
    Eigen::Vector3d default_std_position{2.5, 2.5, 5.0};     ///< m, if the log gives none or zero (an autonomous fix)
    Eigen::Vector3d default_std_velocity{0.15, 0.15, 0.3};   ///< m/s, likewise
    Eigen::Vector3d std_floor_position{0.005, 0.005, 0.01};  ///< m, smaller values in a log are raised to this
    bool estimate_std = true;         ///< scale the defaults, or the sigmas of the log, until the innovations agree
    double std_scale = 1.0;           ///< of the log's own position sigmas
    double velocity_std_scale = 1.0;  ///< of the log's own velocity sigmas
    bool use_velocity = true;
    bool consider_errors = false;  ///< loose coupling: the slow errors widen the covariance, but are not estimated [Schmidt1966]
    /// Slowly varying errors; those above zero are states. A log states the sigma of the total error: with such states, only the
    /// remainder is white noise. The defaults above are for the white part.
    sensor::GnssErrorModel errors;
    std::vector<Time> constellation_changes;  ///< in order; a change in the log's number of satellites also counts
};

struct BaroSettings {
    bool use = true;
    double std = 1.0;         ///< m, white
    double bias_std = 30.0;   ///< m, initial bias
    double bias_walk = 0.05;  ///< m/sqrt(s)
    double bias_time = 0.0;   ///< s; above 0 the bias is a Gauss-Markov process of bias_std with this time, not a random walk
    bool fit_std = true, fit_bias_walk = true;  ///< to the innovations, where the noise of the inertial unit is
};

struct MagSettings {
    bool use = true;
    double declination = not_given;  ///< rad, east positive; not given: estimated as part of the heading offset
    double heading_std = 0.1;        ///< rad
    double bias_std = 0.5;           ///< rad, initial heading error of the magnetometer, that of hard iron included
    double bias_walk = 0.002;        ///< rad/sqrt(s), change due to electric currents and surroundings
    /// rad, constant deviation of the heading by hard iron along each body axis, one sigma; 0: no such states. Some degrees are left by a
    /// calibration, tens are common without one. Turns make it observable, so that little depends on this value.
    double deviation_std = 0.2;
    /// rad, deviation that changes within seconds (soft iron in turns, currents of motors), one sigma of a Gauss-Markov process; not given: a
    /// quarter of deviation_std. Without it what hard iron does not explain would be taken for a tilt, which the dip makes visible.
    double disturbance_std = not_given;
    bool fit_heading_std = true, fit_bias_walk = true, fit_deviation = true, fit_disturbance = true;  ///< as in BaroSettings

    [[nodiscard]] double used_disturbance() const {
        constexpr double part = 0.25;
        return std::isfinite(disturbance_std) ? disturbance_std : part * deviation_std;
    }
    /// rad; 0 if not given: the heading offset includes it
    [[nodiscard]] double used_declination() const { return std::isfinite(declination) ? declination : 0.0; }
    /// rad, one sigma: of a single heading before any turn but for white noise; of the offset alone.
    [[nodiscard]] double first_std() const { return std::hypot(std::max(bias_std, deviation_std), used_disturbance()); }
    [[nodiscard]] double offset_std() const {
        return std::sqrt(std::max(0.0, bias_std * bias_std - deviation_std * deviation_std));
    }
};

struct OdometerSettings {
    bool use = true;
    double std = 0.1;         ///< m/s, if the log gives none
    double scale_std = 0.02;  ///< scale-factor error (tyres, wear)
};

struct HeadingSettings {
    bool use = true;
    double std = 0.02;        ///< rad, if the log gives none
    double offset_std = 0.0;  ///< rad, of the sensor relative to the body's forward axis; 0: not a state
    bool by_course = false;   ///< samples are courses between fixes one chord apart: unavailable if either fix is withheld
};
constexpr double course_chord = 8.0, longest_chord = 12.0;  ///< s

/// Depth gauges, barometers and altimeters at separate positions on the body (Recording::gauges).
struct GaugeSettings {
    bool use = true;
    double std = 0.05;        ///< m, white
    double level_std = 10.0;  ///< m, constant error of each; 0: not states
    std::array<Eigen::Vector3d, 3> lever_arms_b{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                                Eigen::Vector3d::Zero()};  ///< m
};

/// A velocity log in body axes (Doppler log, DVL; Recording::body_velocity).
struct LogSettings {
    bool use = true;
    double std = 0.02;                                      ///< m/s, white
    double scale_std = 0.005;                               ///< scale-factor error; 0: not a state
    double misalignment_std = 0.005;                        ///< rad, about the right and down axes; 0: not states
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< m, IMU to log
};

/// Initial state if given by the user; NaN members are determined by the program.
struct InitialSettings {
    std::optional<Time> time;
    Geodetic position{not_given, not_given, not_given};
    Eigen::Vector3d velocity_n = not_given3();
    Eigen::Vector3d rpy = not_given3();
    Eigen::Vector3d std_position = not_given3();
    Eigen::Vector3d std_velocity = not_given3();
    Eigen::Vector3d std_rpy = not_given3();
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< rad/s
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< m/s^2
};

/// Constraints and gates.
struct ConstraintSettings {
    bool zero_velocity = true;                ///< zero-velocity and zero-rate updates when the log shows a standstill
    double zero_velocity_std = 0.01;          ///< m/s
    double zero_rate_std = 1e-3;              ///< rad/s, added to the gyro noise
    bool nonholonomic = false;                ///< wheeled vehicle: no lateral and vertical velocity (default on for a car)
    bool nonholonomic_auto = false;           ///< unknown vehicle: impose it once the log shows wheeled motion
    double nonholonomic_std_lateral = 0.10;   ///< m/s
    double nonholonomic_std_vertical = 0.10;  ///< m/s
    double constraint_rate = 10.0;            ///< Hz, of the pseudo-measurements
    double gate_probability = 1e-4;           ///< probability of rejecting a good measurement
    /// Variances of the estimates are kept above the squares of these (paper A, after (3.4.5)); 0: no bound.
    double floor_position = 0.0;    ///< m
    double floor_velocity = 0.0;    ///< m/s
    double floor_attitude = 0.0;    ///< rad
    double floor_gyro_bias = 0.0;   ///< rad/s
    double floor_accel_bias = 0.0;  ///< m/s^2
    double recovery_time = 10.0;    ///< s, consistent rejected fixes over this time are accepted
    int recovery_count = 10;        ///< ... if there are at least this number
};

/// The uncoupled scheme: corrections with fixed, non-optimal gains.
struct SeparateSettings {
    double restart_period = 0.0;  ///< s between resets of position and velocity to the fix; 0: continuous correction
    double position_time = 30.0;  ///< s, time constant of the continuous correction of the position
    double velocity_time = 30.0;  ///< s, likewise of the velocity
    double baro_time = 100.0;     ///< s, time constant of the barometer's third-order loop in the vertical channel
};

/// Integrity monitoring of the receiver. Off: the gates alone, which finally accept a consistent run of rejected fixes.
struct IntegritySettings {
    bool use = false;
    double accel_limit = 30.0;       ///< m/s^2, capability of the vehicle: bound of the tolerance check; 0: no check
    double trace_ratio = 10.0;       ///< delta of (3.4.7); 0: no check
    double window = 60.0;            ///< s, age at which the solution without GNSS restarts; 0: no detection of slow ramps
    double false_alarm = 1e-5;       ///< probability that one slow-ramp test exceeds its limit in a fault-free run
    int slow_count = 3;              ///< number of consecutive tests that must exceed it
    double readmission_time = 10.0;  ///< s of agreement before an excluded receiver is used again
};

struct Outage {
    double start;     ///< s after the origin of the command line's times
    double duration;  ///< s

    /// True if it withholds data stamped `t` seconds after that origin: its ends are excluded, to a microsecond.
    [[nodiscard]] bool withholds(double t) const { return t > start + tolerance && !is_over(t); }
    [[nodiscard]] bool is_over(double t) const { return t >= start + duration - tolerance; }

private:
    static constexpr double tolerance = 1e-6;  // s
};
[[nodiscard]] inline bool is_withheld(std::span<const Outage> outages, double t) {
    return std::ranges::any_of(outages, [t](const Outage& o) { return o.withholds(t); });
}

struct Settings {
    earth::Earth earth;
    VehicleKind vehicle = VehicleKind::Hand;
    Mechanization mechanization = Mechanization::Geographic;
    Loop loop = Loop::Closed;
    Coupling coupling = Coupling::Loose;
    LooseKind loose_kind = LooseKind::Standard;
    int aggressive_parts = 10;  ///< parts in which a fix is used, Aggressive
    SeparateSettings separate;
    IntegritySettings integrity;
    std::optional<double>
        feedback_period;              ///< s between corrections of the mixed loop; not given: by the rule of correction_period
    double feedback_attitude = 1e-3;  ///< rad, attitude error growth permitted by that rule between corrections
    bool smooth = false;
    bool scale_factors = false;  ///< gyro and accelerometer scale factors as states (21 states)
    bool misalignments = false;  ///< six axis misalignments of each triad as states
    bool estimate_lever_arm = false;
    ImuSettings imu;
    GnssSettings gnss;
    RangingFilterSettings ranging;
    BaroSettings baro;
    MagSettings mag;
    OdometerSettings odometer;
    HeadingSettings heading;
    GaugeSettings gauges;
    LogSettings log;
    DisturbanceSettings disturbance;
    ConstraintSettings constraints;
    InitialSettings initial;
    std::optional<Time> start, stop;  ///< absolute, on the data set's axis
    std::vector<Outage> outages;      ///< relative to the first GNSS epoch
    bool state_rows = false;          ///< keep the estimate of each block of states (Trajectory::states)
    bool covariance_rows = false;     ///< keep the full covariance (Trajectory::covariances)
    double covariance_rate = 0.0;     ///< Hz, of those rows; 0 = every output
    double output_rate = 10.0;        ///< Hz of the solution; 0 = every IMU epoch
    Eigen::Vector3d output_lever_arm_b =
        Eigen::Vector3d::Zero();        ///< m, IMU to a point whose solution is also output; zero: none
    bool output_at_antenna = false;     ///< the solution is the motion of the antenna instead of that of the unit
    std::vector<Time> output_instants;  ///< in order: additional output times (Trajectory::instants)
    bool backward = false;              ///< run an additional filter backward in time (filter/update/reversed.h)
};

/// The slow errors of fixes are consider states: their estimates are not updated.
[[nodiscard]] inline bool considers(const Settings& s) { return s.coupling == Coupling::Loose && s.gnss.consider_errors; }

}  // namespace schuler::filter
