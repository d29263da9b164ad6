#include "schuler/ahrs/dcm_filter.h"

#include "schuler/ahrs/settings.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"

#include <Eigen/LU>

#include <fmt/format.h>

#include <cmath>

namespace schuler::ahrs {
namespace {

/// Kalman update of a row measured directly, variance r on each component.
void update_row(Eigen::Vector3d& row, Eigen::Matrix3d& P, const Eigen::Vector3d& measured, double r) {
    const Eigen::Matrix3d S = P + r * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d K = P * S.inverse();
    row += K * (measured - row);
    P -= K * P;
    P = (0.5 * (P + P.transpose())).eval();
}

}  // namespace

void VectorFilterSettings::check() const {
    check_positive({{"gyro_noise", gyro_noise},
                    {"accel_std", accel_std},
                    {"field_std", field_std},
                    {"gravity", gravity},
                    {"horizontal_field", horizontal_field}});
}

DcmFilter::DcmFilter(const VectorFilterSettings& settings) : settings_(settings) { settings.check(); }

void DcmFilter::propagate(double dt, const Eigen::Vector3d& rate_b) {
    const Eigen::Matrix3d Phi = math::dcm_from_rotation_vector(-rate_b * dt);  // r' = -[w x] r
    const double q = settings_.gyro_noise * settings_.gyro_noise * dt;
    up_ = Phi * up_;
    north_ = Phi * north_;
    for (Eigen::Matrix3d* P : {&P_up_, &P_north_}) {
        *P = (Phi * *P * Phi.transpose()).eval();
        P->diagonal().array() += q;
    }
}

void DcmFilter::accelerometer(const Eigen::Vector3d& force_b) {
    const double r = settings_.accel_std / settings_.gravity;
    const Eigen::Vector3d east = north_.cross(up_);
    const double before = east.dot(P_up_ * east);
    update_row(up_, P_up_, force_b / settings_.gravity, r * r);
    leak_.tilt_step(east.dot(P_up_ * east) / before);
    up_.normalize();
}

void DcmFilter::magnetometer(const Eigen::Vector3d& field_b) {
    const double r = settings_.field_std / settings_.horizontal_field;
    // the field has a downward vertical component: m = H north - Z up
    const Eigen::Vector3d measured = (field_b + settings_.vertical_field * up_) / settings_.horizontal_field;
    const Eigen::Vector3d east = north_.cross(up_);
    const double before = east.dot(P_north_ * east);
    update_row(north_, P_north_, measured, r * r);
    leak_.heading_step(1.0 - east.dot(P_north_ * east) / before, settings_.vertical_field / settings_.horizontal_field,
                       east.dot(P_up_ * east));
    north_ -= north_.dot(up_) * up_;
    if (north_.squaredNorm() < 1e-12) north_ = up_.unitOrthogonal();
    north_.normalize();
}

Eigen::Matrix3d DcmFilter::C_nb() const {
    // between accelerometer updates the north row is orthogonal only as of the last magnetometer update
    const Eigen::Vector3d north = (north_ - north_.dot(up_) * up_).normalized();
    Eigen::Matrix3d C_nb;
    C_nb.row(0) = north.transpose();
    C_nb.row(1) = north.cross(up_).transpose();
    C_nb.row(2) = -up_.transpose();
    return C_nb;
}

Eigen::Matrix3d DcmFilter::covariance_phi() const {
    const Eigen::Matrix3d C = C_nb();
    const Eigen::Vector3d north = C.row(0).transpose(), east = C.row(1).transpose();
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    // d(up) = -phi_north east + phi_east north in b components up to sign; d(north) along east is the heading
    P(0, 0) = east.dot(P_up_ * east);
    P(1, 1) = north.dot(P_up_ * north);
    P(0, 1) = P(1, 0) = -east.dot(P_up_ * north);
    P(2, 2) = east.dot(P_north_ * east) + leak_.variance;
    P(0, 2) = P(2, 0) = leak_.covariance;
    return P;
}

}  // namespace schuler::ahrs
