// Results of processing one data set: solution, innovations, sensor errors and findings.
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

/// Excluded: rejected because the integrity monitor has excluded the channel.
enum class MeasurementStatus { Accepted, Rejected, Withheld, Excluded };

/// Finding: a failed test of the integrity monitor (IntegritySettings), or the explanation of refused fixes.
enum class IntegrityTest {
    Tolerance,
    Innovation,
    Slow,
    Readmitted,  ///< the channel is used again
    Returned,    ///< the receiver's fault has ended: the estimate is opened and follows it
    Unjudged,    ///< from here on: the solution of the uncoupled scheme is too tilted to judge a fix
    Jump,        ///< positions jumped to another level, not sensed by the inertial unit
    JumpBack,    ///< ... and came back
    OtherLevel,  ///< the level after a jump has been held longer than the one before and is now accepted
    Navigation,  ///< the navigation was wrong and its covariance was increased
    Receiver     ///< the receiver was wrong for some fixes and agrees again
};

/// A fault, its origin and time.
struct Alert {
    Time time;             ///< of the fix
    MeasurementKind kind;  ///< GnssPosition or GnssVelocity
    IntegrityTest test;
    double size = 0.0;  ///< m or m/s, size of the fault found from refused fixes
};

/// One measurement epoch as processed by the filter.
struct MeasurementRecord {
    Time time;   ///< validity time
    Time stamp;  ///< time in the log
    MeasurementKind kind;
    MeasurementStatus status;
    int dof = 0;      ///< number of used components; the others have sigma 0 (GNSS: north, east, down in their places)
    int source = -1;  ///< of a range: index into RangingLog::sources
    Eigen::Vector3d innovation = Eigen::Vector3d::Zero();   ///< estimate minus measured (NED for GNSS), before its own update
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< predicted one sigma of the innovation
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< contribution of the filter's own uncertainty
    double nis = 0.0;                                       ///< normalised innovation squared of the dof components together
    bool other_level =
        false;  ///< a position corrected for a jump of the receiver (refused_fixes.h), which the innovation excludes
};

/// Estimated sensor errors at one instant (estimate, one sigma).
struct SensorErrorRow {
    Time time;
    Eigen::Vector3d gyro_bias, std_gyro_bias;      ///< rad/s
    Eigen::Vector3d accel_bias, std_accel_bias;    ///< m/s^2
    Eigen::Vector3d gyro_scale, std_gyro_scale;    ///< 1 (zero where not estimated)
    Eigen::Vector3d accel_scale, std_accel_scale;  ///< 1
};

/// Estimate and covariance of a block of up to three states; dof 0: the filter has no such states.
struct StateBlock {
    int dof = 0;
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// The filter's states at one instant, block by block, for comparison with a simulated truth.
struct StateRow {
    Time time;
    NavState nav;
    Eigen::Matrix3d P_position, P_velocity, P_attitude;  ///< of the errors north, east, down: m^2, m^2/s^2, rad^2
    StateBlock gyro_bias, accel_bias;                    ///< body axes, rad/s, m/s^2
    StateBlock gnss_position, gnss_velocity;             ///< correlated errors of the receiver, north, east, down, m, m/s
    StateBlock baro_bias;                                ///< m
    Eigen::Matrix<double, 9, 9> P_navigation = Eigen::Matrix<double, 9, 9>::Zero();  ///< joint, of the first three blocks
    StateBlock clock;  ///< tight coupling: c times the receiver's clock error and its rate, m, m/s
};

/// Estimates and one sigma of every state after position, velocity and attitude, in the order of Result::states; SI units.
struct ParameterRow {
    Time time{};
    std::vector<double> value, std;  ///< NaN: a slot that no source or carrier has
    std::vector<std::int16_t>
        sources;  ///< of each slot of the block of sources: index into RangingLog::sources, -1: none; forward pass
};

/// The full covariance at one instant: column by column, states in the order of Result::states, here starting with position,
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
    Eigen::Vector3d sigma_state = Eigen::Vector3d::Zero();  ///< contribution of the filter's own uncertainty, m
    /// One sigma of the difference from the reported uncertainty of the solution, including undecided hypotheses, and the total
    /// variance of the fix, as if none of its slow errors were common to the solution, m.
    Eigen::Vector3d sigma_apart = Eigen::Vector3d::Zero();
};

