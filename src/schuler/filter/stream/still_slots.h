// Standing still, told from an inertial unit's own agitation over a fifth of a second and its neighbours: the rule that a log and a
// stream have in common.
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
    static constexpr std::size_t reach = 2;  ///< slots on each side that take part in the statistics (a second in all)

    Time end;
    double dt = 0.0;
    int n = 0;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();    ///< sums
    Eigen::Vector3d rate2 = Eigen::Vector3d::Zero(), force2 = Eigen::Vector3d::Zero();  ///< sums of squares
    double rate_std = 0.0, force_std = 0.0, rate_norm = 0.0;                            ///< over the slot and its neighbours
    double speed = not_given;                                                           ///< m/s, from GNSS; the largest

    void add(const ImuIncrement& increment);
    void add_speed(double speed_);
    /// Means over the slot. Not empty.
    [[nodiscard]] StillWindow window() const { return {end, dt, rate / n, force / n}; }
};

/// Statistics of slot i from its neighbours in `slots`; infinite where samples are missing.
void add_statistics(std::span<StillSlot> slots, std::size_t i, double nominal_dt);

/// Largest mean rate that a vehicle may have which stands still, rad/s.
[[nodiscard]] double largest_still_rate(VehicleKind vehicle);

/// Whether the body stood still in slot i: it and its neighbours, so far as they are there, are calm. Their statistics are those of
/// add_statistics.
[[nodiscard]] bool is_still(std::span<const StillSlot> slots, std::size_t i, const StillThresholds& thresholds,
                            double largest_rate);

/// Thresholds by the white noise that a unit is said to have, where none were learnt.
[[nodiscard]] StillThresholds thresholds_of_noise(const sensor::ImuErrorModel& imu, double nominal_dt);

}  // namespace schuler::filter
