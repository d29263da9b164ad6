#include "schuler/fusion/timeline.h"

#include "schuler/core/error.h"
#include "schuler/fusion/imu_faults.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

double median_step(const std::vector<ImuSample>& samples) {
    std::vector<double> steps;
    steps.reserve(samples.size());
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const double dt = (samples[i].time - samples[i - 1].time).seconds();
        if (dt > 0.0) steps.push_back(dt);
    }
    if (steps.empty())
        throw input_error("the IMU log has fewer than two different times", {.file = {}, .key = "imu.file"},
                          "check that the time column is the right one");
    return math::median(std::move(steps));
}

/// A step of increments longer than this times the median is a hole; coarse time stamps stay below it (2 and 3 ms for 2.5).
constexpr double hole_factor = 1.75;

/// The interval that each sample stands for, by its kind and stamp, as if what was measured had lasted all of it.
std::vector<ImuIncrement> intervals_of(const std::vector<ImuSample>& samples, const std::vector<bool>& stuck, const ImuSettings& settings,
                                       double median_dt, std::size_t& duplicates) {
    std::vector<ImuIncrement> intervals;
    intervals.reserve(samples.size());
    const Eigen::Matrix3d C = math::dcm_from_rpy(settings.mounting_rpy) * settings.C_bs;
    const Duration nominal = Duration::from_seconds(median_dt);
    const Duration half{nominal.ns / 2};
    Time last{INT64_MIN};
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const ImuSample& s = samples[i];
        if (stuck[i]) continue;
        if (s.time <= last) {
            ++duplicates;
            continue;
        }
        Time end = s.time;
        if (settings.stamp == ImuStamp::Center) {
            // Up to half way to the next sample, as long as the next one is near.
            Duration d = half;
            if (i + 1 < samples.size() && samples[i + 1].time > s.time)
                d = std::min(Duration{(samples[i + 1].time - s.time).ns / 2}, Duration{3 * half.ns / 2});
            end = s.time + d;
        } else if (settings.stamp == ImuStamp::Start) {
            Duration d = nominal;
            if (i + 1 < samples.size() && samples[i + 1].time > s.time)
                d = std::min(samples[i + 1].time - s.time, Duration{3 * half.ns});
            end = s.time + d;
        }
        const double dt = intervals.empty() ? median_dt : (end - intervals.back().time).seconds();
        last = s.time;
        if (dt <= 0.0) {
            ++duplicates;
            continue;
        }
        double factor = dt;
        if (settings.kind == ImuKind::Increments) {
            // An increment belongs to its own nominal interval: a longer step before it is a hole, not a slower motion.
            factor = dt <= hole_factor * median_dt ? 1.0 : dt / median_dt;
        }
        intervals.push_back({end, dt, C * s.gyro * factor, C * s.accel * factor});
    }
    return intervals;
}

/// Mean squares, over the log, of the error of interpolating rate and specific force half way through a hole of a length.
struct InterpolationError {
    double rate2 = 0.0, force2 = 0.0;   ///< one axis
};

InterpolationError interpolation_error(const std::vector<ImuIncrement>& intervals, double hole, double median_dt) {
    const auto half = static_cast<std::size_t>(std::clamp(0.5 * hole / median_dt, 1.0, 0.25 * static_cast<double>(intervals.size())));
    const std::size_t step = std::max<std::size_t>(1, intervals.size() / 4000);
    InterpolationError e;
    double n = 0.0;
    for (std::size_t i = half; i + half < intervals.size(); i += step) {
        const ImuIncrement &a = intervals[i - half], &m = intervals[i], &b = intervals[i + half];
        e.rate2 += (m.dtheta / m.dt - 0.5 * (a.dtheta / a.dt + b.dtheta / b.dt)).squaredNorm() / 3.0;
        e.force2 += (m.dv / m.dt - 0.5 * (a.dv / a.dt + b.dv / b.dt)).squaredNorm() / 3.0;
        n += 1.0;
    }
    if (n > 0.0) e = {e.rate2 / n, e.force2 / n};
    return e;
}

