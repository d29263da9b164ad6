#include "schuler/filter/stream/event_maker.h"

#include <algorithm>

namespace schuler::filter {

namespace {

constexpr Duration baro_spacing{500'000'000}, mag_spacing{500'000'000};
constexpr Duration odometer_spacing{100'000'000};  // odometers are sampled faster than their errors change

}  // namespace

Event event_at(Time time, MeasurementKind kind, std::uint8_t components, std::size_t index) {
    Event e;
    e.stamp = e.valid = time;
    e.kind = kind;
    e.components = components;
    e.index = index;
    return e;
}

EventMaker::Ages EventMaker::ages(const GnssFix& fix) const {
    const GnssSettings& g = settings_.gnss;
    const double velocity = g.velocity_latency.value_or(g.latency);
    const auto age = [](double row_age, double latency) { return Duration::from_seconds(row_age + latency); };
    return {age(fix.position_age, g.latency), age(fix.position_age, g.height_latency.value_or(g.latency)),
            age(fix.velocity_age, velocity), age(fix.velocity_age, g.velocity_down_latency.value_or(velocity))};
}

Duration EventMaker::oldest_age(const GnssFix& fix) const {
    const Ages a = ages(fix);
    const Duration position = std::max(a.position, a.height);
    return settings_.gnss.use_velocity ? std::max({position, a.velocity, a.down}) : position;
}

/// Marks an epoch of the reference channel with its outages: withheld inside, and the first one after each.
void EventMaker::mark_outages(Event& e) const {
    const double t = (e.stamp - origin_).seconds();
    for (std::size_t k = 0; k < ended_.size(); ++k) {
        const Outage& outage = settings_.outages[k];
        if (outage.withholds(t)) {
            e.withheld = true;
            e.outage = static_cast<int>(k);
            return;
        }
        if (outage.is_over(t) && e.kind == MeasurementKind::GnssPosition && !ended_[k]) {
            e.outage = static_cast<int>(k);
            e.outage_end = true;
            return;
        }
    }
}

bool EventMaker::is_due(const BaroSample& s) {
    if (!settings_.baro.use || !std::isfinite(s.height) || s.height == memory.height || s.time - memory.baro < baro_spacing)
        return false;
    memory.baro = s.time;
    memory.height = s.height;
    return true;
}

bool EventMaker::is_due(const HeadingSample& s) const {
    if (!settings_.heading.use || !std::isfinite(s.heading)) return false;
    if (!settings_.heading.by_course) return true;
    // Neither of its fixes lies in an outage, however long the chord and late the fixes are.
    constexpr double reach = 0.5 * longest_chord + 1.0;  // s
    const double t = (s.time - origin_).seconds();
    return std::ranges::none_of(settings_.outages,
                                [&](const Outage& o) { return o.start < t + reach && o.start + o.duration > t - reach; });
}

bool EventMaker::is_due(const MagSample& s) {
    if (!settings_.mag.use || !s.field_b.allFinite() || s.time - memory.mag < mag_spacing) return false;
    memory.mag = s.time;
    return true;
}

bool EventMaker::is_due(const OdometerSample& s) {
    if (!settings_.odometer.use || !std::isfinite(s.speed) || s.time - memory.odometer < odometer_spacing) return false;
    memory.odometer = s.time;
    return true;
}

}  // namespace schuler::filter
