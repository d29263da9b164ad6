// The channels compared in motion studies, as plain arrays in SI units on one axis of seconds.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <vector>

namespace schuler::inspect::detail {

/// Rates and specific force in sensor axes, time ascending without duplicates; rows with NaN omitted.
struct ImuSeries {
    std::vector<double> t;
    std::vector<Eigen::Vector3d> w;  ///< rad/s
    std::vector<Eigen::Vector3d> f;  ///< m/s^2
    double step = 0.0;               ///< median, s
    [[nodiscard]] std::size_t size() const { return t.size(); }
    [[nodiscard]] bool empty() const { return t.empty(); }
};

/// GNSS epochs by their time stamps (ages not applied), ascending without duplicates.
struct GnssSeries {
    std::vector<double> t;
    std::vector<Eigen::Vector3d> p;  ///< north, east, down from the first epoch, m (down 0 without height)
    std::vector<Eigen::Vector3d> v;  ///< north, east, down, m/s; empty if not in the log
    double step = 0.0;               ///< median, s
    double lat = 0.0, h = 0.0;       ///< of the first epoch, rad and m
    bool has_height = false;
    int reach = 1;  ///< positions on either side used to fit a speed if there are no velocities
    [[nodiscard]] std::size_t size() const { return t.size(); }
    [[nodiscard]] bool empty() const { return t.empty(); }
    [[nodiscard]] bool has_velocity() const { return !v.empty(); }
    /// Horizontal speed of an epoch, m/s: from the velocity, or the slope of as many surrounding positions as their noise requires.
    [[nodiscard]] double speed(std::size_t k) const;
};

/// Seconds since `origin`. Increments are divided by the interval from the previous row.
[[nodiscard]] ImuSeries imu_series(const std::vector<ImuSample>& samples, ImuKind kind, Time origin);
/// The same from `count` samples in order of time that are nowhere together: sample(k).
[[nodiscard]] ImuSeries imu_series(std::size_t count, const std::function<ImuSample(std::size_t)>& sample, ImuKind kind,
                                   Time origin);
[[nodiscard]] GnssSeries gnss_series(const std::vector<GnssFix>& fixes, Time origin);

/// Index of the last time not after t (0 if t is before the first).
[[nodiscard]] std::size_t index_before(const std::vector<double>& times, double t);

}  // namespace schuler::inspect::detail