/// Bound of the position error after an epoch of ranges, if Settings requests protection levels (risk: see ProtectionSettings).
struct ProtectionRow {
    Time time{};
    double horizontal = 0.0, vertical = 0.0;  ///< m
    int used = 0, excluded = 0;               ///< pseudoranges and rates
    int alarm = -1;                           ///< index into RangingLog::sources: source found faulty at this epoch
};

/// Carrier phases relative to a base, after an epoch of ranges.
struct CarrierRow {
    Time time{};
    int phases = 0, slipped = 0;  ///< used; begun anew because they contradicted the others and the inertial prediction
    int ambiguities = 0;          ///< of them that may be integers
    int held = 0;                 ///< with a fixed integer
    double ratio = 0.0;           ///< of the search for integers; 0: none
    bool doubted = false;         ///< most phases contradicted the inertial prediction, which was opened
};

/// Intermediate coupling: the receiver's own filter compared with the tight one, north, east, down, after an epoch of ranges.
struct CrossCheck {
    Time time{};
    Eigen::Vector3d difference = Eigen::Vector3d::Zero();  ///< tight minus receiver, m, of the antenna
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();       ///< of the difference if both are correct, m
    bool agrees = true;
    bool receiver_leads = false;  ///< the solution is taken from the receiver's filter
};

/// The solution at one of Settings::output_instants, at the user's output point if there is one.
struct InstantRow {
    std::size_t index = 0;  ///< index into output_instants
    SolutionRow row;
};

/// One pass over the data, forward or smoothed.
struct Trajectory {
    std::vector<SolutionRow> rows;
    std::vector<SolutionRow> point;             ///< at the same times for Settings::output_lever_arm_b; empty if that is zero
    std::vector<InstantRow> instants;           ///< those within the pass, in order
    std::vector<SensorErrorRow> sensor_errors;  ///< at most 1 Hz
    std::vector<ParameterRow> parameters;       ///< at most 1 Hz
    std::vector<CovarianceRow> covariances;     ///< at the output rate, if requested by Settings::covariance_rows
    std::vector<StateRow> states;               ///< at most 1 Hz, forward pass only, if Settings::state_rows requests it
    std::vector<OutageEpoch> outage_epochs;
    std::vector<CarrierRow> carriers;       ///< one per epoch with carrier phases relative to a base, forward pass only
    std::vector<ProtectionRow> protection;  ///< one per epoch of ranges, forward pass only
};

struct Settings;

/// A setting fitted to the innovations of a trial run.
struct TunedSetting {
    std::string key;        ///< of dataset.toml
    double sigma = 0.0;     ///< from the curvature of the likelihood, which assumes independent innovations
    bool relative = false;  ///< sigma is a fraction of the value, not in SI
    bool at_floor = false;  ///< the fit was below the lower bound for such a device, which is used instead
};

/// Findings of the alignment and of the estimators of settings.
struct Findings {
    Time aligned_at{};                                       ///< heading known from this time on
    bool heading_found = true;                               ///< false: the run starts with an assumed heading
    std::string alignment;                                   ///< one sentence: the method and its result
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
    std::shared_ptr<const Settings> in_force;  ///< with all estimated values; null: as given
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
    Trajectory receiver;                   ///< intermediate coupling: the receiver's own filter, at the antenna; attitude NaN
    std::vector<CrossCheck> cross_checks;  ///< intermediate coupling
    Trajectory smoothed;                   ///< empty unless Settings::smooth
    std::vector<SolutionRow>
        backward;  ///< of the backward filter before the fix at each time, in order of time; see Settings::backward
    std::vector<MeasurementRecord> measurements;  ///< of the forward pass
    std::vector<Alert> alerts;                    ///< start and end of exclusions
    std::vector<Time> legs;  ///< first inertial sample of each separately navigated part, in order; one without pauses
    Findings findings;
    Counters counters;
    double filter_seconds = 0.0;  ///< wall time of the forward pass alone, for timing only
    double open_attitude = 0.0;   ///< rad, largest attitude error held beside the nominal state of an open loop
};

}  // namespace schuler::filter
