// Paper B's first filter: two three-state Kalman filters for rows of the direction-cosine matrix. The accelerometer corrects the
// vertical row; the magnetometer, less the known vertical field, the north row, which is then orthogonalised to the vertical one,
// so that magnetic data do not affect roll and pitch. No bias state. [LakozaMeleshko2014], with the corrections E3 of math.md.
#pragma once

#include "schuler/ahrs/tilt_leak.h"
#include "schuler/ahrs/vector_filter_settings.h"

#include <Eigen/Core>

namespace schuler::ahrs {

class DcmFilter {
public:
    /// @throws Error(Input) for invalid settings.
    explicit DcmFilter(const VectorFilterSettings& settings);

    /// Rotation over dt (s) at rate_b (rad/s, body axes).
    void propagate(double dt, const Eigen::Vector3d& rate_b);
    /// Specific force (m/s^2, b): corrects the vertical row.
    void accelerometer(const Eigen::Vector3d& force_b);
    /// Field (T, b): corrects the north row. Uses the horizontal and vertical field of the settings.
    void magnetometer(const Eigen::Vector3d& field_b);
    /// C_nb for north-east-down and forward-right-down.
    [[nodiscard]] Eigen::Matrix3d C_nb() const;
    /// Covariance of the small rotation in n, rad^2, including the effect of the tilt on the heading.
    [[nodiscard]] Eigen::Matrix3d covariance_phi() const;

private:
    VectorFilterSettings settings_;
    Eigen::Vector3d up_ = -Eigen::Vector3d::UnitZ(), north_ = Eigen::Vector3d::UnitX();  ///< rows of C_nb, components in b
    Eigen::Matrix3d P_up_ = Eigen::Matrix3d::Identity(), P_north_ = Eigen::Matrix3d::Identity();
    TiltLeak leak_;
};

}  // namespace schuler::ahrs
