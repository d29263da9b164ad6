// Faults of the receiver, injected into its log, as a test of the integrity monitor.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/parallel.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/studies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace schuler::study {
namespace {

/// A kind of fault as named in a scenario, and its size; NaN for the kinds without one.
struct Case {
    std::string kind;
    double size;
};

bool has_size(const std::string& kind) { return kind != "freeze" && kind != "dropout"; }

std::string label_of(const Case& c) {
    if (!has_size(c.kind)) return c.kind;
    const bool metres = c.kind == "step" || c.kind == "noise";
    return fmt::format("{} {:g} {}", c.kind, c.size, metres ? "m" : "m/s");
}

/// Time of a detected fault, and its source of ranges; -1: the receiver's fixes.
struct Finding {
    Time time;
    int source = -1;
    bool operator==(const Finding&) const = default;
};

struct Verdict {
    bool detected = false, false_alarm = false;
    double time_to_alert = 0.0;  ///< s, if detected
    double controlled = 0.0;     ///< m, largest horizontal error from the fault on
    double uncontrolled = 0.0;   ///< m, likewise without integrity control and gates
    double healthy_hours = 0.0;
};

/// Target of the faults: the receiver's fixes, or the pseudorange of a satellite if the filter, or a loosely coupled receiver,
/// only uses ranges.
enum class Victim { Fixes, Range };

double largest_error(const solution::ResultBundle& b, double from) {
    double out = 0.0;
    for (const analysis::ErrorRow& e : b.evaluation.errors)
        if (b.relative(e.time) >= from) out = std::max(out, e.position.head<2>().norm());
    return out;
}

/// Findings with integrity control. For ranges: alarms of the fault watch, and pseudoranges excluded at two consecutive epochs
/// (at a single epoch the gates exclude some with their false-alarm probability).
std::vector<Finding> findings_of(const solution::ResultBundle& b) {
    std::vector<Finding> out;
    using enum fusion::IntegrityTest;
    for (const fusion::Alert& a : b.result.alerts)
        if (a.test != Readmitted && a.test != Returned && a.test != Unjudged) out.push_back({a.time, -1});
    for (const fusion::ProtectionRow& row : b.result.forward.protection)
        if (row.alarm >= 0) out.push_back({row.time, row.alarm});
    std::map<int, bool> left_out;  // whether a source was excluded at its last epoch
    for (const fusion::MeasurementRecord& r : b.result.measurements) {
        if (r.kind != fusion::MeasurementKind::Pseudorange) continue;
        const bool now = r.status == fusion::MeasurementStatus::Rejected;
        if (now && left_out[r.source]) out.push_back({r.stamp, r.source});
        left_out[r.source] = now;
    }
    std::ranges::stable_sort(out, {}, &Finding::time);
    return out;
}

/// The scenario with a fault of this kind in a satellite's pseudorange, analogous to [[fault]] for fixes: a ramp leaves the rates
/// unchanged, a drift does not.
void spoil_range(settings::ScenarioConfig& s, const Case& c, const std::string& source, double start, double duration) {
    sim::RangeFault fault{source, start, duration, 0.0, 0.0, 0.0};
    if (c.kind == "step") fault.offset = c.size;
    else if (c.kind == "ramp") fault = {source, start, duration, 0.0, c.size, -c.size};
    else if (c.kind == "drift") fault.ramp = c.size;
    else
        throw input_error(fmt::format("ranges do not fail by \"{}\"", c.kind), {.file = {}, .key = "--kind"},
                          "give step, ramp or drift");
    s.ranging.settings.faults.push_back(fault);
}

/// Satellites measured throughout the interval, by name: a receiver's channel may miss an epoch in ten.
std::vector<std::string> satellites_throughout(const RangingLog& log, Time from, Time to) {
    std::map<std::uint16_t, std::size_t> seen;
    std::size_t epochs = 0;
    for (const RangeEpoch& e : log.epochs) {
        if (e.time < from || e.time > to) continue;
        ++epochs;
        for (const RangeSample& m : log.of(e))
            if (!log.sources[m.source].station) ++seen[m.source];
    }
    std::vector<std::string> out;
    for (const auto& [source, n] : seen)
        if (10 * n >= 9 * epochs) out.push_back(log.sources[source].name);
    return out;
}

solution::ResultBundle run_with(const settings::ScenarioConfig& scenario, const settings::SettingList& over, bool controlled,
                                const sim::ExactFlight* flown) {
    settings::SettingList all = over;
    all.push_back({"filter.integrity.use", {controlled}, {}});
    all.push_back({"filter.protection.use", {controlled}, {}});
    if (!controlled) all.push_back({"filter.gate_probability", {0.0}, {}});
    WarningLog unheard;
    solution::ResultBundle bundle = solution::simulated_bundle(scenario, all, unheard, nullptr, flown);
    solution::fuse_and_evaluate(bundle, unheard, scenario.sim.reference_rate, {});
    return bundle;
}

/// A run compared with the same one without a fault: findings common to both are not a detection.
Verdict judged(const settings::ScenarioConfig& scenario, const settings::SettingList& over, const std::vector<Finding>& in_health,
               double start, double duration, const sim::ExactFlight* flown) {
    Verdict v;
    const solution::ResultBundle bundle = run_with(scenario, over, true, flown);
    v.controlled = largest_error(bundle, start);
    v.healthy_hours = start / 3600.0;
    for (const Finding& f : findings_of(bundle)) {
        const double t = bundle.relative(f.time);
        if (t < start) v.false_alarm = true;
        if (t < start || t > start + duration || v.detected || std::ranges::find(in_health, f) != in_health.end()) continue;
        v.detected = true;
        v.time_to_alert = t - start;
    }
    v.uncontrolled = largest_error(run_with(scenario, over, false, flown), start);
    return v;
}

/// Fixes if they exist and are used by the filter.
Victim victim_of(const settings::ScenarioConfig& scenario, const settings::SettingList& over) {
    if (!(scenario.ranging.rate > 0.0) && !(scenario.receiver_channels.rate > 0.0)) return Victim::Fixes;
    if (!(scenario.sim.gnss.rate > 0.0)) return Victim::Range;
    WarningLog unheard;
    const settings::Scheme scheme = solution::simulated_bundle(scenario, over, unheard).data.config.scheme;
    using enum settings::Scheme;
    return scheme == Tight || scheme == Intermediate || scheme == Deep ? Victim::Range : Victim::Fixes;
}

}  // namespace

