// Paper B's second filter: the quaternion Kalman filter with pseudo-linear vector measurements of [Choukroun2006]; the
// magnetometer is projected onto the horizon, so that the field need not be known. Corrected as in E3 of math.md.
#pragma once

#include "schuler/ahrs/tilt_leak.h"
#include "schuler/ahrs/vector_filter_settings.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ahrs {

class QuaternionFilter {
public:
    /// @throws Error(Input) for invalid settings.
    explicit QuaternionFilter(const VectorFilterSettings& settings);

    /// Rotation over dt (s) at rate_b (rad/s, body axes).
    void propagate(double dt, const Eigen::Vector3d& rate_b);
    /// Specific force (m/s^2, b).
    void accelerometer(const Eigen::Vector3d& force_b);
    /// Field (T, b).
    void magnetometer(const Eigen::Vector3d& field_b);
    [[nodiscard]] Eigen::Quaterniond q_nb() const { return {x_(3), x_(0), x_(1), x_(2)}; }
    /// Covariance of the small rotation in n, rad^2.
    [[nodiscard]] Eigen::Matrix3d covariance_phi() const;

private:
    void start(const Eigen::Quaterniond& q_nb, double tilt_variance, double heading_variance);
    void update(const Eigen::Vector3d& measured_b, const Eigen::Vector3d& reference_n, double variance, bool heading_only);
    [[nodiscard]] double variance_about(int axis) const;  ///< rad^2, of the small rotation about an axis of n, by P alone

    VectorFilterSettings settings_;
    Eigen::Vector4d x_ = Eigen::Vector4d::UnitW();  ///< q_nb, vector part first as in the paper
    Eigen::Matrix4d P_ = Eigen::Matrix4d::Identity();
    TiltLeak leak_;
    bool levelled_ = false, headed_ = false;  ///< attitude, heading initialised from the first readings
};

}  // namespace schuler::ahrs
