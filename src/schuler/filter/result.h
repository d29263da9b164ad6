// What fusing one data set gives: solution, innovations, sensor errors, and what was found out on the way.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/filter/measurement/kinds.h"
#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace schuler::filter {

/// Excluded: rejected because the channel has lost the trust of the integrity monitor.
enum class AidStatus { Accepted, Rejected, Withheld, Excluded };

/// What was found: a test of the integrity monitor (IntegritySettings) that failed, or how refused fixes were explained.
enum class IntegrityTest {
    Tolerance,
    Innovation,
    Slow,
    Readmitted,  ///< the channel is used again
    Jump,        ///< positions jumped to another level, which the inertial unit did not feel
    JumpBack,    ///< ... and came back
    OtherLevel,  ///< the level after a jump has been held for longer than the one before: it counts now
    Navigation,  ///< the navigation was wrong and has been opened
    Receiver     ///< the receiver was wrong for some fixes and agrees again
};

/// Who was found to be wrong, and when.
struct Alert {
    Time time;     ///< of the fix
    AidKind kind;  ///< GnssPosition or GnssVelocity
    IntegrityTest test;
    double size = 0.0;  ///< m or m/s, of what was found by refused fixes
};

/// One measurement epoch as the filter met it.
struct AidRecord {
    Time time;   ///< validity time
    Time stamp;  ///< time in the log
    AidKind kind;
    AidStatus status;
    int dof = 0;      ///< how many components are used; the others have sigma 0 (GNSS: north, east, down in place)
    int source = -1;  ///< of a range: index into RangingLog::sources
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();   ///< estimate minus measured (NED for GNSS), before its own update
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< predicted one sigma of the innovation
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< the part of it that is the filter's own uncertainty
    double nis = 0.0;                                       ///< normalised innovation squared of the dof components together
    bool other_level =
        false;  ///< a position taken less a jump of the receiver (refused_fixes.h), which the innovation is without
};

/// Estimated sensor errors at one time (estimate, one sigma).
struct SensorErrorRow {
    Time time;
    Eigen::Vector3d gyro_bias, std_gyro_bias;      ///< rad/s
    Eigen::Vector3d accel_bias, std_accel_bias;    ///< m/s^2
    Eigen::Vector3d gyro_scale, std_gyro_scale;    ///< 1 (zero where not estimated)
    Eigen::Vector3d accel_scale, std_accel_scale;  ///< 1
};

