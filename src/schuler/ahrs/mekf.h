// The recommended attitude filter: multiplicative error states, tilt and heading in separate channels. Real time: step() takes
// constant time except for the block update, which occurs at a fixed rate and is bounded; nothing allocates or throws after
// construction.
#pragma once

#include "schuler/ahrs/field_watch.h"
#include "schuler/ahrs/guard.h"
#include "schuler/ahrs/heading_channel.h"
#include "schuler/ahrs/settings.h"
#include "schuler/ahrs/tilt_channel.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ahrs {

class Mekf {
public:
    /// @throws Error(Input) for invalid settings.
    explicit Mekf(const MekfSettings& settings);

    /// One IMU sample, body axes: the mean rate (rad/s) and specific force (m/s^2) over the last dt (s, positive).
    /// Values that are not finite, saturated or frozen are bridged. Returns true when a block was closed.
    bool step(double dt, const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b, TiltRecord* tilt = nullptr,
              HeadingRecord* heading = nullptr);
    /// A magnetometer sample (T, body axes) that belongs to the last IMU sample.
    void magnetometer(const Eigen::Vector3d& field_b);
    /// Speed over ground along the body's x axis (m/s) and its one sigma: used to remove the centripetal and forward acceleration
    /// of a vehicle from the tilt.
    void forward_speed(double speed, double std) { tilt_.forward_speed(speed, std); }

    [[nodiscard]] bool started() const { return tilt_.started(); }
    [[nodiscard]] Eigen::Quaterniond q_nb() const;
    /// One sigma of the small rotation about north, east and down, rad.
    [[nodiscard]] Eigen::Vector3d std_phi() const;
    /// Covariance of that rotation in n, rad^2: tilt and heading separate, the heading including the effect of the tilt.
    [[nodiscard]] Eigen::Matrix3d covariance_phi() const;
    [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return tilt_.gyro_bias(); }
    [[nodiscard]] const TiltChannel& tilt() const { return tilt_; }
    [[nodiscard]] const HeadingChannel& heading() const { return heading_; }
    [[nodiscard]] const Counters& counters() const { return counters_; }

private:
    MekfSettings settings_;
    TiltChannel tilt_;
    HeadingChannel heading_;
    FieldWatch watch_;
    InstrumentGuard gyro_guard_, accel_guard_, field_guard_;
    Counters counters_;
    Eigen::Vector3d last_rate_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d start_force_ = Eigen::Vector3d::Zero();
    double start_time_ = 0.0, start_turn_ = 0.0;  ///< s, rad
    UsualStep usual_step_;
    double swing_ = 0.0;  ///< rad/s, largest rotation rate of the last second or so
};

}  // namespace schuler::ahrs
