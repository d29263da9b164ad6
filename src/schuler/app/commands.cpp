#include "schuler/app/commands.h"

#include "schuler/app/inspect_page.h"
#include "schuler/app/trajectory_clock.h"
#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/dataset/recognise.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/own_files.h"
#include "schuler/io/regular_file.h"
#include "schuler/io/staged_folder.h"
#include "schuler/live/settings.h"
#include "schuler/report/evaluation_json.h"
#include "schuler/report/facts.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/report.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/facts.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;
std::vector<ReferenceSample> samples_of(const std::vector<SolutionRow>& rows) {
    std::vector<ReferenceSample> out;
    for (const SolutionRow& r : rows) out.push_back({r.time, r.position, r.v_eb_n, r.rpy, true});
    return out;
}

bool have_time_in_common(const std::vector<SolutionRow>& a, const std::vector<SolutionRow>& b) {
    return a.front().time <= b.back().time && b.front().time <= a.back().time;
}

report::Json problems_of(const std::vector<inspect::Problem>& problems) {
    report::Json list = report::Json::array();
    for (const inspect::Problem& p : problems)
        list.push_back({{"level", std::string(inspect::name_of(p.level))}, {"text", p.text}, {"mend", p.hint}});
    return list;
}

}  // namespace

void allow_overwrite(const settings::SettingList& given) {
    for (const char* key : {"output", "out", "file"}) {
        const auto place = std::ranges::find(given, key, &settings::Setting::key);
        if (place != given.end() && place->value.text() != nullptr) return io::allow_overwrite(*place->value.text());
    }
    throw input_error("there is no place of results to overwrite", {{}, 0, 0, "--force"}, "name it with -o");
}

report::Outcome evaluate_files(const fs::path& solution, const fs::path& reference, double settle) {
    WarningLog warnings;
    dataset::Trajectory ours = dataset::read_trajectory(solution, warnings),
                        theirs = dataset::read_trajectory(reference, warnings);
    if (!have_time_in_common(ours.rows, theirs.rows)) {  // on one scale, if that is why
        if (counts_from_1970(ours, solution)) to_gps_time(ours);
        if (counts_from_1970(theirs, reference)) to_gps_time(theirs);
    }
    const solution::Evaluation e = solution::compare(earth::Earth{}, ours.rows, samples_of(theirs.rows), settle);
    report::Outcome out;
    out.tables = report::evaluation_tables(e);
    out.json = report::evaluation_json(e, solution.string(), reference.string());
    out.warnings = warnings.summary();
    return out;
}

namespace {

/// Opens and loads a described data set as a run would, with the same errors; facts found from the files are added to the report.
inspect::InspectReport inspect_described(const fs::path& path, std::vector<Fact>& facts) {
    settings::Dataset d = settings::open_dataset(path);
    const settings::Config config = settings::config_from(d.settings);
    WarningLog warnings;
    const solution::LoadedDataset data = solution::load_dataset(d, config, warnings);
    if (config.scheme != settings::Scheme::Gnss) fusion::check_input(data.recording, data.config.filter, warnings);
    inspect::InspectReport report = std::move(d.report);
    report.path = path.string();
    for (const std::string& text : warnings.summary()) report.problems.push_back({inspect::Level::Warning, text, {}});
    report.dataset_toml = settings::to_toml(d.settings, settings::config_table().specs(), false);
    for (const settings::Setting& s : d.settings) {
        Fact fact;
        const auto found = std::ranges::find(d.facts, s.key, &Fact::key);
        if (found != d.facts.end()) fact = *found;
        fact.key = s.key;
        fact.value = settings::fact_value_of(s.value);
        if (d.given.contains(s.key)) fact.how = Known::Given;
        std::erase_if(facts, [&](const Fact& f) { return f.key == s.key; });
        facts.push_back(std::move(fact));
    }
    return report;
}

bool is_described(const fs::path& path) {
    std::error_code ec;
    const auto extension = path.extension();
    return fs::is_directory(path, ec)
               ? fs::exists(path / "dataset.toml", ec)
               : fs::exists(path, ec) && (extension == ".toml" || extension == ".yaml" || extension == ".yml");
}

}  // namespace

report::Outcome inspect_path(const fs::path& path, const fs::path& folder, const std::string& version) {
    std::error_code ec;
    if (!fs::is_directory(path, ec)) io::check_regular_file(path);
    std::vector<Fact> facts;
    const bool described = is_described(path);
    inspect::InspectReport report = described ? inspect_described(path, facts) : inspect::inspect(path);
    if (!described) {
        dataset::add_raw_observations(path, {}, report);
        facts = report.facts;
    }
    report::Json files = report::Json::array();
    for (const inspect::FileReport& f : report.files) {
        files.push_back({{"path", f.path},
                         {"kind", f.kind},
                         {"provides", f.provides},
                         {"columns", f.columns},
                         {"contents", f.contents},
                         {"rows", f.rows},
                         {"rate_hz", report::json_number(f.rate_hz)},
                         {"gaps", f.gaps},
                         {"duplicates", f.duplicates},
                         {"start_s", report::json_number(f.start_s)},
                         {"stop_s", report::json_number(f.stop_s)},
                         {"problems", problems_of(f.problems)}});
    }
    report::Json findings = report::Json::array();
    for (const inspect::Finding& f : report.findings)
        findings.push_back(
            {{"key", f.key}, {"value", f.value}, {"confidence", report::json_number(f.confidence)}, {"why", f.why}});
    const report::Json document{{"path", report.path},
                                {"files", files},
                                {"findings", findings},
                                {"problems", problems_of(report.problems)},
                                {"facts", report::facts_json(facts)},
                                {"dataset_toml", report.dataset_toml}};
    report::Outcome out;
    out.tables = inspect::describe(report);
    if (described) out.tables += "\n" + report::facts_table(facts, true);
    out.json = report::text_of(document);
    if (folder.empty()) return out;
    io::check_overwrite(folder / "report.html");
    io::StagedFolder stage(folder);
    report::write_text(stage.path() / "report.html", report::render(inspect_page(report, version)));
    out.folder = folder;
    out.files.push_back(stage.final_path("report.html"));
    stage.publish("");  // beside whatever is there
    return out;
}

std::string settings_help(std::string_view prefix) {
    return settings::listing(settings::config_table().specs(), settings::config_table().used(settings::Config{}), prefix) +
           settings::listing(live::live_table().specs(), live::live_table().used(live::LiveSettings{}), prefix);
}

std::string scenario_help(std::string_view prefix) {
    const settings::ScenarioConfig defaults;
    return settings::listing(settings::scenario_table().specs(), settings::scenario_table().used(defaults), prefix);
}

}  // namespace schuler::app
