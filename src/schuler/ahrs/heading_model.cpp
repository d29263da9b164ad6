#include "schuler/ahrs/heading_model.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::ahrs {

using S = HeadingState;

void HeadingEstimate::correct(const HeadingVector& dx) {
    heading -= dx(S::heading);
    bias -= dx.segment<3>(S::bias);
    gyro_matrix -= Eigen::Map<const Eigen::Matrix3d>(dx.data() + S::gyro_matrix);
    hard_iron -= dx.segment<3>(S::hard_iron);
    soft_iron -= Eigen::Map<const Eigen::Matrix3d>(dx.data() + S::soft_iron);
    horizontal -= dx(S::horizontal);
    vertical -= dx(S::vertical);
    delay -= dx(S::delay);
}

void FieldMeans::add(const Eigen::Matrix3d& C, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b) {
    C_wb += C;
    sweep_w.noalias() += C * rate_b.cross(field_b);
    for (int c = 0; c < 3; ++c) by_component.middleCols<3>(3 * c) += C * field_b(c);
}

void FieldMeans::scale(double factor) {
    C_wb *= factor;
    sweep_w *= factor;
    by_component *= factor;
}

FieldMeasurement field_measurement(const HeadingEstimate& e, const FieldMeans& means) {
    const double c = std::cos(e.heading), s = std::sin(e.heading);
    Eigen::Matrix3d C_nw;
    C_nw << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    const Eigen::Matrix3d C_nb = C_nw * means.C_wb;
    const Eigen::Vector3d sweep = C_nw * means.sweep_w;
    const Eigen::Matrix<double, 3, 9> by_component = C_nw * means.by_component;
    FieldMeasurement m;
    // (I + soft iron)^-1 to the first order of the irons; the field turns past by the rate, so it is now what it was less the sweep
    m.field_n = C_nw * means.field_w() - C_nb * e.hard_iron - e.delay * sweep;
    for (int k = 0; k < 3; ++k) m.field_n -= by_component.middleCols<3>(3 * k) * e.soft_iron.col(k);
    m.innovation = m.field_n - Eigen::Vector3d(e.horizontal, 0.0, e.vertical);
    m.H.setZero();
    m.H(0, S::heading) = -m.field_n.y();
    m.H(1, S::heading) = m.field_n.x();
    m.H.block<3, 3>(0, S::hard_iron) = -C_nb;
    m.H.block<3, 9>(0, S::soft_iron) = -by_component;
    m.H(0, S::horizontal) = m.H(2, S::vertical) = -1.0;
    m.H.col(S::delay) = -sweep;
    return m;
}

HeadingTurn heading_turn(const HeadingEstimate& e, const Block& block) {
    const double dt = block.duration;
    const Eigen::Vector3d vertical_b = block.C_wb.row(2).transpose(), rate = block.rate_b - e.bias;
    HeadingTurn t;
    // (I + matrix)^-1 to the first order
    t.angle = -vertical_b.dot(e.bias + e.gyro_matrix * rate - block.bias_used) * dt;
    t.row.segment<3>(S::bias) = (e.gyro_matrix.transpose() * vertical_b - vertical_b) * dt;
    for (int c = 0; c < 3; ++c) t.row.segment<3>(S::gyro_matrix + 3 * c) = -vertical_b * (rate(c) * dt);
    return t;
}

}  // namespace schuler::ahrs
