#include "schuler/earth/axes.h"

#include <algorithm>
#include <cmath>

namespace schuler::earth {
namespace {

// Rotations by half and third turns: exact as matrices, with quaternion elements of one half or square roots of one half.
Eigen::Quaterniond quaternion_of(const Eigen::Matrix3d& C) { return Eigen::Quaterniond(C); }

double clamped_asin(double x) { return std::asin(std::clamp(x, -1.0, 1.0)); }

Eigen::Quaterniond earth_turn(double earth_angle) {
    return Eigen::Quaterniond(std::cos(0.5 * earth_angle), 0.0, 0.0, std::sin(0.5 * earth_angle));
}

}  // namespace

Eigen::Matrix3d ned_from(LocalLevelAxes axes) {
    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
    switch (axes) {
        case LocalLevelAxes::NorthEastDown: break;
        case LocalLevelAxes::NorthUpEast: C << 1, 0, 0, 0, 0, 1, 0, -1, 0; break;
        case LocalLevelAxes::EastNorthUp: C << 0, 1, 0, 1, 0, 0, 0, 0, -1; break;
    }
    return C;
}

Eigen::Matrix3d frd_from(BodyAxes axes) {
    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();
    switch (axes) {
        case BodyAxes::ForwardRightDown: break;
        case BodyAxes::ForwardUpRight: C << 1, 0, 0, 0, 0, 1, 0, -1, 0; break;
        case BodyAxes::ForwardLeftUp: C << 1, 0, 0, 0, -1, 0, 0, 0, -1; break;
    }
    return C;
}

Eigen::Matrix3d dcm_in(const AxisConvention& axes, const Eigen::Matrix3d& C_nb) {
    return ned_from(axes.local).transpose() * C_nb * frd_from(axes.body);
}

Eigen::Matrix3d C_nb_from(const AxisConvention& axes, const Eigen::Matrix3d& body_to_local) {
    return ned_from(axes.local) * body_to_local * frd_from(axes.body).transpose();
}

Eigen::Quaterniond quaternion_in(const AxisConvention& axes, const Eigen::Quaterniond& q_nb) {
    return quaternion_of(ned_from(axes.local)).conjugate() * q_nb * quaternion_of(frd_from(axes.body));
}

Eigen::Quaterniond q_nb_from(const AxisConvention& axes, const Eigen::Quaterniond& body_to_local) {
    return quaternion_of(ned_from(axes.local)) * body_to_local * quaternion_of(frd_from(axes.body)).conjugate();
}

PaperAngles paper_a_chapter1_angles(const Eigen::Matrix3d& B) {
    return {std::atan2(-B(1, 2), B(1, 1)), std::atan2(B(1, 0), std::hypot(B(1, 1), B(1, 2))), std::atan2(-B(2, 0), B(0, 0))};
}

PaperAngles paper_a_chapter3_angles(const Eigen::Matrix3d& B) {
    return {std::atan2(-B(2, 2), B(2, 1)), clamped_asin(B(2, 0)), std::atan2(B(0, 0), B(1, 0))};
}

PaperAngles paper_b_angles(const Eigen::Matrix3d& body_to_local) {
    const Eigen::Matrix3d& C = body_to_local;
    return {std::atan2(C(2, 1), C(2, 2)), clamped_asin(C(2, 0)), std::atan2(C(0, 0), C(1, 0))};
}

ScalarLast paper_b_quaternion(const Eigen::Quaterniond& q_nb) { return quaternion_in(paper_b_axes, q_nb).coeffs(); }

Eigen::Quaterniond q_nb_from_paper_b(const ScalarLast& q) {
    return q_nb_from(paper_b_axes, Eigen::Quaterniond(q(3), q(0), q(1), q(2)));
}

Eigen::Matrix3d paper_b_local_to_body(const Eigen::Matrix3d& C_nb) { return dcm_in(paper_b_axes, C_nb).transpose(); }

Eigen::Matrix3d C_eb_from_paper_e(const Eigen::Quaterniond& q_ib, double earth_angle) {
    return (earth_turn(earth_angle).conjugate() * q_ib).toRotationMatrix();
}

Eigen::Quaterniond paper_e_quaternion(const Eigen::Quaterniond& q_eb, double earth_angle) {
    return earth_turn(earth_angle) * q_eb;
}

}  // namespace schuler::earth