report::Outcome analyze_integrity(const StudyRequest& request) {
    const settings::SettingList base = settings::scenario_settings(request.scenario, request.seed);
    const settings::ScenarioConfig first = settings::scenario_from(base);
    const double start = request.start > 0.0 ? request.start : std::floor(0.5 * first.sim.duration);
    const std::vector<std::string> kinds =
        request.kinds.empty() ? std::vector<std::string>{"step", "ramp", "drift"} : request.kinds;
    if (!request.sizes.empty() && std::ranges::none_of(kinds, has_size))
        throw input_error(fmt::format("\"{}\" has no size", kinds.front()), {.file = {}, .key = "--size"}, "leave it out");
    std::vector<Case> cases;
    for (const std::string& kind : kinds) {
        if (!has_size(kind)) {
            cases.push_back({kind, not_given});
            continue;
        }
        std::vector<double> sizes = request.sizes;
        if (sizes.empty())
            sizes = kind == "step" ? std::vector<double>{5, 10, 20, 50, 100} : std::vector<double>{0.1, 0.2, 0.5, 1, 2};
        for (const double size : sizes) cases.push_back({kind, size});
    }
    const Victim victim = victim_of(first, request.above);
    const auto flown = sim::exact_flight(first.sim);  // all runs fly the same path
    const auto healthy_of = [&](std::size_t run) {
        settings::SettingList settings = base;
        settings.push_back({"seed", {static_cast<std::int64_t>(first.sim.seed + run)}, {}});
        return settings;
    };
    // clang-format off
    const auto faulty_fixes = [&](settings::SettingList settings, const Case& c) {
        const settings::ValueTable fault{{"start_s", {start}}, {"duration_s", {request.duration}}, {"sensor", {std::string("gnss")}},
                               {"kind", {c.kind}},   {"size", {has_size(c.kind) ? c.size : 0.0}}, {"direction", {settings::ValueList{{1.0}, {1.0}, {0.0}}}}};
        // clang-format on
        settings.push_back({"fault", {settings::ValueList{settings::Value{fault}}}, {"--kind", 0, 0, {}}});
        return settings::scenario_from(settings);
    };
    for (const Case& c : cases) {  // an unknown kind is rejected here
        settings::ScenarioConfig unused = faulty_fixes(base, c);
        if (victim == Victim::Range) spoil_range(unused, c, "", start, request.duration);
    }
    // the same runs without a fault: their findings, and the satellites present
    std::vector<std::vector<Finding>> in_health(request.runs);
    std::vector<std::vector<std::string>> satellites(request.runs);
    for_each_run(request.runs, request.jobs,
                 [&](std::size_t run) {
                     const solution::ResultBundle b =
                         run_with(settings::scenario_from(healthy_of(run)), request.above, true, flown.get());
                     in_health[run] = findings_of(b);
                     const Time begin = b.data.origin + Duration::from_seconds(start),
                                end = begin + Duration::from_seconds(request.duration);
                     if (victim == Victim::Range) satellites[run] = satellites_throughout(b.data.recording.ranges, begin, end);
                 },
                 {});
    const auto scenario_of = [&](const Case& c, std::size_t run) {
        settings::SettingList settings = healthy_of(run);
        if (victim == Victim::Range) {
            if (satellites[run].empty())
                throw input_error("no satellite is in view while its range should be wrong", {.file = {}, .key = "--start"},
                                  "give another time");
            settings::ScenarioConfig s = settings::scenario_from(settings);
            spoil_range(s, c, satellites[run][run % satellites[run].size()], start, request.duration);
            return s;
        }
        return faulty_fixes(std::move(settings), c);
    };
    std::vector<Verdict> verdicts(cases.size() * request.runs);
    for_each_run(
        verdicts.size(), request.jobs,
        [&](std::size_t job) {
            const std::size_t run = job % request.runs;
            verdicts[job] = judged(scenario_of(cases[job / request.runs], run), request.above, in_health[run], start,
                                   request.duration, flown.get());
        },
        request.progress);

    report::ResultTable table{
        fmt::format("{}: faults from {:g} s for {:g} s, {} runs each, {}", first.name, start, request.duration, request.runs,
                    victim == Victim::Range ? "one satellite's range" : "north-east"),
        {{"", "fault"},
         {"kind", ""},
         {"size", ""},
         {"detected", "detected", "", ".0f%"},
         {"time_to_alert_s/median", "time to alert", "s", ".1f"},
         {"time_to_alert_s/q95", "95 % of it", "s", ".1f"},
         {"largest_horizontal_m", "largest error", "m", ".1f"},
         {"largest_horizontal_uncontrolled_m", "without control", "m", ".1f"}}};
    double alarms = 0.0, hours = 0.0;
    for (std::size_t k = 0; k < cases.size(); ++k) {
        std::vector<double> times, with, without;
        double detected = 0.0;
        for (std::size_t run = 0; run < request.runs; ++run) {
            const Verdict& v = verdicts[k * request.runs + run];
            detected += v.detected ? 1.0 / static_cast<double>(request.runs) : 0.0;
            if (v.detected) times.push_back(v.time_to_alert);
            with.push_back(v.controlled);
            without.push_back(v.uncontrolled);
            alarms += k == 0 && v.false_alarm ? 1.0 : 0.0;  // the fault-free part is the same in every case
            hours += k == 0 ? v.healthy_hours : 0.0;
        }
        const analysis::Quantiles t = analysis::quantiles_of(times);
        table.rows.push_back({label_of(cases[k]), cases[k].kind, cases[k].size, detected, t.median, t.q95,
                              analysis::quantiles_of(with).median, analysis::quantiles_of(without).median});
    }
    report::Outcome out;
    out.tables = report::table_text(table);
    out.tables += fmt::format("false alarms before the faults: {:g} of {} runs, {:.2f} h\n", alarms, request.runs, hours);
    out.json = report::text_of(report::Json{{"name", first.name},
                                            {"runs", request.runs},
                                            {"victim", victim == Victim::Range ? "range" : "fixes"},
                                            {"fault_start_s", start},
                                            {"fault_duration_s", request.duration},
                                            {"rows", report::table_json(table)},
                                            {"false_alarm_runs", alarms},
                                            {"healthy_h", hours}});
    return out;
}

}  // namespace schuler::study
