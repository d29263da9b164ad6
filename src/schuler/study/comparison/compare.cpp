// One flight processed by several schemes (paper A, table 1.1.1, as numbers).
#include "schuler/study/comparison/compare.h"

#include "schuler/core/error.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/study/comparison/compare_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace schuler::study {
namespace {

/// Number of points of a curve kept from its run for the page.
constexpr std::size_t drawn_points = 6000;

/// The scenario as read with the last value of each key, and the settings that override its data set.
std::string settings_text(const settings::SettingList& settings, const settings::SettingList& over) {
    settings::SettingList used;
    for (const settings::Setting& s : settings) {
        std::erase_if(used, [&s](const settings::Setting& earlier) { return earlier.key == s.key; });
        used.push_back(s);
    }
    const std::string above = over.empty() ? ""
                                           : "\n# above the settings of its data set\n" +
                                                 settings::to_toml(over, settings::config_table().specs(), false);
    return settings::to_toml(used, settings::scenario_table().specs(), false) + above;
}

/// Outputs of single runs, which a comparison does not have, and what has no effect on the run.
std::vector<solution::Ignored> ignored_by_comparison(const solution::ResultBundle& bundle, const std::set<std::string>& asked) {
    const fusion::Settings& f = bundle.data.config.filter;
    std::vector<solution::Ignored> out;
    const auto add = [&](const char* key, bool on) {
        if (on && asked.contains(key)) out.push_back({key, "a comparison keeps no solution of its runs"});
    };
    add("filter.backward", f.backward);
    add("output.events", !bundle.data.config.output.events.empty());
    add("output.lever_arm_m", !f.output_lever_arm_b.isZero(0.0));
    for (const solution::Ignored& i : solution::ignored_of(bundle, asked))
        if (std::ranges::find(out, i.key, &solution::Ignored::key) == out.end()) out.push_back(i);
    return out;
}

}  // namespace

settings::ScenarioConfig with_satellites(const settings::ScenarioConfig& scenario, std::optional<std::size_t> satellites) {
    settings::ScenarioConfig out = scenario;
    if (!satellites) return out;
    if (out.ranging.settings.limits.empty())
        throw input_error("there is no ranges.limit whose number of satellites could be changed",
                          {.file = {}, .key = "compare.satellites"}, "give ranges.limit = [{ start_s = 60, keep = 4 }]");
    out.ranging.settings.limits.front().keep = *satellites;
    return out;
}

bool fuse_compared(solution::ResultBundle& bundle, WarningLog& warnings, double output_rate) {
    fusion::Settings& filter = bundle.data.config.filter;
    const bool backward = std::exchange(filter.backward, false);
    const WarningLog before = warnings;
    bool without = filter.smooth && bundle.data.config.scheme == settings::Scheme::Gnss;
    try {
        solution::fuse_and_evaluate(bundle, warnings, output_rate, {});
    } catch (const Error& e) {  // which settings have no smoother is known to the filter
        if (!filter.smooth || e.kind() != ErrorKind::Input || e.place().key != "filter.smooth") throw;
        filter.smooth = false;
        without = true;
        warnings = before;
        solution::fuse_and_evaluate(bundle, warnings, output_rate, {});
    }
    filter.backward = backward;  // as given: it is told that it has no effect
    return without;
}

std::vector<std::string> warning_of_unsmoothed(const std::vector<const settings::KnownScheme*>& schemes) {
    std::vector<std::string> names;
    for (const settings::KnownScheme* s : schemes)
        if (std::ranges::find(names, s->name) == names.end()) names.emplace_back(s->name);
    if (names.empty()) return {};
    return {fmt::format("filter.smooth: there is no smoother for {}, which {} compared without it", fmt::join(names, ", "),
                        names.size() == 1 ? "is" : "are")};
}