/// How much rate and specific force vary around a hole, root mean square about the mean over a second each side; no less than what
/// interpolation over such a hole is wrong by elsewhere in the log where that is livelier, for a turn may begin in it.
BridgeNoise bridge_noise(const std::vector<ImuIncrement>& intervals, std::size_t i, double hole, double median_dt) {
    const auto reach = static_cast<std::size_t>(std::clamp(1.0 / median_dt, 4.0, 2000.0));
    const std::size_t first = i > reach ? i - reach : 0, last = std::min(intervals.size() - 1, i + reach);
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();
    const auto n = static_cast<double>(last - first + 1);
    for (std::size_t k = first; k <= last; ++k) {
        rate += intervals[k].dtheta / (intervals[k].dt * n);
        force += intervals[k].dv / (intervals[k].dt * n);
    }
    double rate2 = 0.0, force2 = 0.0;
    for (std::size_t k = first; k <= last; ++k) {
        rate2 += (intervals[k].dtheta / intervals[k].dt - rate).squaredNorm() / (3.0 * n);
        force2 += (intervals[k].dv / intervals[k].dt - force).squaredNorm() / (3.0 * n);
    }
    const InterpolationError elsewhere = interpolation_error(intervals, hole, median_dt);
    if (elsewhere.rate2 > 2.0 * rate2) rate2 = elsewhere.rate2;   // in steady motion interpolation is off by up to twice what varies
    if (elsewhere.force2 > 2.0 * force2) force2 = elsewhere.force2;
    // The unknown part is taken as correlated over half of the hole: variance of its integral = s^2 * hole * hole / 2.
    return {0.5 * hole * rate2, 0.5 * hole * force2};
}

bool is_hole(double dt, double nominal, const ImuSettings& settings) {
    return dt > hole_factor * nominal && (settings.kind == ImuKind::Increments || dt > settings.gap_factor * nominal);
}

/// The intervals with every hole among them filled by interpolation. Returns the longest gap, s.
double bridge(const std::vector<ImuIncrement>& intervals, const ImuSettings& settings, ImuTimeline& timeline) {
    const double nominal = timeline.median_dt;
    timeline.increments.reserve(intervals.size() + intervals.size() / 16);
    double longest = 0.0;
    for (std::size_t i = 0; i < intervals.size(); ++i) {
        const ImuIncrement& v = intervals[i];
        if (i == 0 || !is_hole(v.dt, nominal, settings)) {
            timeline.increments.push_back(v);
            continue;
        }
        // The last nominal interval is what the sample measured; only the time before it is unknown.
        const ImuIncrement& before = intervals[i - 1];
        const Vector3d rate0 = before.dtheta / before.dt, rate1 = v.dtheta / v.dt;
        const Vector3d force0 = before.dv / before.dt, force1 = v.dv / v.dt;
        const double missing = v.dt - nominal;
        const double step = std::max(nominal, missing / 400.0);
        const auto pieces = std::max<std::int64_t>(1, std::llround(missing / step));
        const std::size_t first = timeline.increments.size();
        const std::int64_t missing_ns = Duration::from_seconds(missing).ns;
        Time at = before.time;
        for (std::int64_t k = 1; k <= pieces; ++k) {
            const Time end{before.time.ns + missing_ns * k / pieces};
            const double dt = (end - at).seconds();
            const double x = (static_cast<double>(k) - 0.5) / static_cast<double>(pieces);
            timeline.increments.push_back(
                {end, dt, ((1.0 - x) * rate0 + x * rate1) * dt, ((1.0 - x) * force0 + x * force1) * dt});
            at = end;
        }
        const double own = (v.time - at).seconds();
        timeline.increments.push_back({v.time, own, rate1 * own, force1 * own});
        if (v.dt > settings.gap_factor * nominal) {
            timeline.bridges.push_back({first, timeline.increments.size() - 2, bridge_noise(intervals, i, v.dt, nominal)});
            ++timeline.gaps;
            longest = std::max(longest, v.dt);
        }
    }
    return longest;
}

}  // namespace

