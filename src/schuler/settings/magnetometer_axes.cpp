#include "schuler/settings/magnetometer_axes.h"

namespace schuler::settings {

std::optional<Eigen::Matrix3d> C_imu_mag(const Config& config) {
    if (config.mag_axes.empty()) return std::nullopt;
    return config.filter.imu.C_bs.transpose() * axes_from_text(config.mag_axes);
}

}  // namespace schuler::settings
