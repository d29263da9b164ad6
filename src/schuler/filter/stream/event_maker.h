// From samples to measurements with their times of validity, one at a time in order of their stamps: shared by the timeline of a
// log and a stream.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/update/timeline.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::filter {

/// Creates the events of the receiver and of all other instruments. The settings are held by reference.
class EventMaker {
public:
    /// origin: zero of the outage times.
    EventMaker(const Settings& settings, Time origin)
        : settings_(settings), origin_(origin), ended_(settings.outages.size(), false) {}

    /// The events of a fix, none if there is no fix or it repeats the previous one: `push(Event)` receives each, `index` is that
    /// of the fix. Components with their own latency are separate events.
    template <class Push>
    void gnss(const GnssFix& fix, std::size_t index, Push&& push);
    /// The largest age of a part of a fix at its stamp.
    [[nodiscard]] Duration oldest_age(const GnssFix& fix) const;

    // Loggers repeat the last value between conversions, and the errors of fast samples are not independent: one event for each
    // new value, and at most one per interval. True if this sample is to become an event:
    [[nodiscard]] bool is_due(const BaroSample& s);
    [[nodiscard]] bool is_due(const MagSample& s);
    [[nodiscard]] bool is_due(const OdometerSample& s);
    [[nodiscard]] bool is_due(const HeadingSample& s) const;
    [[nodiscard]] bool is_due(const GaugeSample& s) const { return settings_.gauges.use && s.height.array().isFinite().any(); }
    [[nodiscard]] bool is_due(const BodyVelocitySample& s) const { return settings_.log.use && s.velocity_b.allFinite(); }

    /// State kept from the previous samples.
    struct Memory {
        bool any_fix = false;
        Time fix{INT64_MIN};
        Geodetic position{};
        int satellites = -1;
        std::size_t next_change = 0;  ///< of Settings::gnss.constellation_changes
        Time baro{INT64_MIN / 2}, mag{INT64_MIN / 2}, odometer{INT64_MIN / 2};
        double height = not_given;
        std::size_t repeated = 0;  ///< fixes
    };
    Memory memory;

private:
    struct Ages {
        Duration position, height, velocity, down;
    };
    [[nodiscard]] Ages ages(const GnssFix& fix) const;
    void mark_outages(Event& e) const;

    const Settings& settings_;
    Time origin_;
    std::vector<bool> ended_;  // outages
};

/// A measurement that is valid at its stamp.
[[nodiscard]] Event event_at(Time time, MeasurementKind kind, std::uint8_t components, std::size_t index);

template <class Push>
void EventMaker::gnss(const GnssFix& fix, std::size_t index, Push&& push) {
    if (fix.fix == FixType::None) return;
    const bool same_position = memory.any_fix && memory.position.lat == fix.position.lat &&
                               memory.position.lon == fix.position.lon && memory.position.h == fix.position.h;
    if (fix.time == memory.fix && same_position) {
        ++memory.repeated;
        return;
    }
    Event e;
    e.constellation_change =
        memory.any_fix && memory.satellites >= 0 && fix.satellites >= 0 && memory.satellites != fix.satellites;
    const std::vector<Time>& changes = settings_.gnss.constellation_changes;
    for (; memory.next_change < changes.size() && changes[memory.next_change] <= fix.time + Duration{1'000}; ++memory.next_change)
        e.constellation_change = true;
    memory.any_fix = true;
    memory.fix = fix.time;
    memory.position = fix.position;
    memory.satellites = fix.satellites;
    e.stamp = fix.time;
    e.index = index;
    const auto part = [&](MeasurementKind kind, std::uint8_t components, Duration age) {
        if (components == 0) return;
        e.kind = kind;
        e.components = components;
        e.valid = fix.time - age;
        e.withheld = e.outage_end = false;
        e.outage = -1;
        mark_outages(e);
        push(static_cast<const Event&>(e));
    };
    const bool has_horizontal = std::isfinite(fix.position.lat) && std::isfinite(fix.position.lon);
    const bool has_height = std::isfinite(fix.position.h);
    const Ages age = ages(fix);
    if (has_horizontal && has_height && age.position == age.height) {
        part(MeasurementKind::GnssPosition, 7, age.position);
    } else {
        part(MeasurementKind::GnssPosition, has_horizontal ? 3 : 0, age.position);
        part(MeasurementKind::GnssPosition, has_height ? 4 : 0, age.height);
    }
    if (settings_.gnss.use_velocity) {
        const bool has_ne = fix.velocity_n.head<2>().allFinite(), has_d = std::isfinite(fix.velocity_n.z());
        if (has_ne && has_d && age.velocity == age.down) {
            part(MeasurementKind::GnssVelocity, 7, age.velocity);
        } else {
            part(MeasurementKind::GnssVelocity, has_ne ? 3 : 0, age.velocity);
            part(MeasurementKind::GnssVelocity, has_d ? 4 : 0, age.down);
        }
    }
    const double t = (fix.time - origin_).seconds();
    for (std::size_t k = 0; k < ended_.size(); ++k)
        if (has_horizontal && t >= settings_.outages[k].start + settings_.outages[k].duration - 1e-6) ended_[k] = true;
}

}  // namespace schuler::filter