ImuTimeline make_imu_timeline(const std::vector<ImuSample>& samples, const ImuSettings& settings, WarningLog& warnings) {
    if (samples.size() < 2)
        throw input_error("the IMU log has fewer than two rows", {.file = {}, .key = "imu.file"}, "give a longer log");
    ImuTimeline timeline;
    timeline.median_dt = median_step(samples);
    std::size_t hanging = 0;
    const std::vector<bool> stuck = stuck_samples(samples, timeline.median_dt, hanging);
    std::vector<ImuIncrement> intervals = intervals_of(samples, stuck, settings, timeline.median_dt, timeline.duplicates);
    const bool holes = std::ranges::any_of(intervals.begin() + 1, intervals.end(), [&](const ImuIncrement& v) {
        return is_hole(v.dt, timeline.median_dt, settings);
    });
    double longest = 0.0;
    if (holes) {
        longest = bridge(intervals, settings, timeline);
    } else {
        timeline.increments = std::move(intervals);   // the usual case costs no second copy
    }
    const std::vector<Bridge> doubtful = doubtful_stretches(timeline);
    timeline.doubtful = doubtful.size();
    timeline.bridges.insert(timeline.bridges.end(), doubtful.begin(), doubtful.end());
    std::ranges::sort(timeline.bridges, {}, &Bridge::first);
    if (timeline.doubtful > 0)
        warnings.add("imu.doubtful", fmt::format("{} half second{} of the IMU log, the first at {:.3f} s, are rougher than all the rest or saturated: "
                                                 "they count with the noise of what departs there",
                                                 timeline.doubtful, timeline.doubtful == 1 ? "" : "s",
                                                 timeline.increments[doubtful.front().first].time.seconds()));
    if (timeline.gaps > 0)
        warnings.add("imu.gaps", fmt::format("the IMU log has {} gap{} (longest {:.3f} s), bridged by interpolation with a larger "
                                             "uncertainty",
                                             timeline.gaps, timeline.gaps == 1 ? "" : "s", longest));
    if (hanging > 0)
        warnings.add("imu.stuck", fmt::format("{} IMU rows repeat rates or forces to the last digit: the unit hung, they count as a hole", hanging));
    if (timeline.duplicates > 0)
        warnings.add("imu.duplicates",
                     fmt::format("{} IMU rows repeat a time or go backwards and were left out", timeline.duplicates));
    return timeline;
}

