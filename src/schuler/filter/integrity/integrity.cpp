#include "schuler/filter/integrity/integrity.h"

#include "schuler/math/chi_square.h"

namespace schuler::filter {

bool within_tolerance(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings) {
    if (!(settings.accel_limit > 0.0) || !health.used) return true;
    const double t = (e.time - *health.used).seconds();
    const double reach = settings.accel_limit * (e.kind == AidKind::GnssVelocity ? t : 0.5 * t * t);
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

bool readmits(ChannelHealth& health, const ChannelHealth* velocity, bool agrees, Time time, const IntegritySettings& settings) {
    health.seen = time;
    if (!agrees) {
        health.agrees.reset();
        return false;
    }
    if (!health.agrees) health.agrees = time;
    const auto long_enough = [&](const ChannelHealth& h) {
        return h.agrees && (time - *h.agrees).seconds() >= settings.readmission_time;
    };
    if (!long_enough(health)) return false;
    constexpr double patience = 3.0;  // readmission times
    if (velocity != nullptr && health.together && velocity->excluded && velocity->seen &&
        (time - *velocity->seen).seconds() < patience * settings.readmission_time && !long_enough(*velocity))
        return false;
    health = {};
    health.used = time;
    return true;
}

std::array<double, 4> slow_limits(const IntegritySettings& settings) {
    std::array<double, 4> limits{};
    for (int dof = 1; dof <= 3; ++dof)
        limits[static_cast<std::size_t>(dof)] = math::chi_square_quantile(1.0 - settings.false_alarm, dof);
    return limits;
}

}  // namespace schuler::filter
