// States of the heading channel and how a magnetometer observes them: the model that forward filter and smoother share.
//
// States: the horizontal field of the Earth in the level frame w, whose direction is the heading; what the place adds to it, which does not
// average out where the sensor stays in one room; the gyro's bias as this channel sees it, its scale
// factors and misalignments; the constant field that travels with the sensor (hard iron) and what turns and stretches the field (soft
// iron, and a magnetometer that is mounted askew); the vertical field; the age of the magnetometer's samples.
//
// The field as two components instead of a heading and a size makes the measurement linear, whatever the heading: a start that a magnet
// on the sensor has turned by 90 deg is no more to the filter than an error of so many microtesla.
#pragma once

#include "schuler/ahrs/block.h"

#include <Eigen/Core>

namespace schuler::ahrs {

inline constexpr int heading_states = 30;
using HeadingVector = Eigen::Matrix<double, heading_states, 1>;
using HeadingMatrix = Eigen::Matrix<double, heading_states, heading_states>;

/// Where a state stands. The matrices are stored by columns: element (r, c) at 3 c + r.
struct HeadingState {
    static constexpr int level_field = 0, place = 2, bias = 4, gyro_matrix = 7, hard_iron = 16, soft_iron = 19, vertical = 28,
                         delay = 29;
    static constexpr int turning = 4;  ///< the first, those in w axes, which turn with it
};

struct HeadingEstimate {
    Eigen::Vector2d level_field = Eigen::Vector2d::Zero();  ///< T, w axes
    Eigen::Vector2d place = Eigen::Vector2d::Zero();        ///< T, likewise
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();         ///< rad/s
    Eigen::Matrix3d gyro_matrix = Eigen::Matrix3d::Zero();  ///< measured rate = (I + matrix) rate + bias
    Eigen::Vector3d hard_iron = Eigen::Vector3d::Zero();    ///< T
    Eigen::Matrix3d soft_iron = Eigen::Matrix3d::Zero();    ///< measured field = (I + matrix) field + hard iron
    double vertical = 0.0;                                  ///< T, down
    double delay = 0.0;                                     ///< s

    /// Takes an estimated error (estimate minus truth) off.
    void correct(const HeadingVector& dx);
    /// rad, of w from magnetic north.
    [[nodiscard]] double heading() const;
    /// T
    [[nodiscard]] double horizontal() const { return level_field.norm(); }
    /// w has turned by `angle` (rad) more against north.
    void turn(double angle);
};

/// Means over the magnetometer samples of an update; all that is measured enters linearly.
struct FieldMeans {
    Eigen::Matrix3d C_wb = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 9> by_component =
        Eigen::Matrix<double, 3, 9>::Zero();            ///< T, C_wb times x, times y, times z of the field
    Eigen::Vector3d sweep_w = Eigen::Vector3d::Zero();  ///< T/s, C_wb times (rate x field)
    Eigen::Matrix3d C_rate = Eigen::Matrix3d::Zero();   ///< rad/s, C_wb times [rate x]

    void add(const Eigen::Matrix3d& C, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b);
    void scale(double factor);
    /// T, as measured.
    [[nodiscard]] Eigen::Vector3d field_w() const { return by_component.col(0) + by_component.col(4) + by_component.col(8); }
};

/// The field in w as the estimate sees it, what is left of it beyond the expected, and the derivative of that by the states' errors.
struct FieldMeasurement {
    Eigen::Vector3d field_w, innovation;
    Eigen::Matrix<double, 3, heading_states> H;
};
/// `rest`: the sensor rests somewhere, so what the place adds is not what it adds where the sensor moves.
[[nodiscard]] FieldMeasurement field_measurement(const HeadingEstimate& estimate, const FieldMeans& means, bool rest = false);

/// Heading (rad) of a frame in which the field's horizontal part is this.
[[nodiscard]] double heading_of(const Eigen::Vector2d& level_field);

/// By how much the heading changes over a block: what the strapdown turned too much about the vertical, with the sign turned.
struct HeadingTurn {
    double angle = 0.0;                         ///< rad
    HeadingVector row = HeadingVector::Zero();  ///< its derivative by the states' errors
};
[[nodiscard]] HeadingTurn heading_turn(const HeadingEstimate& estimate, const Block& block);

}  // namespace schuler::ahrs
