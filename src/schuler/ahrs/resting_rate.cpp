#include "schuler/ahrs/resting_rate.h"

#include "schuler/core/units.h"

#include <algorithm>
#include <cmath>

namespace schuler::ahrs {
namespace {

using Eigen::Vector3d;

constexpr double block = 0.25, long_enough = 3.0;    // s
constexpr double largest = 25.0 * units::deg_per_s;  // rad/s, of the biases of gyros that are for sale
constexpr double longest_step = 0.5;                 // s

/// Mean field over half a second from an instant on; zero if there is none.
Vector3d field_at(std::span<const MagSample> mag, Time from) {
    constexpr double span = 0.5;  // s
    Vector3d sum = Vector3d::Zero();
    const auto first = std::ranges::lower_bound(mag, from, {}, &MagSample::time);
    for (auto s = first; s != mag.end() && (s->time - from).seconds() < span; ++s)
        if (s->field_b.allFinite()) sum += s->field_b;
    return sum;
}

/// Whether the field keeps its direction over a time in which it would turn visibly at that rate; empty if that cannot be said.
std::optional<bool> field_stays(std::span<const MagSample> mag, Time from, Time to, const Vector3d& rate) {
    const double span = (to - from).seconds() - 0.5;
    const Vector3d first = field_at(mag, from), last = field_at(mag, to - Duration::from_seconds(0.5));
    if (first.isZero() || last.isZero() || !(span > 0.0)) return std::nullopt;
    const Vector3d turning = rate - rate.dot(first.normalized()) * first.normalized();
    const double expected = turning.norm() * span,
                 seen = std::acos(std::clamp(first.normalized().dot(last.normalized()), -1.0, 1.0));
    constexpr double visible = 10.0 * units::deg, still = 0.1;  // of it: a magnet on the sensor hides a part of the rotation
    if (expected < visible) return std::nullopt;
    return seen < still * expected;
}

}  // namespace

std::optional<Vector3d> resting_rate(std::span<const ImuSample> imu, std::span<const MagSample> mag,
                                     const RestSettings& settings) {
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();          // of the block
    Vector3d run_rate = Vector3d::Zero(), run_force = Vector3d::Zero();  // of the calm, integrals
    double duration = 0.0, calm = 0.0;
    Time begin{};
    for (std::size_t i = 1; i < imu.size(); ++i) {
        const double dt = (imu[i].time - imu[i - 1].time).seconds();
        if (!(dt > 0.0)) continue;
        if (dt > longest_step || !imu[i].gyro.allFinite() || !imu[i].accel.allFinite()) {
            duration = calm = 0.0;
            rate = force = run_rate = run_force = Vector3d::Zero();
            continue;
        }
        rate += imu[i].gyro * dt;
        force += imu[i].accel * dt;
        duration += dt;
        if (duration < block) continue;
        const bool goes_on = calm > 0.0 && (rate / duration - run_rate / calm).norm() < settings.rate_change &&
                             (force / duration - run_force / calm).norm() < settings.force_change;
        if (!goes_on) {
            calm = 0.0;
            run_rate = run_force = Vector3d::Zero();
            begin = imu[i].time - Duration::from_seconds(duration);
        }
        run_rate += rate;
        run_force += force;
        calm += duration;
        rate = force = Vector3d::Zero();
        duration = 0.0;
        if (calm < long_enough) continue;
        const Vector3d mean = run_rate / calm;
        if (mean.norm() < settings.largest_rate) return std::nullopt;
        const std::optional<bool> stays = field_stays(mag, begin, imu[i].time, mean);
        if (mean.norm() <= largest && stays.value_or(false)) return mean;
        // not yet visible: a longer calm may show it; a rotation that goes on for longer would come back to where it began
        constexpr double longest = 10.0;  // s
        if (stays || calm > longest) calm = 0.0;
    }
    return std::nullopt;
}

}  // namespace schuler::ahrs
