#include "schuler/fusion/run_filter.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/fusion/backward.h"
#include "schuler/fusion/faults/height_faults.h"
#include "schuler/fusion/faults/refuted_beginnings.h"
#include "schuler/fusion/intermediate_run.h"
#include "schuler/fusion/legs.h"
#include "schuler/fusion/mounting.h"
#include "schuler/fusion/realignment.h"
#include "schuler/fusion/run_pass.h"
#include "schuler/fusion/start.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/latency_centre.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

/// Settings incompatible with the smoother: its backward pass requires every correction of the estimate to be an optimal update.
const char* unsmoothable(const Settings& s) {
    if (s.coupling == Coupling::Separate) return "with the uncoupled scheme, whose gains are not those of a filter";
    if (s.loose_kind == LooseKind::Aggressive && s.coupling == Coupling::Loose)
        return "with aggressive coupling, which uses a fix in parts";
    if (considers(s)) return "with gnss.consider_errors, whose gains are not those of a filter";
    if (s.integrity.use && !uses_ranges(s.coupling)) return "with integrity control, which goes back to an older solution";
    return nullptr;
}

/// Settings incompatible with the filter backward in time.
const char* irreversible(const Settings& s) {
    if (s.coupling == Coupling::Separate) return "with the uncoupled scheme, whose gains are not those of a filter";
    if (s.coupling == Coupling::Deep) return "with deep coupling, whose receiver cannot be taken back";
    return nullptr;
}

void check_settings(const Recording& recording, const Settings& s) {
    if (!(s.gnss.lever_arm_b.norm() < 1000.0))
        throw input_error(fmt::format("the lever arm is {:.6g} m long", s.gnss.lever_arm_b.norm()),
                          {.file = {}, .key = "gnss.lever_arm_m"}, "give metres from the IMU to the antenna, below 1000");
    if (!(std::abs(s.gnss.latency) < 10.0))
        throw input_error(fmt::format("the latency is {:.6g} s", s.gnss.latency), {.file = {}, .key = "gnss.latency_s"},
                          "give seconds, below 10");
    if (const char* why = unsmoothable(s); s.smooth && why != nullptr)
        throw input_error(fmt::format("there is no smoother {}", why), {.file = {}, .key = "filter.smooth"},
                          "leave out one of them");
    if (const char* why = irreversible(s); s.backward && why != nullptr)
        throw input_error(fmt::format("there is no filter backward in time {}", why), {.file = {}, .key = "filter.backward"},
                          "leave out one of them");
    if (const char* why = only_of_unit(recording, s); s.output_at_antenna && why != nullptr)
        throw input_error(fmt::format("the solution is that of the unit {}", why), {.file = {}, .key = "output.at_antenna"},
                          "leave out one of them");
    if (s.output_rate < 0.0)
        throw input_error("the output rate is negative", {.file = {}, .key = "output_rate"},
                          "give hertz, or 0 for every IMU epoch");
}

/// The times of both sensors must overlap.
void check_overlap(const Recording& recording, const InitialSettings& initial, WarningLog& warnings) {
    if (recording.imu.empty())
        throw input_error("there are no IMU samples", {.file = {}, .key = "imu"}, "name the IMU log in [imu] file");
    if (recording.gnss.empty()) return;
    const double imu0 = recording.imu.front().time.seconds(), imu1 = recording.imu.back().time.seconds();
    const double gnss0 = recording.gnss.front().time.seconds(), gnss1 = recording.gnss.back().time.seconds();
    if (gnss0 <= imu1 && gnss1 >= imu0) return;
    const std::string what = fmt::format("IMU and GNSS do not overlap in time: IMU {:.3f} to {:.3f} s, GNSS {:.3f} to {:.3f} s",
                                         imu0, imu1, gnss0, gnss1);
    // With a complete initial state the inertial unit can be mechanized alone, for comparisons of mechanizations.
    if (std::isfinite(initial.position.lat) && std::isfinite(initial.rpy.z())) {
        warnings.add("time.overlap", what + "; inertial navigation alone from the given initial state");
        return;
    }
    throw input_error(what, {.file = {}, .key = "time"}, "check the time columns and scales; `schuler inspect` shows the spans");
}

