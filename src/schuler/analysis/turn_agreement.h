// Does a sensor turn the way the gyro says? Finds wrong units and axes of a log from the data alone.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <span>

namespace schuler::analysis {

/// Regression of what a vector that is fixed in space (the Earth's field, gravity) did in body axes on what the gyro's rates should
/// have made of it, v' = -[omega x v], over stretches of 0.1 s.
struct TurnAgreement {
    double factor = std::numeric_limits<double>::quiet_NaN();       ///< least squares; 1 expected, 1/57.3 for rates in deg/s
    double correlation = std::numeric_limits<double>::quiet_NaN();  ///< of the two, -1 to 1; 1 expected
    double turned = 0.0;  ///< rad, root of the sum of squares of the directions' measured changes: how much there is to judge
};

/// `time`, `vector`: of sample k of `count`, in order of time, body axes; `imu` likewise (rad/s). Samples that are not finite are
/// left out.
[[nodiscard]] TurnAgreement turn_agreement(std::span<const ImuSample> imu, std::size_t count,
                                           const std::function<Time(std::size_t)>& time,
                                           const std::function<Eigen::Vector3d(std::size_t)>& vector);

}  // namespace schuler::analysis
