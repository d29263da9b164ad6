// States of the heading channel and their observation by a magnetometer: the model shared by forward filter and smoother.
//
// States: the Earth's horizontal field in the level frame w, whose direction is the heading; the local contribution, which does
// not average out while the sensor stays in one room; the gyro bias as estimated by this channel, its scale factors and
// misalignments; the constant field fixed to the sensor (hard iron) and the rotation and scaling of the field (soft iron, and a
// misaligned magnetometer); the vertical field; the age of the magnetometer samples.
//
// With the field as two components instead of heading and magnitude the measurement is linear for any heading: an initial error
// of 90 deg caused by a magnet on the sensor is merely an error of some microtesla for the filter.
#pragma once

#include "schuler/ahrs/block.h"

#include <Eigen/Core>

namespace schuler::ahrs {

inline constexpr int heading_states = 30;
using HeadingVector = Eigen::Matrix<double, heading_states, 1>;
using HeadingMatrix = Eigen::Matrix<double, heading_states, heading_states>;

/// Indices of the states. The matrices are stored by columns: element (r, c) at 3 c + r.
struct HeadingState {
    static constexpr int level_field = 0, place = 2, bias = 4, gyro_matrix = 7, hard_iron = 16, soft_iron = 19, vertical = 28,
                         delay = 29;
    static constexpr int turning = 4;  ///< the first ones, in w axes, which rotate with it
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

    /// Subtracts an estimated error (estimate minus truth).
    void correct(const HeadingVector& dx);
    /// rad, of w from magnetic north.
    [[nodiscard]] double heading() const;
    /// T
    [[nodiscard]] double horizontal() const { return level_field.norm(); }
    /// w has rotated by a further `angle` (rad) relative to north.
    void turn(double angle);
};

/// Means over the magnetometer samples of an update; all measured quantities enter linearly.
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

/// The estimated field in w, its residual, and the derivative of that with respect to the state errors.
struct FieldMeasurement {
    Eigen::Vector3d field_w, innovation;
    Eigen::Matrix<double, 3, heading_states> H;
};
/// `rest`: the sensor is stationary, so the local contribution differs from that in motion.
[[nodiscard]] FieldMeasurement field_measurement(const HeadingEstimate& estimate, const FieldMeans& means, bool rest = false);

/// Heading (rad) of a frame with this horizontal part of the field.
[[nodiscard]] double heading_of(const Eigen::Vector2d& level_field);

/// Heading errors (rad) of a field levelled with these tilt errors (rad, w axes): the vertical field has a horizontal part.
template <int Columns>
[[nodiscard]] Eigen::Matrix<double, 1, Columns> heading_of_tilt(const Eigen::Vector2d& level_field, double vertical,
                                                                const Eigen::Matrix<double, 2, Columns>& tilt) {
    return vertical / level_field.squaredNorm() * level_field.transpose() * tilt;
}

/// Change of heading over a block: the excess rotation of the strapdown about the vertical, with the sign reversed.
struct HeadingTurn {
    double angle = 0.0;                         ///< rad
    HeadingVector row = HeadingVector::Zero();  ///< its derivative with respect to the state errors
};
[[nodiscard]] HeadingTurn heading_turn(const HeadingEstimate& estimate, const Block& block);

}  // namespace schuler::ahrs