/// Settings that reproduce this run with its estimated values as given ones.
Settings in_force(Settings settings) {
    settings.imu.estimate_mounting = settings.imu.estimate_noise = false;
    settings.gnss.estimate_latency = settings.gnss.estimate_std = settings.gnss.latency_found = false;
    return settings;
}

/// s, one sigma of a latency without any information.
constexpr double unmeasured_latency = 0.15;

/// One sigma of a latency: if it was fitted, twice the value from the likelihood, which assumes independent innovations, within
/// the accuracy of such fits.
double latency_std(const char* key, double given, const Findings& findings) {
    const auto tuned = std::ranges::find(findings.tuned, key, &TunedSetting::key);
    if (tuned == findings.tuned.end()) return given;
    return as_written(std::clamp(2.0 * tuned->sigma, 0.02, unmeasured_latency), 1.0);
}

double longest_gap(const ImuTimeline& imu) {
    double longest = 0.0;
    for (const Bridge& b : imu.bridges)
        longest = std::max(longest,
                           (imu.increments[b.last].time - imu.increments[b.first].time).seconds() + imu.increments[b.first].dt);
    return longest;
}

std::size_t last_increment(const RunData& data, const Settings& settings) {
    if (!settings.stop) return data.imu.increments.size() - 1;
    const auto it = std::upper_bound(data.imu.increments.begin(), data.imu.increments.end(), *settings.stop,
                                     [](Time t, const ImuIncrement& i) { return t < i.time; });
    if (it == data.imu.increments.begin())
        throw input_error("the stop time lies before the IMU log", {.file = {}, .key = "--stop"}, "give a later time");
    return static_cast<std::size_t>(it - data.imu.increments.begin()) - 1;
}

}  // namespace

const char* only_of_unit(const Recording& recording, const Settings& s) {
    if (s.coupling != Coupling::Loose && s.coupling != Coupling::Tight) return "with couplings other than loose and tight";
    if (s.backward) return "with a filter backward in time, which starts from it";
    if (!s.output_lever_arm_b.isZero(0.0)) return "with a further output point";
    if (!recording.reference.empty()) return "where it is compared with a reference";
    return nullptr;
}

void check_input(const Recording& recording, const Settings& settings, WarningLog& warnings) {
    check_settings(recording, settings);
    check_overlap(recording, settings.initial, warnings);
    const Geodetic& p = settings.initial.position;
    if (std::isfinite(p.lat) && std::isfinite(p.lon) && std::isfinite(p.h)) return;
    const bool fix = std::ranges::any_of(recording.gnss, [&](const GnssFix& f) {
        return f.time >= recording.imu.front().time && f.time <= recording.imu.back().time && std::isfinite(f.position.lat);
    });
    if (!fix)
        throw input_error(
            "no GNSS fix lies inside the time of the IMU log", {.file = {}, .key = "gnss"},
            "check that both files use the same time axis (`schuler inspect` shows their spans), or give [initial]");
}

