#include "schuler/math/rotation.h"

#include <algorithm>
#include <numbers>

namespace schuler::math {

Eigen::Matrix3d dcm_from_rotation_vector(const Eigen::Vector3d& r) {
    const double n2 = r.squaredNorm();
    double a, b;  // sin(n)/n and (1 - cos(n))/n^2
    if (n2 < 1e-2) {
        a = 1.0 - n2 / 6 * (1.0 - n2 / 20 * (1.0 - n2 / 42 * (1.0 - n2 / 72 * (1.0 - n2 / 110))));
        b = 0.5 - n2 / 24 * (1.0 - n2 / 30 * (1.0 - n2 / 56 * (1.0 - n2 / 90 * (1.0 - n2 / 132))));
    } else {
        const double n = std::sqrt(n2);
        a = std::sin(n) / n;
        const double s = std::sin(0.5 * n) / n;
        b = 2.0 * s * s;
    }
    const Eigen::Matrix3d K = skew(r);
    return Eigen::Matrix3d::Identity() + a * K + b * K * K;
}

Eigen::Vector3d rotation_vector_from_quaternion(const Eigen::Quaterniond& q) {
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d v = sign * q.vec();
    const double s = v.norm();
    if (s < 1e-10) return 2.0 * v;
    return 2.0 * std::atan2(s, sign * q.w()) / s * v;
}

Eigen::Matrix3d dcm_from_rpy(const Eigen::Vector3d& rpy) {
    const double cr = std::cos(rpy.x()), sr = std::sin(rpy.x());
    const double cp = std::cos(rpy.y()), sp = std::sin(rpy.y());
    const double ch = std::cos(rpy.z()), sh = std::sin(rpy.z());
    Eigen::Matrix3d C;
    // clang-format off
    C << cp * ch, sr * sp * ch - cr * sh, cr * sp * ch + sr * sh,
         cp * sh, sr * sp * sh + cr * ch, cr * sp * sh - sr * ch,
         -sp, sr * cp, cr * cp;
    // clang-format on
    return C;
}

Eigen::Quaterniond quaternion_from_rpy(const Eigen::Vector3d& rpy) {
    const Eigen::Vector3d half = 0.5 * rpy;
    const double cr = std::cos(half.x()), sr = std::sin(half.x());
    const double cp = std::cos(half.y()), sp = std::sin(half.y());
    const double ch = std::cos(half.z()), sh = std::sin(half.z());
    return {cr * cp * ch + sr * sp * sh, sr * cp * ch - cr * sp * sh, cr * sp * ch + sr * cp * sh, cr * cp * sh - sr * sp * ch};
}

Eigen::Vector3d rpy_from_dcm(const Eigen::Matrix3d& C_nb) {
    const double cos_pitch = std::hypot(C_nb(0, 0), C_nb(1, 0));
    const double pitch = std::atan2(-C_nb(2, 0), cos_pitch);
    if (cos_pitch < 1e-7) return {0.0, pitch, wrap_2pi(std::atan2(-C_nb(0, 1), C_nb(1, 1)))};
    return {std::atan2(C_nb(2, 1), C_nb(2, 2)), pitch, wrap_2pi(std::atan2(C_nb(1, 0), C_nb(0, 0)))};
}

Eigen::Vector3d rpy_from_quaternion(const Eigen::Quaterniond& q_nb) { return rpy_from_dcm(q_nb.toRotationMatrix()); }

Eigen::Matrix3d rpy_error_from_phi(const Eigen::Vector3d& rpy) {
    // The estimate is rotated by -phi: with the rate w = -phi in local-level axes the Euler kinematics give the change.
    const double sp = std::sin(rpy.y());
    double cp = std::cos(rpy.y());
    cp = std::copysign(std::max(std::abs(cp), 1e-8), cp);
    const double ch = std::cos(rpy.z()), sh = std::sin(rpy.z());
    Eigen::Matrix3d J;
    // clang-format off
    J << -ch / cp, -sh / cp, 0.0,
         sh, -ch, 0.0,
         -ch * sp / cp, -sh * sp / cp, -1.0;
    // clang-format on
    return J;
}

double wrap_pi(double angle) {
    const double r = std::remainder(angle, 2.0 * std::numbers::pi);
    return r <= -std::numbers::pi ? std::numbers::pi : r;
}

double wrap_2pi(double angle) {
    const double r = std::fmod(angle, 2.0 * std::numbers::pi);
    const double w = r < 0.0 ? r + 2.0 * std::numbers::pi : r;
    return w >= 2.0 * std::numbers::pi ? 0.0 : w;
}

}  // namespace schuler::math
