#include "schuler/inspect/detail/motion/preintegration.h"

#include "schuler/math/rotation.h"

#include <algorithm>

namespace schuler::inspect::detail {

Preintegral Preintegral::zero() { return {Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()}; }

void Preintegral::add(const Preintegral& other, double weight) {
    u += weight * other.u;
    u_by_gyro_bias += weight * other.u_by_gyro_bias;
    u_by_accel_bias += weight * other.u_by_accel_bias;
}

PreintegratedPath::PreintegratedPath(const ImuSeries& imu, std::size_t first, std::size_t last, const Eigen::Vector3d& gyro_bias,
                                     const Eigen::Vector3d& accel_bias) {
    const std::size_t n = last - first + 1;
    t_.reserve(n);
    at_sample_.reserve(n);
    rotation_.reserve(n);
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d angle_by_bias = Eigen::Matrix3d::Zero();  // attitude error in start axes: -(integral of R dt) * bias
    Preintegral s = Preintegral::zero();
    Eigen::Vector3d f_before = R * (imu.f[first] - accel_bias);
    t_.push_back(imu.t[first]);
    at_sample_.push_back(s);
    rotation_.push_back(R);
    for (std::size_t i = first + 1; i <= last; ++i) {
        const double dt = imu.t[i] - imu.t[i - 1];
        const Eigen::Vector3d rate = 0.5 * (imu.w[i - 1] + imu.w[i]) - gyro_bias;
        const Eigen::Matrix3d R_next = R * math::quaternion_from_rotation_vector(rate * dt).toRotationMatrix();
        const Eigen::Matrix3d R_mid = 0.5 * (R + R_next);
        const Eigen::Matrix3d angle_next = angle_by_bias + dt * R_mid;
        const Eigen::Vector3d f_now = R_next * (imu.f[i] - accel_bias);
        const Eigen::Vector3d f_mid = 0.5 * (f_before + f_now);
        s.u += dt * f_mid;
        // d(u)/d(gyro bias): a rotation error -(A b) rotates R f by -(A b) x R f = [R f x] A b.
        s.u_by_gyro_bias += dt * math::skew(f_mid) * (0.5 * (angle_by_bias + angle_next));
        s.u_by_accel_bias -= dt * R_mid;
        R = math::orthonormalised(R_next);
        angle_by_bias = angle_next;
        f_before = f_now;
        t_.push_back(imu.t[i]);
        at_sample_.push_back(s);
        rotation_.push_back(R);
    }
}

Preintegral PreintegratedPath::at(double t) const {
    const std::size_t i = index_before(t_, t);
    if (i + 1 >= t_.size() || t <= t_.front()) return at_sample_[i];
    const double share = (t - t_[i]) / (t_[i + 1] - t_[i]);
    Preintegral s = Preintegral::zero();
    s.add(at_sample_[i], 1.0 - share);
    s.add(at_sample_[i + 1], share);
    return s;
}

const Eigen::Matrix3d& PreintegratedPath::rotation_at(double t) const { return rotation_[index_before(t_, t)]; }

}  // namespace schuler::inspect::detail
