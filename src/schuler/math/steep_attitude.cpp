#include "schuler/math/steep_attitude.h"

#include "schuler/math/rotation.h"

#include <cmath>

namespace schuler::math {

bool is_steep(const Eigen::Vector3d& rpy) {
    constexpr double cos_80_deg = 0.17364817766693041;
    return std::abs(std::cos(rpy.y())) < cos_80_deg;
}

Eigen::Matrix3d attitude_error_from_phi(const Eigen::Vector3d& rpy) {
    if (!is_steep(rpy)) return rpy_error_from_phi(rpy);
    const double ch = std::cos(rpy.z()), sh = std::sin(rpy.z()), cp = std::cos(rpy.y()), sp = std::sin(rpy.y());
    Eigen::Matrix3d axes;
    // clang-format off
    axes << cp * ch, cp * sh, -sp,
            -sh, ch, 0.0,
            0.0, 0.0, 1.0;
    // clang-format on
    return -axes;
}

}  // namespace schuler::math
