// What the heading channel believes and how a magnetometer shows it: the model that forward filter and smoother share.
//
// States: heading; the gyro's bias as this channel sees it, its scale factors and misalignments; the constant field that travels
// with the sensor (hard iron) and what turns and stretches the field (soft iron, and a magnetometer that is mounted askew); the local
// horizontal and vertical field; the age of the magnetometer's samples.
#pragma once

#include "schuler/ahrs/block.h"

#include <Eigen/Core>

namespace schuler::ahrs {

inline constexpr int heading_states = 28;
using HeadingVector = Eigen::Matrix<double, heading_states, 1>;
using HeadingMatrix = Eigen::Matrix<double, heading_states, heading_states>;

/// Where a state stands. The matrices are stored by columns: element (r, c) at 3 c + r.
struct HeadingState {
    static constexpr int heading = 0, bias = 1, gyro_matrix = 4, hard_iron = 13, soft_iron = 16, horizontal = 25, vertical = 26,
                         delay = 27;
};

struct HeadingEstimate {
    double heading = 0.0;                                       ///< rad, of w from magnetic north
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();             ///< rad/s
    Eigen::Matrix3d gyro_matrix = Eigen::Matrix3d::Zero();      ///< measured rate = (I + matrix) rate + bias
    Eigen::Vector3d hard_iron = Eigen::Vector3d::Zero();        ///< T
    Eigen::Matrix3d soft_iron = Eigen::Matrix3d::Zero();        ///< measured field = (I + matrix) field + hard iron
    double horizontal = 0.0, vertical = 0.0;                    ///< T, north and down
    double delay = 0.0;                                         ///< s

    /// Takes an estimated error (estimate minus truth) off.
    void correct(const HeadingVector& dx);
};

/// Means over the magnetometer samples of an update; all that is measured enters linearly.
struct FieldMeans {
    Eigen::Matrix3d C_wb = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 9> by_component = Eigen::Matrix<double, 3, 9>::Zero();  ///< T, C_wb times x, times y, times z of the field
    Eigen::Vector3d sweep_w = Eigen::Vector3d::Zero();          ///< T/s, C_wb times (rate x field)

    void add(const Eigen::Matrix3d& C, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b);
    void scale(double factor);
    /// T, as measured.
    [[nodiscard]] Eigen::Vector3d field_w() const { return by_component.col(0) + by_component.col(4) + by_component.col(8); }
};

/// The field in n as the estimate sees it, what is left of it beyond the expected, and the derivative of that by the states' errors.
struct FieldMeasurement {
    Eigen::Vector3d field_n, innovation;
    Eigen::Matrix<double, 3, heading_states> H;
};
[[nodiscard]] FieldMeasurement field_measurement(const HeadingEstimate& estimate, const FieldMeans& means);

/// By how much the heading changes over a block: what the strapdown turned too much about the vertical, with the sign turned.
struct HeadingTurn {
    double angle = 0.0;                                         ///< rad
    HeadingVector row = HeadingVector::Zero();                  ///< its derivative by the states' errors
};
[[nodiscard]] HeadingTurn heading_turn(const HeadingEstimate& estimate, const Block& block);

}  // namespace schuler::ahrs