ComparedRun compared_run(const solution::ResultBundle& bundle, const settings::ScenarioConfig& scenario) {
    const auto seconds = [&scenario](Time t) { return (t - scenario.sim.origin).seconds(); };
    ErrorCourse errors;
    for (const analysis::ErrorRow& e : bundle.evaluation.errors) {
        if (!e.position.allFinite()) continue;
        errors.t.push_back(seconds(e.time));
        errors.horizontal.push_back(e.position.head<2>().norm());
        errors.vertical.push_back(std::abs(e.position.z()));
    }
    std::vector<double> solution, reference;
    for (const SolutionRow& row : bundle.solution().rows)
        if (std::isfinite(row.position.lat)) solution.push_back(seconds(row.time));
    for (const ReferenceSample& sample : bundle.data.recording.reference) reference.push_back(seconds(sample.time));
    ComparedRun out;
    out.numbers = compared_numbers(bundle);
    for (const settings::CompareWindow& w : scenario.windows) {
        out.windows.push_back(window_statistics(w, scenario.window_rules, errors, solution, reference));
        add_signal_statistics(out.windows.back(), w, bundle.receiver_rows, scenario.sim.origin);
    }
    out.receiver = bundle.receiver_rows;
    out.course = drawn_course(errors, scenario.window_rules.age, drawn_points);
    return out;
}

report::Outcome compare_schemes(const settings::ProcessRequest& request) {
    const settings::SettingList settings = settings::scenario_settings(request.input, request.seed);
    const settings::ScenarioConfig scenario = settings::scenario_from(settings);
    Comparison c{.name = scenario.name,
                 .version = request.version,
                 .seed = scenario.sim.seed,
                 .duration = scenario.sim.duration,
                 .windows = scenario.windows,
                 .rules = scenario.window_rules,
                 .outages = scenario.outages,
                 .settings = settings_text(settings, request.over({}))};
    double done = 0.0;
    bool report_wanted = false;
    std::optional<std::vector<solution::Ignored>> ignored;  // common to all schemes
    std::set<std::string> asked;
    for (const settings::Setting& s : request.over({})) asked.insert(s.key);
    std::vector<const settings::KnownScheme*> without_smoother;
    std::vector<std::optional<std::size_t>> counts(scenario.compared_satellites.begin(), scenario.compared_satellites.end());
    if (counts.empty()) counts.emplace_back();
    const double each = 1.0 / static_cast<double>(counts.size() * scenario.compared.size());
    for (const std::optional<std::size_t> satellites : counts) {
        const settings::ScenarioConfig flight = with_satellites(scenario, satellites);
        for (const std::string& name : scenario.compared) {
            const settings::KnownScheme& known = settings::known_scheme(name);
            settings::SettingList over = request.over({});
            over.insert(over.end(), known.settings.begin(), known.settings.end());
            WarningLog warnings;
            solution::ResultBundle bundle = solution::simulated_bundle(flight, over, warnings);
            const bool unsmoothed = fuse_compared(bundle, warnings, scenario.sim.reference_rate);
            report_wanted = bundle.data.config.output.wants("report");
            bundle.command = "run";
            const std::vector<solution::Ignored> here = ignored_by_comparison(bundle, asked);
            if (!ignored) ignored = here;
            std::erase_if(*ignored, [&](const solution::Ignored& i) {
                return std::ranges::find(here, i.key, &solution::Ignored::key) == here.end();
            });
            ComparedRun& run = c.runs.emplace_back(compared_run(bundle, scenario));
            run.scheme = &known;
            run.satellites = satellites;
            run.unsmoothed = unsmoothed;
            if (unsmoothed) without_smoother.push_back(&known);
            for (const std::string& w : warnings.summary())
                if (std::ranges::find(c.warnings, w) == c.warnings.end()) c.warnings.push_back(w);
            done += each;
            if (request.progress) request.progress(done);
        }
    }
    std::ranges::copy(warning_of_unsmoothed(without_smoother), std::back_inserter(c.warnings));
    WarningLog without_effect;
    if (ignored) {
        solution::add_unmade_check(*ignored, request.above);
        solution::warn_of_ignored_here(*ignored, request.above, without_effect);
    }
    std::ranges::copy(without_effect.summary(), std::back_inserter(c.warnings));
    c.plots = signal_panels(c, scenario.sim.origin);
    report::Outcome out;
    out.warnings = c.warnings;
    report::ResultFolder files(out, request.folder_for(scenario.name));
    out.json = comparison_json(c);
    out.tables = comparison_tables(c);
    files.write("comparison.csv", comparison_csv(c));
    if (!c.windows.empty()) files.write("windows.csv", windows_csv(c));
    if (report_wanted) files.write("report.html", report::render(comparison_report(c)));
    files.write("summary.json", out.json);
    files.publish();
    return out;
}

}  // namespace schuler::study
