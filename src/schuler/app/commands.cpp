#include "schuler/app/commands.h"

#include "schuler/app/evaluation_json.h"
#include "schuler/app/detail/json.h"
#include "schuler/app/raw_gnss.h"
#include "schuler/app/trajectory_file.h"
#include "schuler/inspect/inspect.h"

#include <cmath>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;
std::vector<ReferenceSample> samples_of(const std::vector<SolutionRow>& rows) {
    std::vector<ReferenceSample> out;
    for (const SolutionRow& r : rows) out.push_back({r.time, r.position, r.v_eb_n, r.rpy, true});
    return out;
}

Json problems_of(const std::vector<inspect::Problem>& problems) {
    Json list = Json::array();
    for (const inspect::Problem& p : problems)
        list.push_back({{"level", std::string(inspect::name_of(p.level))}, {"text", p.text}, {"mend", p.mend}});
    return list;
}

}  // namespace

Outcome evaluate_files(const fs::path& solution, const fs::path& reference, double settle) {
    WarningLog warnings;
    const std::vector<SolutionRow> rows = read_trajectory(solution, warnings);
    const std::vector<ReferenceSample> truth = samples_of(read_trajectory(reference, warnings));
    const Evaluation e = compare(earth::Earth{}, rows, truth, settle);
    Outcome out;
    out.tables = evaluation_tables(e);
    out.json = evaluation_json(e, solution.string(), reference.string());
    out.warnings = warnings.summary();
    return out;
}

Outcome inspect_path(const fs::path& path) {
    inspect::InspectReport report = inspect::inspect(path);
    if (report.dataset_toml.empty()) report.dataset_toml = raw_dataset_toml(path);
    Json files = Json::array();
    for (const inspect::FileReport& f : report.files) {
        files.push_back({{"path", f.path},
                         {"kind", f.kind},
                         {"columns", f.columns},
                         {"contents", f.contents},
                         {"rows", f.rows},
                         {"rate_hz", number(f.rate_hz)},
                         {"gaps", f.gaps},
                         {"duplicates", f.duplicates},
                         {"start_s", number(f.start_s)},
                         {"stop_s", number(f.stop_s)},
                         {"problems", problems_of(f.problems)}});
    }
    Json findings = Json::array();
    for (const inspect::Finding& f : report.findings)
        findings.push_back({{"key", f.key}, {"value", f.value}, {"confidence", number(f.confidence)}, {"why", f.why}});
    const Json document{{"path", report.path},
                        {"files", files},
                        {"findings", findings},
                        {"problems", problems_of(report.problems)},
                        {"dataset_toml", report.dataset_toml}};
    Outcome out;
    out.tables = inspect::describe(report);
    out.json = text_of(document);
    return out;
}

std::string settings_help(std::string_view prefix) {
    return listing(config_table().specs(), config_table().used(Config{}), prefix);
}

std::string scenario_help(std::string_view prefix) {
    const ScenarioConfig defaults;
    return listing(scenario_table().specs(), scenario_table().used(defaults), prefix);
}

}  // namespace schuler::app
