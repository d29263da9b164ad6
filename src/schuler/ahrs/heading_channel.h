// Heading channel: rotation of the level frame w from north, from the magnetometer. It reads the tilt channel but never writes to
// it, so no magnetic disturbance can tilt the horizon.
//
// The local contribution to the Earth's field is correlated noise; the more norm, dip or direction depart from their expectation,
// and the longer, the lower the weight of a sample. No sample is discarded. The states are those of heading_model.h.
#pragma once

#include "schuler/ahrs/block.h"
#include "schuler/ahrs/guard.h"
#include "schuler/ahrs/heading_model.h"
#include "schuler/ahrs/settings.h"
#include "schuler/estim/scalar_update.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <limits>

namespace schuler::ahrs {

using TurningRows = Eigen::Matrix<double, HeadingState::turning, heading_states>;

/// Data of one update required by the smoother: the transition since the previous update and the scalars.
struct HeadingRecord {
    bool active = false;                           ///< there was an update; otherwise the block was only propagated
    std::size_t block = 0;                         ///< block of the tilt channel at whose end it was made
    TurningRows transition = TurningRows::Zero();  ///< rows of the states in w axes, minus the identity
    Eigen::Matrix<double, heading_states, 2> P_level =
        Eigen::Matrix<double, heading_states, 2>::Zero();  ///< columns of the covariance after the updates
    Eigen::Vector2d path = Eigen::Vector2d::Zero();        ///< T, level field at the end of the block before the updates
    Eigen::Vector2d correction = Eigen::Vector2d::Zero();  ///< T, removed by the updates
    std::array<estim::ScalarUpdate<heading_states>, 6> updates;
    int count = 0;
    bool field = false;  ///< the last three of them are the magnetometer's
    /// Input: squared residual of the field relative to its expectation, found by an earlier pass; NaN: judged by the innovation.
    double disturbance = std::numeric_limits<double>::quiet_NaN();
};

/// Heading uncertainty from the gyro alone. Its bias error is constant, so rotations add up linearly; its noise adds in squares.
struct FreeTurn {
    double noise = 0.0;  ///< rad^2
    double drift = 0.0;  ///< rad, one sigma
    int levellings = 0;  ///< after each of them the azimuth of w is arbitrary

    /// One sigma of the rotation since `before`, rad; at most that of an unknown heading.
    [[nodiscard]] double std_since(const FreeTurn& before) const;
};

class HeadingChannel {
public:
    HeadingChannel(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis);

    /// A usable magnetometer sample (T) with the attitude and the bias-corrected rate at its time.
    void gather(const Eigen::Matrix3d& C_wb, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b);
    /// Filter update over a block of the tilt channel. `bias`: that channel's gyro bias after it.
    void close(const Block& block, const Eigen::Vector3d& bias, Counters& counters, HeadingRecord* record = nullptr);

    [[nodiscard]] bool started() const { return started_; }
    /// Rotation of w about the vertical from north-east-down, rad; includes the declination if given.
    [[nodiscard]] double heading() const { return estimate_.heading() + settings_.declination; }
    /// The same as a rotation; stored because it is needed at every sample but changes once per block.
    [[nodiscard]] const Eigen::Quaterniond& q_nw() const { return q_nw_; }
    [[nodiscard]] double variance() const;  ///< rad^2
    /// Without any field: possible rotation of w since the first block; undefined after a new levelling.
    [[nodiscard]] const FreeTurn& free_turn() const { return free_turn_; }
    [[nodiscard]] const Eigen::Vector3d& hard_iron() const { return estimate_.hard_iron; }
    [[nodiscard]] double horizontal_field() const { return estimate_.horizontal(); }
    [[nodiscard]] double vertical_field() const { return estimate_.vertical; }
    [[nodiscard]] double delay() const { return estimate_.delay; }
    [[nodiscard]] const HeadingEstimate& estimate() const { return estimate_; }
    [[nodiscard]] double disturbance() const { return level_; }            ///< about 1 in an undisturbed field
    [[nodiscard]] double disturbed_for() const { return disturbed_for_; }  ///< s
    /// T, one sigma of the hard iron in its least determined direction; and of the unexplained part of the last field.
    [[nodiscard]] double hard_iron_std() const;
    [[nodiscard]] double unexplained() const { return unexplained_; }
    /// Log-likelihood of the field's samples so far for this channel, up to a constant common to all channels.
    [[nodiscard]] double evidence() const { return evidence_; }

    // alternative hypotheses about the same samples: see field_watch.h
    /// Takes the samples pending for an update from another channel.
    void share_samples(const HeadingChannel& other);
    /// A magnet of this strength (T) may just have been attached to the sensor or removed.
    void doubt_iron(double std);
    /// The local field may just have changed by this amount (T).
    void doubt_place(double std);
    /// Adopts the estimate of another channel.
    void adopt(const HeadingChannel& other);

private:
    void start(const Block& block, const Eigen::Vector3d& bias);
    [[nodiscard]] double turn_noise(const Block& block) const;
    void pass(const Block& block);
    void propagate(TurningRows& A);
    void update(const Block& block, Counters& counters, HeadingRecord* record);

    HeadingSettings settings_;
    TiltSettings tilt_;
    bool six_axis_;
    bool started_ = false, forget_ = false;
    HeadingEstimate estimate_;
    HeadingMatrix P_ = HeadingMatrix::Zero();
    FieldMeans means_;  ///< sums, until the update
    int samples_ = 0;
    HeadingVector turn_row_ = HeadingVector::Zero();      ///< derivative of the rotation since the last update
    double turned_ = 0.0, duration_ = 0.0, noise_ = 0.0;  ///< rad, s and rad^2, since then
    FreeTurn free_turn_;
    Eigen::Matrix<double, 2, 3> tilt_of_accel_bias_ = Eigen::Matrix<double, 2, 3>::Zero();  ///< of the last block
    double level_ = 1.0, disturbed_for_ = 0.0, evidence_ = 0.0, unexplained_ = 0.0;
    Eigen::Quaterniond q_nw_ = Eigen::Quaterniond::Identity();
};

}  // namespace schuler::ahrs
