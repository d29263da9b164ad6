// When the vehicle stood still, and what the sensors said then.
#pragma once

#include "schuler/inspect/detail/motion.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace schuler::inspect::detail {

struct StillPeriods {
    struct Interval {
        double start, stop;  // s
    };
    std::vector<Interval> intervals;              ///< of 2 s and more
    double total = 0.0;                           ///< s
    Eigen::Vector3d w = Eigen::Vector3d::Zero();  ///< median rate: the gyro bias (Earth rate included), rad/s
    Eigen::Vector3d f = Eigen::Vector3d::Zero();  ///< median specific force of the longest interval, m/s^2
    double f_norm = 0.0;                          ///< median norm of the specific force over all intervals, m/s^2
    [[nodiscard]] bool any() const { return !intervals.empty(); }
};

/// Windows of 1 s with little motion in the IMU and, where there is GNSS, no speed. `imu` in SI units.
[[nodiscard]] StillPeriods still_periods(const ImuSeries& imu, const GnssSeries& gnss);

/// White noise of the sensors from second differences (motion slower than a few samples drops out), the tenth quietest percent
/// of windows of 1 s. Vibration counts as noise: an upper bound.
struct NoiseLevel {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/sqrt(s)
    Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s/sqrt(s)
};
[[nodiscard]] NoiseLevel noise_level(const ImuSeries& imu);

/// "0 to 34 s, 201 to 206 s" after `origin`.
[[nodiscard]] std::string text_of(const std::vector<StillPeriods::Interval>& intervals, double origin);

}  // namespace schuler::inspect::detail
