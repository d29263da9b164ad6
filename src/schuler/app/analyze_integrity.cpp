// Faults of the receiver, injected into its log, against the integrity monitor.
#include "schuler/analysis/ensemble.h"
#include "schuler/app/campaign.h"
#include "schuler/app/fuse.h"
#include "schuler/app/studies.h"
#include "schuler/app/detail/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {


/// A kind of fault as a scenario names it, and its size.
struct Case {
    std::string kind;
    double size;
};

struct Verdict {
    bool ran = false, detected = false, false_alarm = false;
    double time_to_alert = 0.0;       ///< s, where detected
    double controlled = 0.0;          ///< m, largest horizontal error from the fault on
    double uncontrolled = 0.0;        ///< m, likewise without integrity control and gates
    double healthy_hours = 0.0;
};

double largest_error(const ResultBundle& b, double from) {
    double out = 0.0;
    for (const analysis::ErrorRow& e : b.evaluation.errors)
        if (b.relative(e.time) >= from) out = std::max(out, e.position.head<2>().norm());
    return out;
}

Verdict judged(const ScenarioConfig& scenario, const SettingList& over, double start, double duration) {
    Verdict v;
    WarningLog unheard;
    SettingList guarded = over, open = over;
    guarded.push_back({"filter.integrity.use", {true}, {}});
    open.push_back({"filter.integrity.use", {false}, {}});
    open.push_back({"filter.gate_probability", {0.0}, {}});
    ResultBundle bundle = simulated_bundle(scenario, guarded, unheard);
    fuse_and_evaluate(bundle, unheard, scenario.sim.reference_rate, {});
    v.controlled = largest_error(bundle, start);
    v.healthy_hours = start / 3600.0;
    for (const fusion::Alert& a : bundle.result.alerts) {
        const double t = bundle.relative(a.time);
        if (a.test == fusion::IntegrityTest::Readmitted) continue;
        if (t < start) v.false_alarm = true;
        if (t < start || t > start + duration + 5.0 || v.detected) continue;
        v.detected = true;
        v.time_to_alert = t - start;
    }
    ResultBundle bare = simulated_bundle(scenario, open, unheard);
    fuse_and_evaluate(bare, unheard, scenario.sim.reference_rate, {});
    v.uncontrolled = largest_error(bare, start);
    v.ran = true;
    return v;
}

}  // namespace

Outcome analyze_integrity(const StudyRequest& request) {
    const SettingList base = scenario_settings(request.scenario, request.seed);
    const ScenarioConfig first = scenario_from(base);
    const double start = request.start > 0.0 ? request.start : std::floor(0.5 * first.sim.duration);
    const std::vector<std::string> kinds = request.kinds.empty() ? std::vector<std::string>{"step", "ramp", "drift"} : request.kinds;
    std::vector<Case> cases;
    for (const std::string& kind : kinds) {
        std::vector<double> sizes = request.sizes;
        if (sizes.empty()) sizes = kind == "step" ? std::vector<double>{5, 10, 20, 50, 100} : std::vector<double>{0.1, 0.2, 0.5, 1, 2};
        for (const double size : sizes) cases.push_back({kind, size});
    }
    const auto scenario_of = [&](const Case& c, std::size_t run) {
        SettingList settings = base;
        settings.push_back({"seed", {static_cast<std::int64_t>(first.sim.seed + run)}, {}});
        const ValueTable fault{{"start_s", {start}}, {"duration_s", {request.duration}}, {"sensor", {std::string("gnss")}},
                               {"kind", {c.kind}},   {"size", {c.size}},                 {"direction", {ValueList{{1.0}, {1.0}, {0.0}}}}};
        settings.push_back({"fault", {ValueList{Value{fault}}}, {"--kind", 0, 0, {}}});
        return scenario_from(settings);
    };
    for (const Case& c : cases) (void)scenario_of(c, 0);   // an unknown kind fails here
    std::vector<Verdict> verdicts(cases.size() * request.runs);
    for_each_run(
        verdicts.size(), request.jobs,
        [&](std::size_t job) {
            verdicts[job] = judged(scenario_of(cases[job / request.runs], job % request.runs), request.above, start, request.duration);
        },
        request.progress);

    Outcome out;
    Json rows = Json::array();
    out.tables = fmt::format("{}: faults from {:g} s for {:g} s, {} runs each, north-east\n  {:<20}{:>11}{:>14}{:>12}{:>16}{:>18}\n", first.name, start,
                             request.duration, request.runs, "fault", "detected", "to alert, s", "95 %, s", "largest, m", "uncontrolled, m");
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
            alarms += k == 0 && v.false_alarm ? 1.0 : 0.0;   // the healthy part is the same in every case
            hours += k == 0 ? v.healthy_hours : 0.0;
        }
        const analysis::Quantiles t = times.empty() ? analysis::Quantiles{} : analysis::quantiles_of(times);
        const double most = analysis::quantiles_of(with).median, wild = analysis::quantiles_of(without).median;
        const auto or_null = [&](double x) { return times.empty() ? Json(nullptr) : Json(x); };
        rows.push_back({{"kind", cases[k].kind},
                        {"size", cases[k].size},
                        {"detected", detected},
                        {"time_to_alert_s", {{"median", or_null(t.median)}, {"q95", or_null(t.q95)}}},
                        {"largest_horizontal_m", most},
                        {"largest_horizontal_uncontrolled_m", wild}});
        const auto shown = [&](double x) { return times.empty() ? std::string("-") : fmt::format("{:.1f}", x); };
        out.tables += fmt::format("  {:<20}{:>11}{:>14}{:>12}{:>16.1f}{:>18.1f}\n",
                                  fmt::format("{} {:g} {}", cases[k].kind, cases[k].size, cases[k].kind == "step" || cases[k].kind == "noise" ? "m" : "m/s"),
                                  fmt::format("{:.0f} %", 100.0 * detected), shown(t.median), shown(t.q95), most, wild);
    }
    out.tables += fmt::format("false alarms before the faults: {:g} of {} runs, {:.2f} h\n", alarms, request.runs, hours);
    out.json = text_of(Json{{"name", first.name},
                    {"runs", request.runs},
                    {"fault_start_s", start},
                    {"fault_duration_s", request.duration},
                    {"rows", rows},
                    {"false_alarm_runs", alarms},
                    {"healthy_h", hours}});
    return out;
}

}  // namespace schuler::app
