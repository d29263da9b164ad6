// Standstill periods of the vehicle, and the sensor output during them.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace schuler::inspect::detail {

struct StillPeriods {
    struct Interval {
        double start, stop;  // s
    };
    std::vector<Interval> intervals;              ///< of at least 2 s
    double total = 0.0;                           ///< s
    Eigen::Vector3d w = Eigen::Vector3d::Zero();  ///< median rate: the gyro bias (including the Earth rate), rad/s
    Eigen::Vector3d f = Eigen::Vector3d::Zero();  ///< median specific force of the longest interval, m/s^2
    double f_norm = 0.0;                          ///< median magnitude of the specific force over all intervals, m/s^2
    [[nodiscard]] bool any() const { return !intervals.empty(); }
};

/// Windows of 1 s with little motion in the IMU data and, with GNSS, zero speed; where it has no fix, between zero speeds or with
/// forces that explain the change of speed. `imu` in SI units.
[[nodiscard]] StillPeriods still_periods(const ImuSeries& imu, const GnssSeries& gnss);

/// White noise of the sensors from second differences (motion slower than a few samples cancels), at the tenth percentile of
/// windows of 1 s. Vibration counts as noise: an upper bound.
struct NoiseLevel {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/sqrt(s)
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s/sqrt(s)
};
[[nodiscard]] NoiseLevel noise_level(const ImuSeries& imu);

/// "0 to 34 s, 201 to 206 s" after `origin`.
[[nodiscard]] std::string text_of(const std::vector<StillPeriods::Interval>& intervals, double origin);

}  // namespace schuler::inspect::detail
