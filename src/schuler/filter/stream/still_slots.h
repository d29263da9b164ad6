// Detection of standstill from the variation of the inertial data over a fifth of a second and its neighbours: the rule shared by
// a log and a stream.
#pragma once

#include "schuler/filter/settings.h"
#include "schuler/filter/update/timeline.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace schuler::filter {

/// A fifth of a second of increments.
struct StillSlot {
    static constexpr double length = 0.2;    ///< s, resolution of the decision
    static constexpr std::size_t reach = 2;  ///< slots on each side included in the statistics (one second in all)

    Time end;
    double dt = 0.0;
    int n = 0;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();    ///< sums
    Eigen::Vector3d rate2 = Eigen::Vector3d::Zero(), force2 = Eigen::Vector3d::Zero();  ///< sums of squares
    double rate_std = 0.0, force_std = 0.0, rate_norm = 0.0;                            ///< over the slot and its neighbours
    double speed = not_given;                                                           ///< m/s, from GNSS; the largest value

    void add(const ImuIncrement& increment);
    void add_speed(double speed_);
    /// Means over the slot. Not empty.
    [[nodiscard]] StillWindow window() const { return {end, dt, rate / n, force / n}; }
};

/// Statistics of slot i and its neighbours in `slots`; infinite if samples are missing.
void add_statistics(std::span<StillSlot> slots, std::size_t i, double nominal_dt);

/// Largest mean rate of a stationary vehicle, rad/s.
[[nodiscard]] double largest_still_rate(VehicleKind vehicle);

/// True if the body was stationary in slot i: it and its available neighbours are calm. Their statistics are those of
/// add_statistics.
[[nodiscard]] bool is_still(std::span<const StillSlot> slots, std::size_t i, const StillThresholds& thresholds,
                            double largest_rate);

/// Thresholds from the stated white noise of a unit, if none were learnt.
[[nodiscard]] StillThresholds thresholds_of_noise(const sensor::ImuErrorModel& imu, double nominal_dt);

}  // namespace schuler::filter