namespace {

Duration age(double row_age, double latency) { return Duration::from_seconds(row_age + latency); }

/// Marks an epoch of the reference channel by the outages: withheld inside, and the first one after each.
void mark_outages(Event& e, const std::vector<Outage>& outages, Time origin, std::vector<bool>& ended) {
    const double t = (e.stamp - origin).seconds();
    for (std::size_t k = 0; k < outages.size(); ++k) {
        const double stop = outages[k].start + outages[k].duration;
        constexpr double tolerance = 1e-6;
        if (t > outages[k].start + tolerance && t < stop - tolerance) {
            e.withheld = true;
            e.outage = static_cast<int>(k);
            return;
        }
        if (t >= stop - tolerance && e.kind == AidKind::GnssPosition && !ended[k]) {
            e.outage = static_cast<int>(k);
            e.outage_end = true;
            return;
        }
    }
}

void add_gnss_events(const Recording& recording, const Settings& settings, Time origin, std::vector<Event>& events,
                     std::size_t& repeated) {
    const GnssSettings& g = settings.gnss;
    const double height_latency = g.height_latency.value_or(g.latency);
    const double velocity_latency = g.velocity_latency.value_or(g.latency);
    const double down_latency = g.velocity_down_latency.value_or(velocity_latency);
    std::vector<bool> ended(settings.outages.size(), false);
    Time last{INT64_MIN};
    auto next_change = g.constellation_changes.begin();
    const GnssFix* previous = nullptr;
    for (std::size_t i = 0; i < recording.gnss.size(); ++i) {
        const GnssFix& fix = recording.gnss[i];
        if (fix.fix == FixType::None) continue;
        const bool same_position = previous != nullptr && previous->position.lat == fix.position.lat &&
                                   previous->position.lon == fix.position.lon && previous->position.h == fix.position.h;
        if (fix.time == last && same_position) {
            ++repeated;
            continue;
        }
        last = fix.time;
        Event e;
        e.constellation_change = previous != nullptr && previous->satellites >= 0 && fix.satellites >= 0 &&
                                 previous->satellites != fix.satellites;
        for (; next_change != g.constellation_changes.end() && *next_change <= fix.time + Duration{1'000}; ++next_change)
            e.constellation_change = true;
        previous = &fix;
        e.stamp = fix.time;
        e.index = i;
        const auto push = [&](AidKind kind, std::uint8_t components, Duration lag) {
            if (components == 0) return;
            e.kind = kind;
            e.components = components;
            e.valid = fix.time - lag;
            e.withheld = e.outage_end = false;
            e.outage = -1;
            mark_outages(e, settings.outages, origin, ended);
            events.push_back(e);
        };
        const bool has_horizontal = std::isfinite(fix.position.lat) && std::isfinite(fix.position.lon);
        const bool has_height = std::isfinite(fix.position.h);
        const Duration lag = age(fix.position_age, g.latency), lag_h = age(fix.position_age, height_latency);
        if (has_horizontal && has_height && lag == lag_h) {
            push(AidKind::GnssPosition, 7, lag);
        } else {
            push(AidKind::GnssPosition, has_horizontal ? 3 : 0, lag);
            push(AidKind::GnssPosition, has_height ? 4 : 0, lag_h);
        }
        if (settings.gnss.use_velocity) {
            const bool has_ne = fix.velocity_n.head<2>().allFinite(), has_d = std::isfinite(fix.velocity_n.z());
            const Duration lag_v = age(fix.velocity_age, velocity_latency), lag_d = age(fix.velocity_age, down_latency);
            if (has_ne && has_d && lag_v == lag_d) {
                push(AidKind::GnssVelocity, 7, lag_v);
            } else {
                push(AidKind::GnssVelocity, has_ne ? 3 : 0, lag_v);
                push(AidKind::GnssVelocity, has_d ? 4 : 0, lag_d);
            }
        }
        const double t = (fix.time - origin).seconds();
        for (std::size_t k = 0; k < ended.size(); ++k)
            if (has_horizontal && t >= settings.outages[k].start + settings.outages[k].duration - 1e-6) ended[k] = true;
    }
}

/// The first epoch after an outage is compared before its own update: what of that epoch is older than its position (a velocity
/// with a longer latency) must not have been used either.
void withhold_before_ends(std::vector<Event>& events) {
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (!events[i].outage_end || (events[i].components & 3) != 3) continue;
        for (std::size_t k = i; k-- > 0 && (events[i].valid - events[k].valid).seconds() < 2.0;) {
            const bool gnss = events[k].kind == AidKind::GnssPosition || events[k].kind == AidKind::GnssVelocity;
            if (gnss && events[k].stamp >= events[i].stamp) events[k].withheld = true;
        }
    }
}

/// Loggers repeat the last value between conversions, and the errors of fast samples are not independent: one event for each new
/// value, and at most one in these times.
constexpr Duration baro_spacing{500'000'000}, mag_spacing{500'000'000};

Event event_at(Time time, AidKind kind, std::uint8_t components, std::size_t index) {
    Event e;
    e.stamp = e.valid = time;
    e.kind = kind;
    e.components = components;
    e.index = index;
    return e;
}

void add_baro_events(const Recording& recording, std::vector<Event>& events) {
    Time last{INT64_MIN / 2};
    double value = not_given;
    for (std::size_t i = 0; i < recording.baro.size(); ++i) {
        const BaroSample& s = recording.baro[i];
        if (!std::isfinite(s.height) || s.height == value || s.time - last < baro_spacing) continue;
        last = s.time;
        value = s.height;
        events.push_back(event_at(s.time, AidKind::Baro, 4, i));
    }
}

void add_mag_events(const Recording& recording, std::vector<Event>& events) {
    Time last{INT64_MIN / 2};
    for (std::size_t i = 0; i < recording.mag.size(); ++i) {
        const MagSample& s = recording.mag[i];
        if (!s.field_b.allFinite() || s.time - last < mag_spacing) continue;
        last = s.time;
        events.push_back(event_at(s.time, AidKind::Mag, 1, i));
    }
}

/// Wheels are read faster than their errors change: at most one event in this time.
constexpr Duration odometer_spacing{100'000'000};

void add_odometer_events(const Recording& recording, std::vector<Event>& events) {
    Time last{INT64_MIN / 2};
    for (std::size_t i = 0; i < recording.odometer.size(); ++i) {
        const OdometerSample& s = recording.odometer[i];
        if (!std::isfinite(s.speed) || s.time - last < odometer_spacing) continue;
        last = s.time;
        events.push_back(event_at(s.time, AidKind::Odometer, 1, i));
    }
}

void add_heading_events(const Recording& recording, std::vector<Event>& events) {
    for (std::size_t i = 0; i < recording.heading.size(); ++i)
        if (std::isfinite(recording.heading[i].heading)) events.push_back(event_at(recording.heading[i].time, AidKind::Heading, 1, i));
}

}  // namespace

std::vector<Event> make_events(const Recording& recording, const Settings& settings, Time origin, WarningLog& warnings) {
    std::vector<Event> events;
    std::size_t repeated = 0;
    add_gnss_events(recording, settings, origin, events, repeated);
    if (settings.baro.use) add_baro_events(recording, events);
    if (settings.mag.use) add_mag_events(recording, events);
    if (settings.odometer.use) add_odometer_events(recording, events);
    if (settings.heading.use) add_heading_events(recording, events);
    if (repeated > 0)
        warnings.add("gnss.duplicates", fmt::format("{} GNSS epochs repeat the one before them and were left out", repeated));
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.valid < b.valid; });
    withhold_before_ends(events);
    return events;
}

}  // namespace schuler::fusion
