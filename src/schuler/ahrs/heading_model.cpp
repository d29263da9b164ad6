#include "schuler/ahrs/heading_model.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::ahrs {

using S = HeadingState;

void HeadingEstimate::correct(const HeadingVector& dx) {
    level_field -= dx.segment<2>(S::level_field);
    place -= dx.segment<2>(S::place);
    bias -= dx.segment<3>(S::bias);
    gyro_matrix -= Eigen::Map<const Eigen::Matrix3d>(dx.data() + S::gyro_matrix);
    hard_iron -= dx.segment<3>(S::hard_iron);
    soft_iron -= Eigen::Map<const Eigen::Matrix3d>(dx.data() + S::soft_iron);
    vertical -= dx(S::vertical);
    delay -= dx(S::delay);
}

double heading_of(const Eigen::Vector2d& level_field) { return -std::atan2(level_field.y(), level_field.x()); }

double HeadingEstimate::heading() const { return heading_of(level_field); }

void HeadingEstimate::turn(double angle) {
    const Eigen::Rotation2Dd R(-angle);
    level_field = R * level_field;
    place = R * place;
}

void FieldMeans::add(const Eigen::Matrix3d& C, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b) {
    C_wb += C;
    Eigen::Matrix3d rate;
    rate << 0.0, -rate_b.z(), rate_b.y(), rate_b.z(), 0.0, -rate_b.x(), -rate_b.y(), rate_b.x(), 0.0;
    const Eigen::Matrix3d swept = C * rate;
    C_rate += swept;
    sweep_w.noalias() += swept * field_b;
    for (int c = 0; c < 3; ++c) by_component.middleCols<3>(3 * c) += C * field_b(c);
}

void FieldMeans::scale(double factor) {
    C_wb *= factor;
    sweep_w *= factor;
    C_rate *= factor;
    by_component *= factor;
}

FieldMeasurement field_measurement(const HeadingEstimate& e, const FieldMeans& means, bool rest) {
    const Eigen::Vector3d sweep = means.sweep_w - means.C_rate * e.hard_iron;
    FieldMeasurement m;
    m.H.setZero();
    // (I + soft iron)^-1 (reading - hard iron) to first order in the soft iron; the field rotates by the rate, so its current
    // value is the earlier one minus the sweep
    m.field_w = means.field_w() - means.C_wb * e.hard_iron - e.delay * sweep;
    for (int k = 0; k < 3; ++k) {
        const Eigen::Matrix3d by_component = means.by_component.middleCols<3>(3 * k) - means.C_wb * e.hard_iron(k);
        m.field_w -= by_component * e.soft_iron.col(k);
        m.H.block<3, 3>(0, S::soft_iron + 3 * k) = -by_component;
    }
    m.innovation = m.field_w - Eigen::Vector3d(e.level_field.x(), e.level_field.y(), e.vertical);
    if (!rest) {
        m.innovation.head<2>() -= e.place;
        m.H(0, S::place) = m.H(1, S::place + 1) = -1.0;
    }
    m.H(0, S::level_field) = m.H(1, S::level_field + 1) = m.H(2, S::vertical) = -1.0;
    m.H.block<3, 3>(0, S::hard_iron) = -means.C_wb + means.C_wb * e.soft_iron + e.delay * means.C_rate;
    m.H.col(S::delay) = -sweep;
    return m;
}

HeadingTurn heading_turn(const HeadingEstimate& e, const Block& block) {
    const double dt = block.duration;
    const Eigen::Vector3d vertical_b = block.C_wb.row(2).transpose(), rate = block.rate_b - e.bias;
    HeadingTurn t;
    // (I + matrix)^-1 to first order
    t.angle = -vertical_b.dot(e.bias + e.gyro_matrix * rate - block.bias_used) * dt;
    t.row.segment<3>(S::bias) = (e.gyro_matrix.transpose() * vertical_b - vertical_b) * dt;
    for (int c = 0; c < 3; ++c) t.row.segment<3>(S::gyro_matrix + 3 * c) = -vertical_b * (rate(c) * dt);
    return t;
}

}  // namespace schuler::ahrs
