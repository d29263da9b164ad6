#include "schuler/filter/stream/still_slots.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::filter {

using Eigen::Vector3d;

void StillSlot::add(const ImuIncrement& inc) {
    const Vector3d r = inc.dtheta / inc.dt, f = inc.dv / inc.dt;
    dt += inc.dt;
    ++n;
    rate += r;
    force += f;
    rate2 += r.cwiseAbs2();
    force2 += f.cwiseAbs2();
}

void StillSlot::add_speed(double speed_) { speed = std::isfinite(speed) ? std::max(speed, speed_) : speed_; }

void add_statistics(std::span<StillSlot> slots, std::size_t i, double nominal_dt) {
    const int expected = static_cast<int>(0.6 * StillSlot::length / nominal_dt);
    constexpr std::size_t reach = StillSlot::reach;
    const std::size_t first = i >= reach ? i - reach : 0, last = std::min(slots.size() - 1, i + reach);
    Vector3d r = Vector3d::Zero(), f = r, r2 = r, f2 = r;
    double n = 0.0;
    bool complete = true;
    for (std::size_t k = first; k <= last; ++k) {
        complete = complete && slots[k].n >= std::max(1, expected);
        n += slots[k].n;
        r += slots[k].rate;
        f += slots[k].force;
        r2 += slots[k].rate2;
        f2 += slots[k].force2;
    }
    StillSlot& s = slots[i];
    if (!complete || n < 3.0) {
        s.rate_std = s.force_std = s.rate_norm = std::numeric_limits<double>::infinity();
        return;
    }
    s.rate_std = std::sqrt(std::max(0.0, (r2 / n - (r / n).cwiseAbs2()).sum()));
    s.force_std = std::sqrt(std::max(0.0, (f2 / n - (f / n).cwiseAbs2()).sum()));
    s.rate_norm = (r / n).norm();
}

double largest_still_rate(VehicleKind vehicle) {
    return vehicle == VehicleKind::Car || vehicle == VehicleKind::Static ? 0.2 : 0.5;
}

bool is_still(std::span<const StillSlot> slots, std::size_t i, const StillThresholds& thresholds, double largest_rate) {
    const auto calm = [&](const StillSlot& s) {
        return s.force_std < thresholds.force_std && s.rate_std < thresholds.rate_std && s.rate_norm < largest_rate &&
               !(s.speed > 0.3);
    };
    return slots[i].n > 0 && calm(slots[i]) && (i == 0 || calm(slots[i - 1])) && (i + 1 == slots.size() || calm(slots[i + 1]));
}

StillThresholds thresholds_of_noise(const sensor::ImuErrorModel& imu, double nominal_dt) {
    // a quarter above the white noise of three axes, as learnt thresholds are above the observed values
    const double per_density = 1.25 * std::sqrt(3.0 / nominal_dt);
    return {false, per_density * imu.accel_noise, per_density * imu.gyro_noise};
}

}  // namespace schuler::filter
