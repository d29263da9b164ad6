// Plain structs of instrument output, in SI units and the frames of docs/conventions.md. NaN means "not given".
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/ranging.h"
#include "schuler/core/time.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

namespace schuler {

inline constexpr double not_given = std::numeric_limits<double>::quiet_NaN();
inline Eigen::Vector3d not_given3() { return Eigen::Vector3d::Constant(not_given); }

/// One row of an IMU log as logged: rates (rad/s, m/s^2) or increments (rad, m/s), see ImuKind, in sensor axes.
struct ImuSample {
    Time time;
    Eigen::Vector3d gyro;
    Eigen::Vector3d accel;
};
enum class ImuKind { Rates, Increments };
enum class ImuStamp { Start, Center, End };  ///< which instant of the interval the time stamp refers to

/// Angle and velocity increments of the body over (time - dt, time], body axes (forward-right-down), rad and m/s.
struct ImuIncrement {
    Time time;
    double dt;
    Eigen::Vector3d dtheta;
    Eigen::Vector3d dv;
};

enum class FixType : std::uint8_t { None, Autonomous, Differential, RtkFixed, RtkFloat, Unknown };

/// One epoch of a GNSS receiver's solution at the antenna.
struct GnssFix {
    Time time;
    Geodetic position;                            ///< NaN members if absent
    Eigen::Vector3d velocity_n = not_given3();    ///< north, east, down, m/s
    Eigen::Vector3d std_position = not_given3();  ///< north, east, down, m, one sigma
    Eigen::Vector3d std_velocity = not_given3();  ///< north, east, down, m/s, one sigma
    FixType fix = FixType::Unknown;
    int satellites = -1;
    double position_age = 0.0;  ///< s; the position is valid at time - position_age (0 unless given by the log)
    double velocity_age = 0.0;  ///< s; likewise for the velocity
    double lasting = 1.0;  ///< factor on the position's variance as a measurement, if its error is that of its neighbours too
};

struct BaroSample {
    Time time;
    double height = not_given;    ///< m, barometric height (datum arbitrary: its bias is a state)
    double pressure = not_given;  ///< Pa, static pressure
};

struct MagSample {
    Time time;
    Eigen::Vector3d field_b;  ///< T, body axes (sensor axes until mounted)
};

/// Speed of a wheeled vehicle over ground along its forward axis.
struct OdometerSample {
    Time time;
    double speed = not_given;  ///< m/s, negative backwards
    double std = not_given;    ///< m/s, one sigma
};

/// Heading of the body's forward axis from a separate sensor: two antennas, a gyrocompass.
struct HeadingSample {
    Time time;
    double heading = not_given;  ///< rad, clockwise from true north
    double std = not_given;      ///< rad, one sigma
};

/// Heights from up to three gauges, m; NaN if a gauge is absent.
struct GaugeSample {
    Time time;
    Eigen::Vector3d height = not_given3();
};

/// Velocity relative to the Earth at a velocity log, body axes, m/s.
struct BodyVelocitySample {
    Time time;
    Eigen::Vector3d velocity_b;
};

/// Truth or another program's solution. Absent members are NaN.
struct ReferenceSample {
    Time time;
    Geodetic position{not_given, not_given, not_given};
    Eigen::Vector3d velocity_n = not_given3();
    Eigen::Vector3d rpy = not_given3();  ///< roll, pitch, heading, rad
    bool movement = true;
};

/// The instruments of one data set on one time axis, as logged (sensor axes), sorted by time in each channel.
struct Recording {
    std::vector<ImuSample> imu;
    std::vector<GnssFix> gnss;
    std::vector<BaroSample> baro;
    std::vector<MagSample> mag;
    std::vector<OdometerSample> odometer;
    std::vector<HeadingSample> heading;
    std::vector<GaugeSample> gauges;
    std::vector<BodyVelocitySample> body_velocity;
    RangingLog ranges;
    std::vector<ReferenceSample> reference;
};

/// The logs of the instruments beside IMU and receiver.
inline constexpr std::tuple instrument_logs{&Recording::baro,    &Recording::mag,    &Recording::odometer,
                                            &Recording::heading, &Recording::gauges, &Recording::body_velocity};

/// `visit(log)` for each log of these instruments.
template <class R, class Visit>
void for_each_instrument_log(R& recording, Visit&& visit) {
    std::apply([&](const auto... log) { (visit(recording.*log), ...); }, instrument_logs);
}

}  // namespace schuler
