// One flight through several schemes (paper A, table 1.1.1, as numbers).
#include "schuler/app/compare.h"

#include "schuler/app/commands.h"
#include "schuler/app/fuse.h"
#include "schuler/core/error.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

/// Points that a curve keeps from its run to the page.
constexpr std::size_t drawn_points = 6000;

/// The scenario as it was read, the last word on each key, and what stands above the settings of its data set.
std::string settings_text(const SettingList& settings, const SettingList& over) {
    SettingList used;
    for (const Setting& s : settings) {
        std::erase_if(used, [&s](const Setting& earlier) { return earlier.key == s.key; });
        used.push_back(s);
    }
    const std::string above =
        over.empty() ? "" : "\n# above the settings of its data set\n" + to_toml(over, config_table().specs(), false);
    return to_toml(used, scenario_table().specs(), false) + above;
}

}  // namespace

ScenarioConfig with_satellites(const ScenarioConfig& scenario, std::optional<std::size_t> satellites) {
    ScenarioConfig out = scenario;
    if (!satellites) return out;
    if (out.ranging.settings.limits.empty())
        throw input_error("there is no limit whose number could change", {.file = {}, .key = "compare.satellites"},
                          "give ranges.limit = [{ start_s = 60, keep = 4 }]");
    out.ranging.settings.limits.front().keep = *satellites;
    return out;
}

ComparedRun compared_run(const ResultBundle& bundle, const ScenarioConfig& scenario) {
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
    for (const CompareWindow& w : scenario.windows) {
        out.windows.push_back(window_statistics(w, scenario.window_rules, errors, solution, reference));
        add_signal_statistics(out.windows.back(), w, bundle.receiver_rows, scenario.sim.origin);
    }
    out.receiver = bundle.receiver_rows;
    out.course = drawn_course(errors, scenario.window_rules.age, drawn_points);
    return out;
}

Outcome compare_schemes(const ProcessRequest& request) {
    const SettingList settings = scenario_settings(request.input, request.seed);
    const ScenarioConfig scenario = scenario_from(settings);
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
    std::vector<std::optional<std::size_t>> counts(scenario.compared_satellites.begin(), scenario.compared_satellites.end());
    if (counts.empty()) counts.emplace_back();
    const double each = 1.0 / static_cast<double>(counts.size() * scenario.compared.size());
    for (const std::optional<std::size_t> satellites : counts) {
        const ScenarioConfig flight = with_satellites(scenario, satellites);
        for (const std::string& name : scenario.compared) {
            const KnownScheme& known = known_scheme(name);
            SettingList over = request.over({});
            over.insert(over.end(), known.settings.begin(), known.settings.end());
            WarningLog warnings;
            ResultBundle bundle = simulated_bundle(flight, over, warnings);
            fuse_and_evaluate(bundle, warnings, scenario.sim.reference_rate, {});
            report_wanted = bundle.data.config.output.wants("report");
            ComparedRun& run = c.runs.emplace_back(compared_run(bundle, scenario));
            run.scheme = &known;
            run.satellites = satellites;
            for (const std::string& w : warnings.summary())
                if (std::ranges::find(c.warnings, w) == c.warnings.end()) c.warnings.push_back(w);
            done += each;
            if (request.progress) request.progress(done);
        }
    }
    c.plots = signal_panels(c, scenario.sim.origin);
    Outcome out;
    out.warnings = c.warnings;
    out.folder = request.folder_for(scenario.name);
    make_folder(out.folder);
    out.json = comparison_json(c);
    out.tables = comparison_tables(c);
    std::vector<std::pair<const char*, std::string>> files{{"comparison.csv", comparison_csv(c)}};
    if (!c.windows.empty()) files.emplace_back("windows.csv", windows_csv(c));
    if (report_wanted) files.emplace_back("report.html", report::render(comparison_report(c)));
    files.emplace_back("summary.json", out.json);   // last: who waits for it finds all
    for (const auto& [name, text] : files) write_text(out.files.emplace_back(out.folder / name), text);
    return out;
}

}  // namespace schuler::app
