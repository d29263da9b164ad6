// From settings to the filter of a run: states, processes and initial covariance. A coupling is a selection of these.
#pragma once

#include "schuler/filter/update/pass.h"

namespace schuler::filter {

/// Initial state of a run and its uncertainty.
struct Start {
    NavState nav;
    bool at_antenna = false;                     ///< the position is that of the antenna: the filter begins at the IMU
    Eigen::Vector3d std_position, std_velocity;  ///< NED
    Eigen::Vector3d std_rpy;                     ///< rad, mapped to the attitude error by its Jacobian
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
    Eigen::Vector3d std_gyro_bias, std_accel_bias;
    /// 1 if a component (north, east, down) comes from a fix and thus contains the receiver's slow error, otherwise 0.
    Eigen::Vector3d position_of_fix = Eigen::Vector3d::Zero(), velocity_of_fix = Eigen::Vector3d::Zero();
    /// Rate of change of quantities from fixes: position, m/s, velocity, m/s^2 (north, east, down), and heading, rad/s; 0 if not
    /// from fixes. A start from fixes that are late by dt is wrong by dt times these, whatever the later fixes are.
    Eigen::Vector3d position_rate = Eigen::Vector3d::Zero(), velocity_rate = Eigen::Vector3d::Zero();
    double heading_rate = 0.0;
    /// The heading is from the magnetometer or the heading sensor and contains their constant error, which is a state.
    bool heading_of_mag = false, heading_of_sensor = false;
    double std_mounting = 0.03;  ///< rad
    /// rad: distance to other headings not excluded by the fixes. Included in the reported sigma, but not in the linear filter.
    double undecided_heading = 0.0;
    std::size_t increment = 0;  ///< first increment to process
    ImuIncrement previous{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Instruments other than the IMU for which there are states.
struct Sensors {
    bool baro = false, mag = false, odometer = false, heading = false;
    int gauges = 0;  ///< number of gauges
    bool log = false;
    bool carriers = false;     ///< carrier phases relative to a base station
    bool phase_rates = false;  ///< range rates from the carrier phases of two epochs
};
[[nodiscard]] Sensors sensors_of(const Recording& recording);

/// The states required by these settings and sensors; they may exceed the capacity of a filter: Layout::fits().
[[nodiscard]] Layout layout_with(const Settings& settings, const Sensors& sensors);
/// The same with the samples of a recording. @throws Error(Input) if they exceed the capacity of a filter.
[[nodiscard]] Layout make_layout(const Settings& settings, const Recording& recording);

/// Processes and noise of these states.
[[nodiscard]] InertialModel make_model(const Settings& settings, const Layout& layout);

/// Limits of the gates and of the slow-ramp test, and declination: the settings' part of a run's data.
void set_limits(RunData& data, const Settings& settings);

/// A run at the start: sigmas of position, velocity and roll, pitch, heading mapped to the error states. `baro_height`: the first
/// one from there on, NaN if there is none. Existing memory of the run is reused: nothing is allocated if it suffices.
template <class Frame>
void set_out(FilterRun<Frame>& run, const InertialModel& model, const Settings& settings, const Start& start, double baro_height);

/// The same for a new run, with the barometer of the data's recording.
template <class Frame>
[[nodiscard]] FilterRun<Frame> first_step(const InertialModel& model, const RunData& data, const Settings& settings,
                                          const Start& start);

/// Covariance of the states shared by all ranges.
template <class Frame>
void start_ranging(InertialFilter<Frame>& filter, const Layout& layout, const sensor::RangingErrorModel& errors);

}  // namespace schuler::filter
