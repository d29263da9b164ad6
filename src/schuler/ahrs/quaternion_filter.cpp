#include "schuler/ahrs/quaternion_filter.h"

#include "schuler/math/rotation.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::ahrs {
namespace {

using Sigma = Eigen::Matrix<double, 4, 3>;

/// d(q)/d(rotation)/2 in body axes: [[e x] + q0 I; -e^T].
Sigma sigma(const Eigen::Vector4d& q) {
    Sigma s;
    s.topRows<3>() = math::skew(q.head<3>()) + q(3) * Eigen::Matrix3d::Identity();
    s.row(3) = -q.head<3>().transpose();
    return s;
}

/// The same for a rotation in navigation axes; the columns are unit vectors.
Sigma sigma_n(const Eigen::Vector4d& q) {
    Sigma s;
    s.topRows<3>() = q(3) * Eigen::Matrix3d::Identity() - math::skew(q.head<3>());
    s.row(3) = -q.head<3>().transpose();
    return s;
}

}  // namespace

QuaternionFilter::QuaternionFilter(const VectorFilterSettings& settings) : settings_(settings) { settings.check(); }

void QuaternionFilter::propagate(double dt, const Eigen::Vector3d& rate_b) {
    // q' = Omega q / 2 has the closed form of a product with the quaternion of the step
    const Eigen::Quaterniond step = math::quaternion_from_rotation_vector(rate_b * dt);
    Eigen::Matrix4d Phi;
    Phi.topLeftCorner<3, 3>() = step.w() * Eigen::Matrix3d::Identity() - math::skew(step.vec());
    Phi.topRightCorner<3, 1>() = step.vec();
    Phi.bottomLeftCorner<1, 3>() = -step.vec().transpose();
    Phi(3, 3) = step.w();
    x_ = Phi * x_;
    const Sigma s = sigma(x_);
    const double q = 0.25 * settings_.gyro_noise * settings_.gyro_noise * dt;
    P_ = (Phi * P_ * Phi.transpose() + q * s * s.transpose()).eval();
}

void QuaternionFilter::update(const Eigen::Vector3d& measured_b, const Eigen::Vector3d& reference_n, double variance,
                              bool heading_only) {
    const Eigen::Vector3d sum = 0.5 * (measured_b + reference_n), half = 0.5 * (measured_b - reference_n);
    Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
    H.topLeftCorner<3, 3>() = -math::skew(sum);
    H.topRightCorner<3, 1>() = half;
    H.bottomLeftCorner<1, 3>() = -half.transpose();
    const Sigma s = sigma(x_);
    const Eigen::Matrix4d R = 0.25 * variance * s * s.transpose() + settings_.regularization * Eigen::Matrix4d::Identity();
    const Eigen::Matrix4d S = H * P_ * H.transpose() + R;
    Eigen::Matrix4d K = P_ * H.transpose() * S.inverse();
    if (heading_only) {
        const Eigen::Vector4d u = sigma_n(x_).col(2);  // the tangent quaternion of a rotation about the vertical
        K = (u * (u.transpose() * K)).eval();
    } else {
        K -= (x_ * (x_.transpose() * K)).eval();  // the norm is known: only rotations are corrected
    }
    const Eigen::Matrix4d rest = Eigen::Matrix4d::Identity() - K * H;
    x_ = (rest * x_).normalized();
    P_ = (rest * P_ * rest.transpose() + K * R * K.transpose()).eval();
    P_ = (0.5 * (P_ + P_.transpose())).eval();
}

double QuaternionFilter::variance_about(int axis) const {
    const Eigen::Vector4d u = sigma_n(x_).col(axis);
    return 4.0 * u.dot(P_ * u);
}

void QuaternionFilter::accelerometer(const Eigen::Vector3d& force_b) {
    const double norm = force_b.norm();
    if (!(norm > 0.0)) return;
    const double r = settings_.accel_std / settings_.gravity;
    if (!levelled_) {
        // level, b's x axis to the north; the covariance is that of rotations, because the norm is known
        Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(force_b, -Eigen::Vector3d::UnitZ());
        const Eigen::Vector3d x_n = q * Eigen::Vector3d::UnitX();
        q = Eigen::AngleAxisd(-std::atan2(x_n.y(), x_n.x()), Eigen::Vector3d::UnitZ()) * q;
        start(q, r * r, std::numbers::pi * std::numbers::pi / 3.0);
        levelled_ = true;
        return;
    }
    const double before = variance_about(0);
    update(force_b / norm, -Eigen::Vector3d::UnitZ(), r * r, false);
    leak_.tilt_step(std::min(1.0, variance_about(0) / before));
}

void QuaternionFilter::start(const Eigen::Quaterniond& q_nb, double tilt_variance, double heading_variance) {
    x_ = q_nb.normalized().coeffs();
    const Sigma s = sigma_n(x_);
    P_ = 0.25 * s * Eigen::Vector3d(tilt_variance, tilt_variance, heading_variance).asDiagonal() * s.transpose();
    leak_ = TiltLeak{};
}

void QuaternionFilter::magnetometer(const Eigen::Vector3d& field_b) {
    if (levelled_ && !headed_) {
        const Eigen::Vector3d field_n = q_nb() * field_b;
        const double level = field_n.head<2>().norm();
        if (!(level > 1e-9 * field_n.norm())) return;
        const double r = settings_.field_std / settings_.horizontal_field, tilt = variance_about(0);
        const double tan_dip = field_n.z() / level;
        start(Eigen::Quaterniond(Eigen::AngleAxisd(-std::atan2(field_n.y(), field_n.x()), Eigen::Vector3d::UnitZ())) * q_nb(),
              tilt, r * r);
        leak_.heading_step(1.0, tan_dip, tilt);
        headed_ = true;
        return;
    }
    if (settings_.separation == Separation::None) {
        const Eigen::Vector3d reference(settings_.horizontal_field, 0.0, settings_.vertical_field);
        const double norm = field_b.norm();
        if (!(norm > 0.0)) return;
        const double r = settings_.field_std / reference.norm();
        update(field_b / norm, reference.normalized(), r * r, false);
        return;
    }
    const Eigen::Vector3d down_b = q_nb().conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d level_b = field_b - field_b.dot(down_b) * down_b;
    const double norm = level_b.norm();
    if (!(norm > 1e-9 * field_b.norm())) return;
    const double r = settings_.field_std / settings_.horizontal_field, tan_dip = field_b.dot(down_b) / norm;
    const double before = variance_about(2);
    update(level_b / norm, Eigen::Vector3d::UnitX(), r * r, settings_.separation == Separation::Projected);
    leak_.heading_step(1.0 - std::min(1.0, variance_about(2) / before), tan_dip, variance_about(0));
}

Eigen::Matrix3d QuaternionFilter::covariance_phi() const {
    const Sigma s = sigma_n(x_);
    Eigen::Matrix3d P = 4.0 * s.transpose() * P_ * s;
    if (settings_.separation != Separation::None) {
        P(2, 2) += leak_.variance;
        P(0, 2) += leak_.covariance;
        P(2, 0) += leak_.covariance;
    }
    return P;
}

}  // namespace schuler::ahrs
