#include "schuler/fusion/timeline.h"

#include "schuler/core/error.h"
#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/stream/event_maker.h"
#include "schuler/filter/stream/imu_intervals.h"
#include "schuler/fusion/faults/imu_faults.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

/// The intervals of a log's samples.
std::vector<ImuIncrement> intervals_of(const std::vector<ImuSample>& samples, const std::vector<bool>& stuck,
                                       const ImuSettings& settings, double median_dt, std::size_t& duplicates) {
    std::vector<ImuIncrement> intervals;
    intervals.reserve(samples.size());
    IntervalMaker maker(settings, median_dt);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (stuck[i]) continue;
        const std::optional<Time> next = i + 1 < samples.size() ? std::optional<Time>(samples[i + 1].time) : std::nullopt;
        if (const std::optional<ImuIncrement> interval = maker.add(samples[i], next)) intervals.push_back(*interval);
        else ++duplicates;
    }
    return intervals;
}

/// Mean squares, over the log, of the error of interpolating rate and specific force to the middle of a gap of a given length.
Agitation interpolation_error(const std::vector<ImuIncrement>& intervals, double hole, double median_dt) {
    const auto half =
        static_cast<std::size_t>(std::clamp(0.5 * hole / median_dt, 1.0, 0.25 * static_cast<double>(intervals.size())));
    const std::size_t step = std::max<std::size_t>(1, intervals.size() / 4000);
    Agitation e;
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

/// Variation of rate and specific force around a gap, mean square about the mean over a second on each side.
Agitation agitation_around(const std::vector<ImuIncrement>& intervals, std::size_t i, double median_dt) {
    const auto reach = static_cast<std::size_t>(std::clamp(1.0 / median_dt, 4.0, 2000.0));
    const std::size_t first = i > reach ? i - reach : 0, last = std::min(intervals.size() - 1, i + reach);
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();
    const auto n = static_cast<double>(last - first + 1);
    for (std::size_t k = first; k <= last; ++k) {
        rate += intervals[k].dtheta / (intervals[k].dt * n);
        force += intervals[k].dv / (intervals[k].dt * n);
    }
    Agitation a;
    for (std::size_t k = first; k <= last; ++k) {
        a.rate2 += (intervals[k].dtheta / intervals[k].dt - rate).squaredNorm() / (3.0 * n);
        a.force2 += (intervals[k].dv / intervals[k].dt - force).squaredNorm() / (3.0 * n);
    }
    return a;
}

/// The intervals with every gap filled by interpolation. Returns the longest gap, s.
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
        const std::size_t first = timeline.increments.size();
        fill_hole(intervals[i - 1], v, nominal, [&](const ImuIncrement& piece, bool) { timeline.increments.push_back(piece); });
        if (v.dt > settings.gap_factor * nominal) {
            const BridgeNoise noise =
                bridge_noise(v.dt, agitation_around(intervals, i, nominal), interpolation_error(intervals, v.dt, nominal));
            timeline.bridges.push_back({first, timeline.increments.size() - 2, noise});
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
    const std::vector<bool> stuck =
        settings.noiseless ? std::vector<bool>(samples.size()) : stuck_samples(samples, timeline.median_dt, hanging);
    std::vector<ImuIncrement> intervals = intervals_of(samples, stuck, settings, timeline.median_dt, timeline.duplicates);
    const bool holes = std::ranges::any_of(intervals.begin() + 1, intervals.end(),
                                           [&](const ImuIncrement& v) { return is_hole(v.dt, timeline.median_dt, settings); });
    double longest = 0.0;
    if (holes) {
        longest = bridge(intervals, settings, timeline);
    } else {
        timeline.increments = std::move(intervals);  // avoids a second copy in the usual case
    }
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings.mounting_rpy) * settings.C_bs;
    const Doubts doubts = settings.noiseless ? Doubts{} : doubtful_stretches(timeline, C_bs);
    const std::vector<Bridge>& doubtful = doubts.stretches;
    timeline.doubtful = doubtful.size();
    timeline.bridges.insert(timeline.bridges.end(), doubtful.begin(), doubtful.end());
    std::ranges::sort(timeline.bridges, {}, &Bridge::first);
    if (timeline.doubtful > 0)
        warnings.add(
            "imu.doubtful",
            fmt::format("{} half second{} of the IMU log, the first at {:.3f} s, are rougher than all the rest or saturated: "
                        "they count with the noise of what departs there",
                        timeline.doubtful, timeline.doubtful == 1 ? "" : "s",
                        timeline.increments[doubtful.front().first].time.seconds()));
    constexpr double throughout = 0.02;  // of the samples: above this fraction no motion in this log is undisturbed
    if (doubts.saturated > throughout)
        warnings.add(
            "imu.saturated",
            fmt::format(
                "{:.0f} % of the IMU's samples are at the end of an axis's range: motion beyond full scale was not recorded",
                100.0 * doubts.saturated));
    if (timeline.gaps > 0)
        warnings.add("imu.gaps",
                     fmt::format("the IMU log has {} gap{} (longest {:.3f} s), bridged by interpolation with a larger "
                                 "uncertainty",
                                 timeline.gaps, timeline.gaps == 1 ? "" : "s", longest));
    if (hanging > 0)
        warnings.add("imu.stuck",
                     fmt::format("{} IMU rows repeat rates or forces to the last digit: the output was frozen; treated as a gap",
                                 hanging));
    if (timeline.duplicates > 0)
        warnings.add("imu.duplicates",
                     fmt::format("{} IMU rows repeat a time or go backwards and were left out", timeline.duplicates));
    return timeline;
}

namespace {

/// The first epoch after an outage is compared before its own update: components of that epoch older than its position (a
/// velocity with a longer latency) must not have been used either.
void withhold_before_ends(std::vector<Event>& events) {
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (!events[i].outage_end || (events[i].components & 3) != 3) continue;
        for (std::size_t k = i; k-- > 0 && (events[i].valid - events[k].valid).seconds() < 2.0;) {
            const bool gnss = is_part_of_fix(events[k].kind);
            if (gnss && events[k].stamp >= events[i].stamp) events[k].withheld = true;
        }
    }
}

}  // namespace

std::vector<Event> make_events(const Recording& recording, const Settings& settings, Time origin, WarningLog& warnings,
                               const FixScreen& screen) {
    std::vector<Event> events;
    EventMaker maker(settings, origin);
    for (std::size_t i = 0; i < recording.gnss.size(); ++i)
        maker.gnss(screen.without(recording.gnss[i], i), i, [&](const Event& e) { events.push_back(e); });
    filter::for_each_instrument([&](const auto& instrument) {
        const auto& log = recording.*instrument.log;
        for (std::size_t i = 0; i < log.size(); ++i)
            if (maker.is_due(log[i])) events.push_back(event_at(log[i].time, instrument.kind, instrument.components, i));
    });
    const std::size_t repeated = maker.memory.repeated;
    if (repeated > 0)
        warnings.add("gnss.duplicates", fmt::format("{} GNSS epochs repeat the one before them and were left out", repeated));
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.valid < b.valid; });
    withhold_before_ends(events);
    return events;
}

}  // namespace schuler::fusion