namespace {

/// Zero of the times given by a user: the first fix.
Time origin_of(const Recording& recording) {
    return recording.gnss.empty() ? recording.imu.front().time : recording.gnss.front().time;
}

/// Reports sources of ranges found faulty by the watch, with their start times.
void tell_faults(const Result& result, const Recording& recording, WarningLog& warnings) {
    std::map<int, std::pair<Time, int>> found;
    for (const ProtectionRow& row : result.forward.protection)
        if (row.alarm >= 0) ++found.try_emplace(row.alarm, row.time, 0).first->second.second;
    for (const auto& [source, when] : found) {
        const std::string& name = recording.ranges.sources[static_cast<std::size_t>(source)].name;
        const auto& [first, times] = when;
        warnings.add(
            "ranges.fault." + name,
            fmt::format("the ranges of {} contradict the others and the inertial unit, found at {:.0f} s: left out until they "
                        "agree for two minutes, and the solution is freed of them{}",
                        name, (first - origin_of(recording)).seconds(),
                        times > 1 ? fmt::format(" ({} times)", times) : std::string()));
    }
}

/// The ranges without those of sources that a filter with the fault watch finds faulty, empty if there are none: the smoother cannot take
/// a fault out of the past. Adds the levels of that filter to `protection`.
std::optional<RangingLog> without_faulty_sources(const RunData& data, Settings settings, const Start& start, PassOptions options,
                                                 std::vector<ProtectionRow>& protection, WarningLog& warnings) {
    const Recording& recording = *data.recording;
    settings.smooth = options.smooth = options.outputs = settings.backward = false;
    options.progress = {};
    options.rows = {};
    Result watched = settings.coupling == Coupling::Intermediate ? run_intermediate_pass(data, settings, start, options)
                                                                 : run_pass(data, settings, start, options);
    protection = std::move(watched.forward.protection);
    std::map<int, Time> found;
    for (const ProtectionRow& row : protection)
        if (row.alarm >= 0) found.try_emplace(row.alarm, row.time);
    if (found.empty()) return std::nullopt;
    for (const auto& [source, when] : found) {
        const std::string& name = recording.ranges.sources[static_cast<std::size_t>(source)].name;
        warnings.add(
            "ranges.fault." + name,
            fmt::format("the ranges of {} contradict the others and the inertial unit, found at {:.0f} s: left out of the "
                        "whole run, because the smoother cannot take a fault out of the past",
                        name, (when - origin_of(recording)).seconds()));
    }
    RangingLog out{recording.ranges.sources, {}, {}, {}, recording.ranges.to_gps};
    for (const RangeEpoch& e : recording.ranges.epochs) {
        const std::size_t first = out.samples.size(), first_carrier = out.carriers.size();
        const auto healthy = [&](const auto& sample) { return !found.contains(sample.source); };
        std::ranges::copy_if(recording.ranges.of(e), std::back_inserter(out.samples), healthy);
        std::ranges::copy_if(recording.ranges.carriers_of(e), std::back_inserter(out.carriers), healthy);
        out.epochs.push_back({e.time, first, out.samples.size() - first, first_carrier, out.carriers.size() - first_carrier});
    }
    return out;
}

/// False if there are none.
bool leave_out(const std::vector<RefutedBeginning>& wrong, std::vector<Event>& events, Time origin, WarningLog& warnings) {
    for (const RefutedBeginning& w : wrong)
        warnings.add(
            "gnss.jump_after_gap",
            fmt::format("the receiver's positions from {:.1f} to {:.1f} s, the first after an interruption, lie {:.1f} m from "
                        "those that follow, without the IMU feeling the jump: the smoothed run does without them",
                        (w.first - origin).seconds(), (w.end - origin).seconds(), w.jump.norm()));
    return withhold(events, wrong) > 0;
}

/// One leg, or a log without pauses.
Result run_leg(const Recording& recording, const Settings& given, WarningLog& warnings, const Progress& progress,
               const RowSink& rows, const ReceiverInLoop& receiver) {
    check_settings(recording, given);
    if (given.coupling == Coupling::Deep && !receiver)
        throw input_error("deep coupling commands the correlators of a receiver, and a log has none",
                          {.file = {}, .key = "filter.scheme"}, "give a scenario with [receiver], or choose tight");
    check_overlap(recording, given.initial, warnings);
    Settings settings = given;
    if (settings.coupling == Coupling::Separate) settings.loop = Loop::Closed;  // the corrections are the coupling
    RunData data;
    data.recording = &recording;
    data.imu = make_imu_timeline(recording.imu, settings.imu, warnings);
    const Time origin = origin_of(recording);
    data.origin = origin;
    set_limits(data, settings);
    FixScreen screen = screen_fixes(recording.gnss, settings, origin, warnings);
    screen_heights(screen, recording, data.imu, settings, origin, warnings);
    data.events = make_events(recording, settings, origin, warnings, screen);
    const MissingStd missing = missing_std(recording);
    const bool tuning = settings.gnss.estimate_latency || settings.imu.estimate_noise ||
                        (settings.gnss.estimate_std && (missing.position || missing.velocity));
    WarningLog later;
    data.fix_noise = fix_noise(recording, settings.gnss, tuning ? later : warnings);
    data.still = find_still(data.imu, recording, data.events, settings);

    Findings findings;
    Settings untuned = settings;
    if (settings.gnss.estimate_latency) untuned.gnss.latency_std = std::max(settings.gnss.latency_std, unmeasured_latency);
    Start start = find_start(data, untuned, findings, warnings);
    if (tuning) {
        tune(data, settings, start, screen, findings, warnings);
        data.still = find_still(data.imu, recording, data.events, settings);  // its fixes have shifted in time
        settings.gnss.latency_std = latency_std("gnss.latency_s", settings.gnss.latency_std, findings);
        settings.gnss.velocity_latency_std = latency_std("gnss.velocity_latency_s", settings.gnss.velocity_latency_std, findings);
        start = find_start(data, settings, findings, warnings);
    }
    if (centre_latencies(data, settings, start, screen, findings)) {
        WarningLog heard;
        start = find_start(data, settings, findings, heard);
    }
    if (settings.imu.estimate_mounting) {
        const MountingEstimate mounting = estimate_mounting(data, settings, start);
        if (mounting.found) {
            // everything is repeated in the vehicle's axes, as if they had been given
            const Vector3d rpy = math::rpy_from_dcm(mounting.C_vb * math::dcm_from_rpy(settings.imu.mounting_rpy));
            settings.imu.mounting_rpy = rpy.unaryExpr([](double angle) { return as_written(angle, units::deg); });
            settings.imu.mounting_std = as_written(std::max(0.01, 2.0 * mounting.std_rpy.z()), units::deg);
            findings.std_mounting_rpy = mounting.std_rpy;
            settings.imu.found_mounting_std = as_written(mounting.std_rpy.tail<2>().maxCoeff(), units::deg);
            WarningLog heard;  // warnings already issued the first time
            data.imu = make_imu_timeline(recording.imu, settings.imu, heard);
            data.still = find_still(data.imu, recording, data.events, settings);
            start = find_start(data, settings, findings, heard);
        } else {
            warnings.add(
                "mounting",
                "the mounting of the IMU cannot be found: the vehicle hardly moves, or not in one direction of its own; the axes of "
                "the IMU are taken as the vehicle's, and the vehicle constraint is left out");
            settings.constraints.nonholonomic = settings.constraints.nonholonomic_auto = false;
        }
    }
    start.std_mounting = settings.imu.mounting_std;
    findings.started_at = start.nav.time;
    findings.heading = math::rpy_from_quaternion(start.nav.q_nb).z();
    findings.std_heading = start.std_rpy.z();
    findings.in_force = std::make_shared<const Settings>(in_force(settings));
    data.instants = settings.output_instants;  // set only now: trials do not stop there
    PassOptions options;
    options.smooth = settings.smooth;
    options.last_increment = last_increment(data, settings);
    options.progress = progress;
    options.rows = rows;
    Recording live;
    if (receiver) {
        live = recording;
        live.ranges = {};
        data.recording = &live;
        options.receiver = [&](const ReceiverAiding& aiding, Time until) { receiver(aiding, until, live.ranges); };
    }
    const bool watched_first = settings.smooth && settings.ranging.protection.use && uses_ranges(settings.coupling);
    std::vector<ProtectionRow> protection;
    Recording cleaned;
    if (watched_first) {
        if (receiver)
            throw input_error(
                "there is no smoother with filter.protection where a receiver is simulated: it cannot be flown twice",
                {.file = {}, .key = "filter.smooth"}, "leave out one of them");
        if (auto healthy = without_faulty_sources(data, settings, start, options, protection, warnings)) {
            cleaned = recording;
            cleaned.ranges = std::move(*healthy);
            data.recording = &cleaned;
        }
        settings.ranging.protection.use = false;
    }
    const auto run = [&] {
        return settings.coupling == Coupling::Intermediate ? run_intermediate_pass(data, settings, start, options)
                                                           : run_pass(data, settings, start, options);
    };
    Result result = run();
    // a simulated receiver cannot be flown twice
    if (settings.smooth && !receiver && !recording.gnss.empty() &&
        leave_out(refuted_beginnings(result.smoothed.rows, recording.gnss, settings.earth), data.events, origin, warnings))
        result = run();
    if (settings.backward) result.backward = run_backward(data, settings, start, result.forward);

    findings.mounting_rpy = settings.imu.mounting_rpy;
    const auto seconds = [](double latency) { return std::abs(latency) < 1e-12 ? 0.0 : latency; };  // rounding of sums
    findings.position_latency = seconds(settings.gnss.latency);
    findings.height_latency = seconds(settings.gnss.height_latency.value_or(settings.gnss.latency));
    findings.velocity_latency = seconds(settings.gnss.velocity_latency.value_or(settings.gnss.latency));
    findings.velocity_down_latency = seconds(settings.gnss.velocity_down_latency.value_or(findings.velocity_latency));
    findings.lever_arm_b = settings.gnss.lever_arm_b;
    findings.gyro_noise = settings.imu.errors.gyro_noise;
    findings.accel_noise = settings.imu.errors.accel_noise;
    result.findings = findings;
    result.counters.imu_epochs = recording.imu.size();
    result.counters.imu_gaps = data.imu.gaps;
    result.counters.imu_duplicates = data.imu.duplicates;
    result.counters.imu_rate = 1.0 / data.imu.median_dt;
    result.counters.longest_imu_gap = longest_gap(data.imu);
    result.legs = {recording.imu.front().time};
    if (watched_first) result.forward.protection = std::move(protection);
    else tell_faults(result, recording, warnings);
    constexpr double linear = 1.0 * units::deg;  // its square, in the specific force, is below the biases of a tactical unit
    if (result.open_attitude > linear)
        warnings.add(
            "loop.open",
            fmt::format(
                "the loop is open and the attitude error beside the mechanization grew to {:.1f} deg: the linear error model does not "
                "hold there, and neither do the sigmas; choose --loop closed or mixed",
                result.open_attitude / units::deg));
    const auto unjudged = std::ranges::find(result.alerts, IntegrityTest::Unjudged, &Alert::test);
    if (unjudged != result.alerts.end())
        warnings.add(
            "gnss.unjudged",
            fmt::format(
                "from {:.0f} s on the receiver is used without judgement: the uncoupled scheme does not correct its attitude, and "
                "its tilt became uncertain by more than {:.0f} deg; choose --scheme loose",
                (unjudged->time - origin).seconds(), filter::most_tilt_judged / units::deg));
    return result;
}

/// Settings for a part of a recording with a different origin.
Settings moved(Settings settings, const Recording& whole, const Recording& part) {
    const double seconds = (origin_of(part) - origin_of(whole)).seconds();
    for (Outage& o : settings.outages) o.start -= seconds;
    return settings;
}

/// The part before a realignment at `since`: with the settings found for the remainder, and if the headings disagree, with that
/// derived from the remainder. Empty if it is too short.
std::optional<Result> run_before(const Recording& recording, Time since, const Settings& settings, const Result& rest,
                                 const Progress& progress, WarningLog& warnings) {
    const Recording part = part_of(recording, Time{INT64_MIN}, since);
    WarningLog heard;
    try {
        Result result = run_leg(part, settings, heard, progress, {}, {});
        const std::optional<CarriedHeading> shown = heading_carried_back(result, rest);
        if (!shown) return result;
        Settings turned = settings;
        turned.initial.rpy.z() = shown->heading;
        turned.initial.std_rpy.z() = shown->std;
        Result again = run_leg(part, turned, heard, progress, {}, {});
        if (positions_after(again, Time{INT64_MIN}).refused > positions_after(result, Time{INT64_MIN}).refused) return result;
        if (std::isfinite(settings.initial.rpy.z()))
            warnings.add(
                "contradiction.initial.heading_deg",
                fmt::format(
                    "the data contradict initial.heading_deg: {:.1f} deg is given, {:.1f} +- {:.1f} deg is what the motion later shows, and is used",
                    settings.initial.rpy.z() / units::deg, shown->heading / units::deg, shown->std / units::deg));
        return again;
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// A run; if it diverged from the fixes, the part before that and one realigned there, in motion, if the latter explains the fixes.
Result run_realigned(const Recording& recording, const Settings& given, WarningLog& warnings, const Progress& progress,
                     const RowSink& rows, const ReceiverInLoop& receiver, int attempts = 3) {
    Result result = run_leg(recording, given, warnings, progress, rows, receiver);
    // rows already written cannot be changed
    if (attempts == 0 || rows || receiver || !may_realign(given)) return result;
    const std::optional<Time> since = diverged_at(result);
    if (!since) return result;
    const Recording rest = part_of(recording, *since, Time{INT64_MAX});
    WarningLog heard;
    Settings anew = moved(given, recording, rest);
    anew.initial = {};
    std::optional<Result> found;
    try {
        found = run_realigned(rest, anew, heard, progress, {}, {}, attempts - 1);
    } catch (const Error&) {  // no initial state available
        return result;
    }
    if (!explains(*found, result, *since)) return result;
    warnings.add(
        "navigation.realigned",
        fmt::format("{:.1f} s after the first fix the navigation had diverged from the fixes and did not recover; it was "
                    "aligned anew there, in motion",
                    (*since - origin_of(recording)).seconds()));
    Settings settings = found->findings.in_force ? *found->findings.in_force : given;
    settings.initial = given.initial;
    settings.outages = given.outages;
    std::optional<Result> all = run_before(recording, *since, settings, *found, progress, warnings);
    found->findings.in_force = std::make_shared<const Settings>(settings);
    if (!all) return std::move(*found);
    const Findings start = all->findings;
    all->findings = found->findings;
    all->findings.started_at = start.started_at;
    all->findings.heading = start.heading;
    all->findings.std_heading = start.std_heading;
    append(*all, std::move(*found));
    return std::move(*all);
}

}  // namespace

Result run_filter(const Recording& recording, const Settings& given, WarningLog& warnings, const Progress& progress,
                  const RowSink& rows, const ReceiverInLoop& receiver) {
    const std::vector<Time> starts = leg_starts(recording);
    if (starts.size() < 2 || receiver) return run_realigned(recording, given, warnings, progress, rows, receiver);
    check_settings(recording, given);
    check_overlap(recording, given.initial, warnings);
    std::optional<Result> all;
    std::optional<Error> failure;
    std::size_t left_out = 0;
    for (std::size_t k = 0; k < starts.size(); ++k) {
        const Recording leg = leg_of(recording, starts, k);
        if ((given.stop && leg.imu.front().time > *given.stop) || (given.start && leg.imu.back().time < *given.start)) continue;
        const double seconds = (origin_of(leg) - origin_of(recording)).seconds();
        const Settings settings = all ? continued(given, *all, leg, seconds) : moved(given, recording, leg);
        try {
            Result r = run_realigned(leg, settings, warnings, progress, rows, {});
            if (all) {
                append(*all, std::move(r));
                continue;
            }
            if (r.findings.in_force) {  // for the whole log
                auto whole = std::make_shared<Settings>(*r.findings.in_force);
                whole->outages = given.outages;
                r.findings.in_force = std::move(whole);
            }
            all = std::move(r);
        } catch (const Error& e) {  // too short, or without fixes
            if (!failure) failure = e;
            ++left_out;
        }
    }
    if (!all)
        throw failure ? *failure
                      : input_error("no leg of the log can be navigated", {.file = {}, .key = "imu.file"}, "give a longer log");
    warnings.add(
        "legs",
        fmt::format(
            "the inertial log pauses for more than {:.0f} s, or its clock was set together with the receiver's: {} legs, each "
            "started anew",
            longest_bridge, starts.size()));
    if (failure)
        warnings.add("legs.left_out", fmt::format("{} of {} legs left out: {}", left_out, starts.size(), failure->reason()));
    return std::move(*all);
}

}  // namespace schuler::fusion
