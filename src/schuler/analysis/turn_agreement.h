// Agreement of a sensor's rotation with that of the gyro. Detects wrong units and axes of a log from the data alone.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <span>

namespace schuler::analysis {

/// Regression of the observed changes, in body axes, of a vector fixed in space (the Earth's field, gravity) on those predicted
/// from the gyro rates, v' = -[omega x v], over intervals of 0.1 s.
struct TurnAgreement {
    double factor = std::numeric_limits<double>::quiet_NaN();       ///< least squares; 1 expected, 1/57.3 for rates in deg/s
    double correlation = std::numeric_limits<double>::quiet_NaN();  ///< of the two, -1 to 1; 1 expected
    double turned = 0.0;  ///< rad, root sum of squares of the measured changes of direction: the amount of evidence
};

/// `time`, `vector`: of sample k of `count`, in time order, body axes; `imu` likewise (rad/s). Samples that are not finite are
/// ignored.
[[nodiscard]] TurnAgreement turn_agreement(std::span<const ImuSample> imu, std::size_t count,
                                           const std::function<Time(std::size_t)>& time,
                                           const std::function<Eigen::Vector3d(std::size_t)>& vector);

}  // namespace schuler::analysis
