// From settings to the filter that a run needs: states, processes and start covariance. A coupling is a choice of these.
#pragma once

#include "schuler/filter/update/pass.h"

namespace schuler::filter {

/// Where and how uncertain a run starts.
struct Start {
    NavState nav;
    Eigen::Vector3d std_position, std_velocity;  ///< NED
    Eigen::Vector3d std_rpy;                     ///< rad, mapped to the attitude error by its Jacobian
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
    Eigen::Vector3d std_gyro_bias, std_accel_bias;
    /// 1 where a component (north, east, down) comes from a fix and so has the receiver's slow error in it, 0 where it does not.
    Eigen::Vector3d position_of_fix = Eigen::Vector3d::Zero(), velocity_of_fix = Eigen::Vector3d::Zero();
    /// How fast what comes from fixes changes: position, m/s, velocity, m/s^2 (north, east, down), and heading, rad/s; 0 where it does not
    /// come from fixes. A start by fixes that are late by dt is off by dt times these, whatever the fixes after it say.
    Eigen::Vector3d position_rate = Eigen::Vector3d::Zero(), velocity_rate = Eigen::Vector3d::Zero();
    double heading_rate = 0.0;
    /// The heading is what the magnetometer or the sensor of the heading showed: it has the constant error in it that is a state of theirs.
    bool heading_of_mag = false, heading_of_sensor = false;
    double std_mounting = 0.03;  ///< rad
    /// rad: how far other headings lie that the fixes do not refute. What is reported covers them; the filter, which is linear, does not.
    double undecided_heading = 0.0;
    std::size_t increment = 0;  ///< first increment to consume
    ImuIncrement previous{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Which instruments beside the inertial unit there are: those that states are made for.
struct Sensors {
    bool baro = false, mag = false, odometer = false, heading = false;
    int gauges = 0;  ///< how many
    bool log = false;
};
[[nodiscard]] Sensors sensors_of(const Recording& recording);

/// The states that a run with these settings and sensors needs; they may be more than a filter has room for: Layout::fits().
[[nodiscard]] Layout layout_with(const Settings& settings, const Sensors& sensors);
/// Likewise with the samples of a recording. @throws Error(Input) where they are more than a filter has room for.
[[nodiscard]] Layout make_layout(const Settings& settings, const Recording& recording);

/// Processes and noise of these states.
[[nodiscard]] InertialModel make_model(const Settings& settings, const Layout& layout);

/// Limits of the gates and of the slow-ramp test, declination: what settings say of a run's data.
void set_limits(RunData& data, const Settings& settings);

/// A run at the start: sigmas in human coordinates mapped to the error states. `baro_height`: the first one from there on, NaN where
/// there is none. Memory that the run has got is kept: nothing is allocated where it is enough.
template <class Frame>
void set_out(FilterRun<Frame>& run, const InertialModel& model, const Settings& settings, const Start& start, double baro_height);

/// Likewise, a new one, with the barometer of the data's recording.
template <class Frame>
[[nodiscard]] FilterRun<Frame> first_step(const InertialModel& model, const RunData& data, const Settings& settings,
                                          const Start& start);

/// Covariance of the states that ranges have in common.
template <class Frame>
void start_ranging(InertialFilter<Frame>& filter, const Layout& layout, const sensor::RangingErrorModel& errors);

}  // namespace schuler::filter
