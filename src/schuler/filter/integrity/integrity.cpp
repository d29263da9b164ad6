#include "schuler/filter/integrity/integrity.h"

#include "schuler/math/chi_square.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

bool within_tolerance(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings) {
    if (!(settings.accel_limit > 0.0) || !health.used) return true;
    const double t = (e.time - *health.used).seconds();
    const double reach = settings.accel_limit * (e.kind == MeasurementKind::GnssVelocity ? t : 0.5 * t * t);
    return e.innovation.norm() <= reach + 5.0 * std::sqrt(e.trace);
}

bool is_normal_innovation(const Examined& e, const IntegritySettings& settings) {
    return !(settings.trace_ratio > 0.0) || e.innovation.squaredNorm() < settings.trace_ratio * e.trace;
}

std::optional<IntegrityTest> failed_test(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings) {
    if (!within_tolerance(e, health, settings)) return IntegrityTest::Tolerance;
    if (!is_normal_innovation(e, settings)) return IntegrityTest::Innovation;
    return std::nullopt;
}

namespace {

/// Whether the mean of the fixes since they agree speaks for a fault: it contradicts the estimate, or favours the fault that was
/// found over none by more than two sigma.
bool mean_contradicts(const ChannelHealth& health, const Examined& fix) {
    constexpr double contradiction = 21.1, favour = 4.0;  // of chi-square: 1e-4 of three degrees of freedom
    constexpr double dependent = 3.0;                     // errors of successive fixes are alike
    const double n = 1.0 + (health.count - 1) / dependent;
    double without = 0.0, with = 0.0;
    for (int i = 0; i < 3; ++i) {
        const double variance = fix.of_state(i) + fix.of_noise(i) / n;
        if (!(variance > 0.0)) continue;
        const double mean = health.sum(i) / health.count;
        without += mean * mean / variance;
        with += (mean - health.fault(i)) * (mean - health.fault(i)) / variance;
    }
    return without > contradiction || without - with > favour;
}

}  // namespace

bool readmits(ChannelHealth& health, const ChannelHealth* velocity, const Examined& fix, bool agrees,
              const IntegritySettings& settings) {
    const Time time = fix.time;
    health.seen = time;
    if (!agrees) {
        health.agrees.reset();
        return false;
    }
    if (!health.agrees) {
        health.agrees = time;
        health.sum.setZero();
        health.count = 0;
    }
    health.sum += fix.innovation;
    ++health.count;
    if ((time - *health.agrees).seconds() < settings.readmission_time) return false;
    // positions have slow errors, which no mean removes
    if (fix.kind == MeasurementKind::GnssVelocity && mean_contradicts(health, fix)) {
        health.agrees.reset();
        return false;
    }
    constexpr double patience = 3.0;  // readmission times
    if (velocity != nullptr && health.together && velocity->excluded && velocity->seen &&
        (time - *velocity->seen).seconds() < patience * settings.readmission_time)
        return false;
    ChannelHealth renewed;
    renewed.fault = health.fault;
    renewed.faulty = health.faulty;
    renewed.used = time;
    health = renewed;
    return true;
}

bool ends_a_fault(const ChannelHealth& health, const ChannelHealth& velocity, const Examined& fix) {
    constexpr double memory = 600.0, opposite = -0.8, larger = 1.5;  // s; cosine; of the fault
    if (health.returned || !velocity.faulty) return false;
    const double age = (fix.time - *velocity.faulty).seconds();
    const double fault = velocity.fault.norm() * (fix.kind == MeasurementKind::GnssVelocity ? 1.0 : std::max(1.0, age));
    const double size = fix.innovation.norm();
    return age < memory && size < larger * fault && fix.innovation.dot(velocity.fault) < opposite * size * velocity.fault.norm();
}

std::array<double, 4> slow_limits(const IntegritySettings& settings) {
    std::array<double, 4> limits{};
    for (int dof = 1; dof <= 3; ++dof)
        limits[static_cast<std::size_t>(dof)] = math::chi_square_quantile(1.0 - settings.false_alarm, dof);
    return limits;
}

}  // namespace schuler::filter
