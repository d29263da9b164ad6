#include "schuler/filter/stream/imu_intervals.h"

#include "schuler/math/rotation.h"

#include <utility>

namespace schuler::filter {

using Eigen::Vector3d;

IntervalMaker::IntervalMaker(const ImuSettings& settings, double nominal)
    : C_(math::dcm_from_rpy(settings.mounting_rpy) * settings.C_bs),
      kind_(settings.kind),
      stamp_(settings.stamp),
      nominal_(nominal),
      nominal_duration_(Duration::from_seconds(nominal)) {}

std::optional<ImuIncrement> IntervalMaker::add(const ImuSample& s, std::optional<Time> next) {
    if (s.time <= memory.sample) return std::nullopt;
    const Duration nominal = nominal_duration_, half{nominal.ns / 2};
    Time end = s.time;
    if (stamp_ == ImuStamp::Center) {
        // Up to the middle of the interval to the next sample, if that is near.
        Duration d = half;
        if (next && *next > s.time) d = std::min(Duration{(*next - s.time).ns / 2}, Duration{3 * half.ns / 2});
        end = s.time + d;
    } else if (stamp_ == ImuStamp::Start) {
        Duration d = nominal;
        if (next && *next > s.time) d = std::min(*next - s.time, Duration{3 * half.ns});
        end = s.time + d;
    }
    const double dt = memory.begun ? (end - memory.end).seconds() : nominal_;
    memory.sample = s.time;
    if (dt <= 0.0) return std::nullopt;
    double factor = dt;
    if (kind_ == ImuKind::Increments) {
        // An increment belongs to its own nominal interval: a longer interval before it is a gap, not slower motion.
        factor = dt <= hole_factor * nominal_ ? 1.0 : dt / nominal_;
    }
    memory.begun = true;
    memory.end = end;
    return ImuIncrement{end, dt, C_ * s.gyro * factor, C_ * s.accel * factor};
}

bool is_hole(double dt, double nominal, const ImuSettings& settings) {
    return dt > hole_factor * nominal && (settings.kind == ImuKind::Increments || dt > settings.gap_factor * nominal);
}

BridgeNoise bridge_noise(double hole, Agitation around, Agitation elsewhere) {
    if (elsewhere.rate2 > 2.0 * around.rate2) around.rate2 = elsewhere.rate2;
    if (elsewhere.force2 > 2.0 * around.force2) around.force2 = elsewhere.force2;
    return {0.5 * hole * around.rate2, 0.5 * hole * around.force2};
}

RecentMotion::RecentMotion(double nominal) {
    memory.last.resize(static_cast<std::size_t>(std::clamp(1.0 / nominal, 4.0, 2000.0)), {Vector3d::Zero(), Vector3d::Zero()});
}

void RecentMotion::clear() {
    std::vector<Motion> room = std::move(memory.last);
    memory = {};
    memory.last = std::move(room);
}

void RecentMotion::add(const ImuIncrement& interval) {
    Memory& m = memory;
    const double per_second = 1.0 / interval.dt;
    Motion& motion = m.last[m.next];
    motion = {per_second * interval.dtheta, per_second * interval.dv};
    m.rate += motion.rate;
    m.force += motion.force;
    m.rate2 += motion.rate.squaredNorm();
    m.force2 += motion.force.squaredNorm();
    m.filled = std::min(m.filled + 1, m.last.size());
    if (++m.next < m.last.size()) return;
    const auto n = static_cast<double>(m.last.size());
    m.sum.rate2 += std::max(0.0, m.rate2 / n - (m.rate / n).squaredNorm()) / 3.0;
    m.sum.force2 += std::max(0.0, m.force2 / n - (m.force / n).squaredNorm()) / 3.0;
    m.seconds += 1.0;
    m.next = 0;
    m.rate.setZero();
    m.force.setZero();
    m.rate2 = m.force2 = 0.0;
}

Agitation RecentMotion::recent() const {
    if (memory.filled == 0) return {};
    const auto n = static_cast<double>(memory.filled);
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();
    for (std::size_t k = 0; k < memory.filled; ++k) {
        rate += memory.last[k].rate / n;
        force += memory.last[k].force / n;
    }
    Agitation a;
    for (std::size_t k = 0; k < memory.filled; ++k) {
        a.rate2 += (memory.last[k].rate - rate).squaredNorm() / (3.0 * n);
        a.force2 += (memory.last[k].force - force).squaredNorm() / (3.0 * n);
    }
    return a;
}

Agitation RecentMotion::usual() const {
    if (!(memory.seconds > 0.0)) return {};
    return {memory.sum.rate2 / memory.seconds, memory.sum.force2 / memory.seconds};
}

bool HangWatch::hangs(const ImuSample& s) {
    Memory& m = memory;
    const bool gyro = m.begun && s.gyro == m.gyro, accel = m.begun && s.accel == m.accel;
    for (const int over : {gyro ? 0 : m.gyro_run, accel ? 0 : m.accel_run})
        if (over >= 2 && over < least_) m.repeats += over;
    m.gyro_run = gyro ? m.gyro_run + 1 : 0;
    m.accel_run = accel ? m.accel_run + 1 : 0;
    m.begun = true;
    m.gyro = s.gyro;
    m.accel = s.accel;
    ++m.samples;
    if (!gyro && !accel) ++m.fresh;
    // if short runs are common or nothing has varied yet, a long one is not significant: coarse, repeated by the logger, noise-free
    return std::max(m.gyro_run, m.accel_run) >= least_ && m.fresh >= 10 * least_ && 20 * m.repeats <= m.samples;
}

}  // namespace schuler::filter
