// Heading channel: how far the level frame w is turned from north, from the magnetometer. It reads the tilt channel and never
// writes to it, so no magnetic disturbance can tilt the horizon.
//
// States: heading, the gyro bias as this channel sees it, the constant field that travels with the sensor (hard iron), the local
// horizontal and vertical field, and the age of the magnetometer's samples. What a place adds to the Earth's field is noise with
// a memory; the more norm, dip or direction depart from what is expected, and the longer, the less the sample weighs.
#pragma once

#include "schuler/ahrs/block.h"
#include "schuler/ahrs/guard.h"
#include "schuler/ahrs/settings.h"
#include "schuler/estim/scalar_update.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace schuler::ahrs {

inline constexpr int heading_states = 10;  ///< heading, gyro bias (b), hard iron (b), horizontal and vertical field, delay
using HeadingVector = Eigen::Matrix<double, heading_states, 1>;
using HeadingMatrix = Eigen::Matrix<double, heading_states, heading_states>;

/// What the smoother needs of one block.
struct HeadingRecord {
    Eigen::Vector3d vertical_b = Eigen::Vector3d::Zero();  ///< d(heading)/d(bias) is minus this times the duration
    double duration = 0.0;
    bool active = false;  ///< the channel had started: the transition counts
    HeadingVector P_heading = HeadingVector::Zero();  ///< row of the covariance after the updates
    double heading = 0.0;  ///< after the updates
    double correction = 0.0;  ///< by which the updates changed it
    std::array<estim::ScalarUpdate<heading_states>, 6> updates;
    int count = 0;
};

class HeadingChannel {
public:
    HeadingChannel(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis);

    /// A usable magnetometer sample (T) with the attitude and the rate (bias taken off) at its time.
    void gather(const Eigen::Matrix3d& C_wb, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b);
    /// Filter update over a block of the tilt channel. `bias`: that channel's gyro bias after it.
    void close(const Block& block, const Eigen::Vector3d& bias, Counters& counters, HeadingRecord* record = nullptr);

    [[nodiscard]] bool started() const { return started_; }
    /// Rotation of w about the vertical from north-east-down, rad; with the declination where one was given.
    [[nodiscard]] double heading() const { return heading_ + settings_.declination; }
    /// The same as a rotation; kept, since it is wanted at every sample and changes once a block.
    [[nodiscard]] const Eigen::Quaterniond& q_nw() const { return q_nw_; }
    [[nodiscard]] double variance() const { return P_(0, 0); }  ///< rad^2
    [[nodiscard]] const Eigen::Vector3d& hard_iron() const { return hard_iron_; }
    [[nodiscard]] double horizontal_field() const { return horizontal_; }
    [[nodiscard]] double vertical_field() const { return vertical_; }
    [[nodiscard]] double delay() const { return delay_; }
    [[nodiscard]] double disturbance() const { return level_; }  ///< about 1 in an undisturbed field

private:
    void start(const Eigen::Vector3d& bias);
    void propagate(const Block& block);
    void watch_steadiness(const Eigen::Vector3d& field_n, double dt);
    [[nodiscard]] bool steady() const;
    void learn_anew();

    HeadingSettings settings_;
    TiltSettings tilt_;
    bool six_axis_;
    bool started_ = false;
    double heading_ = 0.0, horizontal_ = 0.0, vertical_ = 0.0, delay_ = 0.0;
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero(), hard_iron_ = Eigen::Vector3d::Zero();
    HeadingMatrix P_ = HeadingMatrix::Zero();
    Eigen::Vector3d field_w_ = Eigen::Vector3d::Zero(), sweep_w_ = Eigen::Vector3d::Zero();
    Eigen::Matrix3d C_wb_ = Eigen::Matrix3d::Zero();
    int samples_ = 0;
    double level_ = 1.0, disturbed_for_ = 0.0;
    Eigen::Vector2d lately_ = Eigen::Vector2d::Zero();  ///< T, running means of the horizontal and vertical field
    double unsteadiness_ = 0.0;                         ///< T^2, and of the squared departure from them
    Eigen::Quaterniond q_nw_ = Eigen::Quaterniond::Identity();
};

}  // namespace schuler::ahrs