/// Estimate and covariance of a block of up to three states; dof 0: no states of this filter.
struct StateBlock {
    int dof = 0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// What the filter says of its states at one time, block by block, for judging it by a simulated truth.
struct StateRow {
    Time time;
    NavState nav;
    Eigen::Matrix3d P_position, P_velocity, P_attitude;  ///< of the errors north, east, down: m^2, m^2/s^2, rad^2
    StateBlock gyro_bias, accel_bias;                    ///< body axes, rad/s, m/s^2
    StateBlock gnss_position, gnss_velocity;             ///< correlated errors of the receiver, north, east, down, m, m/s
    StateBlock baro_bias;                                ///< m
    Eigen::Matrix<double, 9, 9> P_navigation = Eigen::Matrix<double, 9, 9>::Zero();  ///< of the first three with each other
    StateBlock clock;  ///< tight coupling: c times the receiver's clock error and its rate, m, m/s
};

/// Estimates and one sigma of every state behind position, velocity and attitude, in the order of Result::states; SI units.
struct ParameterRow {
    Time time{};
    std::vector<double> value, std;
};

/// The whole covariance at one time: column by column, states in the order of Result::states, which here begins with position,
/// velocity and attitude in the axes of the mechanization; SI units.
struct CovarianceRow {
    Time time{};
    std::vector<double> covariance;
};

/// GNSS epochs withheld in an outage and the first one after it, compared at the antenna: north, east, down.
struct OutageEpoch {
    int outage = -1;                                        ///< index into Settings::outages
    Time time{};                                            ///< stamp of the fix
    bool end = false;                                       ///< the first fix at or after the end, before its own update
    Eigen::Vector3d error = Eigen::Vector3d::Zero();        ///< estimate minus GNSS, m
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< predicted one sigma of that difference, m
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< the part of it that is the filter's own uncertainty, m
    /// One sigma of the difference by what is reported of the solution, hypotheses that are not decided with it, and by the whole variance of
    /// the fix, as if none of the fix's slow errors were part of the solution's, m.
    Eigen::Vector3d sigma_apart = Eigen::Vector3d::Zero();
};

/// How far off the position may be after an epoch of ranges, where Settings asks for protection levels (ProtectionSettings has the risk).
struct ProtectionRow {
    Time time{};
    double horizontal = 0.0, vertical = 0.0;  ///< m
    int used = 0, excluded = 0;               ///< pseudoranges and rates
    int alarm = -1;                           ///< index into RangingLog::sources: found wrong at this epoch
};

/// Intermediate coupling: the receiver's own filter against the tight one, north, east, down, after an epoch of ranges.
struct CrossCheck {
    Time time{};
    Eigen::Vector3d difference = Eigen::Vector3d::Zero();  ///< tight minus receiver, m, of the antenna
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();       ///< of it when both are right, m
    bool agrees = true;
    bool receiver_leads = false;  ///< the solution is the receiver's
};

/// The solution at one of Settings::output_instants, of the point of the user's choice where there is one.
struct InstantRow {
    std::size_t index = 0;  ///< into them
    SolutionRow row;
};

/// One pass over the data, forward or smoothed.
struct Trajectory {
    std::vector<SolutionRow> rows;
    std::vector<SolutionRow> point;             ///< of the same times at Settings::output_lever_arm_b; empty where that is zero
    std::vector<InstantRow> instants;           ///< those inside the pass, in order
    std::vector<SensorErrorRow> sensor_errors;  ///< at most 1 Hz
    std::vector<ParameterRow> parameters;       ///< at most 1 Hz
    std::vector<CovarianceRow>
        covariances;               ///< at the output rate, forward pass only, where Settings::covariance_rows asks for it
    std::vector<StateRow> states;  ///< at most 1 Hz, forward pass only, where Settings::state_rows asks for it
    std::vector<OutageEpoch> outage_epochs;
    std::vector<ProtectionRow> protection;  ///< one an epoch of ranges, forward pass only
};

struct Settings;

/// A setting that was fitted to the innovations of a trial run.
struct TunedSetting {
    std::string key;        ///< of dataset.toml
    double sigma = 0.0;     ///< by the curvature of the likelihood, which takes innovations for independent
    bool relative = false;  ///< sigma is a share of the value, not in SI
    bool at_floor = false;  ///< the fit was smaller than such a device can be: a bound is used
};

/// What start-up and the estimators of settings found.
struct Findings {
    Time aligned_at{};                                       ///< heading known from here on
    bool heading_found = true;                               ///< false: it starts at a guess
    std::string alignment;                                   ///< one sentence: which method, what it found
    Eigen::Vector3d mounting_rpy = Eigen::Vector3d::Zero();  ///< rad, used (given or estimated)
    Eigen::Vector3d std_mounting_rpy = Eigen::Vector3d::Zero();
    double position_latency = 0.0, velocity_latency = 0.0, height_latency = 0.0, velocity_down_latency = 0.0;  ///< s, used
    Eigen::Vector3d std_position_scale = Eigen::Vector3d::Ones();  ///< factor applied to default GNSS sigmas
    Eigen::Vector3d std_velocity_scale = Eigen::Vector3d::Ones();
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< m, used or estimated
    double gyro_noise = 0.0, accel_noise = 0.0;             ///< rad/sqrt(s), m/s/sqrt(s), used or estimated
    Time started_at{};                                      ///< of the initial state
    double heading = not_given, std_heading = not_given;    ///< rad, of the initial state
    std::vector<TunedSetting> tuned;
    Time tuned_from{}, tuned_to{};             ///< span of the trial runs
    std::shared_ptr<const Settings> in_force;  ///< with everything that was found, nothing left to be estimated; null: as given
};

struct Counters {
    std::size_t imu_epochs = 0, imu_gaps = 0, imu_duplicates = 0;
    double imu_rate = 0.0;         ///< Hz, median
    double longest_imu_gap = 0.0;  ///< s
    std::size_t gnss_epochs = 0, gnss_accepted = 0, gnss_rejected = 0, gnss_withheld = 0;
};

struct Result {
    std::vector<LayoutBlock> states;       ///< of the filter
    Trajectory forward;                    ///< always filled
    Trajectory receiver;                   ///< medium coupling: the receiver's own filter, of the antenna; attitude NaN
    std::vector<CrossCheck> cross_checks;  ///< medium coupling
    Trajectory smoothed;                   ///< empty unless Settings::smooth
    std::vector<SolutionRow>
        backward;  ///< of the backward filter before the fix of each time, in order of time; see Settings::backward
    std::vector<AidRecord> aids;  ///< of the forward pass
    std::vector<Alert> alerts;    ///< where exclusions begin and end
    std::vector<Time> legs;  ///< first inertial sample of each part that was navigated by itself, in order; one without pauses
    Findings findings;
    Counters counters;
    double filter_seconds = 0.0;  ///< wall time of the forward pass alone, for timing only
    double open_attitude = 0.0;   ///< rad, largest attitude error that an open loop carried beside its nominal state
};

}  // namespace schuler::filter
