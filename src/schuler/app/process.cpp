#include "schuler/app/commands.h"
#include "schuler/dataset/imu_log.h"
#include "schuler/dataset/recognise.h"
#include "schuler/fusion/legs.h"
#include "schuler/fusion/realignment.h"
#include "schuler/io/staged_folder.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/solution_stream.h"
#include "schuler/report/summary.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/course.h"
#include "schuler/solution/events.h"
#include "schuler/solution/evidence.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/solution/loaded_dataset.h"
#include "schuler/solution/provenance.h"
#include "schuler/solution/stated_check.h"
#include "schuler/study/comparison/compare.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// True if only solution.csv requires the rows: it is then written while the filter runs.
bool only_written(const solution::LoadedDataset& data) {
    const settings::Config& c = data.config;
    const auto needs_rows = [](const std::string& file) { return file != "solution" && file != "summary" && file != "config"; };
    return c.scheme == settings::Scheme::Loose && !c.filter.smooth && !c.filter.backward &&
           c.filter.output_lever_arm_b.isZero(0.0) && c.filter.output_rate == 0.0 && data.recording.reference.empty() &&
           fusion::leg_starts(data.recording).size() < 2 && c.output.wants("solution") &&
           std::ranges::none_of(c.output.files, needs_rows);
}

/// Repeats the run with these settings; false if the filter fails with them.
bool repeated(solution::ResultBundle& bundle, fusion::Settings settings, const fusion::RowSink& rows) {
    settings.output_rate = solution::internal_rate(bundle.data);
    WarningLog heard;                                 // already
    fusion::Findings found = bundle.result.findings;  // still the basis of the settings
    try {
        bundle.result = fusion::run_filter(bundle.data.recording, settings, heard, {}, rows);
    } catch (const Error& e) {
        if (e.kind() == ErrorKind::Input) throw;  // the disk is full
        return false;
    }
    found.in_force = bundle.result.findings.in_force;
    bundle.result.findings = std::move(found);
    bundle.evaluation = solution::evaluate(bundle.data, bundle.result, bundle.truth);
    return true;
}

/// The self-check of the run; true if it was repeated with increased noise, in which case `rows` has received the rows of the solution.
bool check_itself(solution::ResultBundle& bundle, const fusion::RowSink& rows, WarningLog& warnings) {
    std::optional<fusion::Settings> wider;
    solution::SelfCheck& check = bundle.self_check.emplace(solution::self_check(bundle.data, bundle.result, wider));
    const auto begin = std::chrono::steady_clock::now();
    const bool widened = wider && repeated(bundle, *wider, rows);
    if (widened)
        warnings.add(
            "self_check.widened",
            fmt::format(
                "with fixes withheld the errors are larger than the sigmas: the noise of the gyros is taken {:.3g} times and that "
                "of the accelerometers {:.3g} times as large (validation windows: {:.1f} % of the epochs inside three "
                "sigma, {:.1f} % before)",
                check.tried->gyro, check.tried->accel, 100.0 * check.coverage.epochs.share(),
                100.0 * check.before->epochs.share()));
    if (wider && !widened) check.keep_as_it_was();
    check.seconds += solution::seconds_since(begin);
    solution::judge_fixes(check, bundle.result);
    check.motion.clear();
    bundle.timing.check_s = check.seconds;
    return widened;
}

/// Checks the lever arm; true if the run was repeated with it as a state, and then `rows` has the rows of the solution.
bool check_what_is_stated(solution::ResultBundle& bundle, const fusion::RowSink& rows, WarningLog& warnings) {
    const std::optional<solution::LeverArmDoubt> doubt = solution::doubt_of_lever_arm(bundle.data, bundle.result);
    if (!doubt) return false;
    const auto tell = [&] {
        warnings.add(doubt->unknown ? "unknown.gnss.lever_arm_m"
                     : doubt->given ? "contradiction.gnss.lever_arm_m"
                                    : "found.gnss.lever_arm_m",
                     doubt->text());
    };
    if (doubt->told_only) {
        tell();
        return false;
    }
    fusion::Settings& filter = bundle.data.config.filter;
    if (!doubt->refuted && !repeated(bundle, doubt->settings, rows)) return false;
    filter.estimate_lever_arm = true;
    filter.gnss.found_lever_arm_std = doubt->settings.gnss.found_lever_arm_std;
    if (doubt->refuted) {  // noise and latencies were estimated with the wrong one
        filter.gnss.lever_arm_b = doubt->settings.gnss.lever_arm_b;
        WarningLog heard;
        solution::fuse_and_evaluate(bundle, heard, solution::internal_rate(bundle.data), {}, rows);
    }
    filter.gnss.lever_arm_std = doubt->settings.gnss.lever_arm_std;
    filter.output_at_antenna = doubt->settings.output_at_antenna;
    tell();
    if (doubt->settings.gnss.lever_arm_b == doubt->given_b) return true;
    filter.gnss.lever_arm_b = doubt->settings.gnss.lever_arm_b;
    bundle.data.given.erase("gnss.lever_arm_m");
    std::erase_if(bundle.data.facts, [](const Fact& f) { return f.key == "gnss.lever_arm_m"; });
    Fact& fact = bundle.data.facts.emplace_back();
    fact.key = "gnss.lever_arm_m";
    const Eigen::Vector3d& l = doubt->found_b;
    fact.value = std::vector<double>{l.x(), l.y(), l.z()};
    fact.how = Known::Found;
    fact.sigma = doubt->std_b.head<2>().maxCoeff();
    fact.note = doubt->text();
    return true;
}

/// From loaded data to files: common part of process and run.
/// `asked`: keys of the settings that were given.
report::Outcome finished(solution::ResultBundle& bundle, const settings::ProcessRequest& request,
                         const std::set<std::string>& asked, WarningLog& warnings, const fs::path& folder,
                         std::chrono::steady_clock::time_point begin) {
    bundle.version = request.version;
    report::Outcome out;
    out.folder = request.folder_for(bundle.name);
    report::check_overwrite_of_outputs(out.folder);
    std::unique_ptr<io::StagedFolder> stage;  // only if there is something to write: a run that cannot start leaves no folder
    const auto folder_of_results = [&]() -> const fs::path& {
        if (!stage) stage = std::make_unique<io::StagedFolder>(out.folder);
        return stage->path();
    };
    std::unique_ptr<report::SolutionStream> stream, checked, widened;
    const auto into = [&](std::unique_ptr<report::SolutionStream>& file) -> fusion::RowSink {
        if (!only_written(bundle.data)) return {};
        return [&](std::span<const SolutionRow> rows) {
            if (!file) file = std::make_unique<report::SolutionStream>(folder_of_results() / "solution.csv");
            file->append(rows);
        };
    };
    const WarningLog before = warnings;
    request.begin("filtering");
    solution::fuse_and_evaluate(bundle, warnings, solution::internal_rate(bundle.data), request.progress, into(stream));
    if (stream && fusion::may_realign(bundle.data.config.filter) &&
        fusion::diverged_at(bundle.result)) {  // realigned only if its rows have not been written yet
        stream.reset();
        warnings = before;
        solution::fuse_and_evaluate(bundle, warnings, solution::internal_rate(bundle.data), request.progress, {});
    }
    request.begin("checking");
    if (bundle.command == "process" && check_what_is_stated(bundle, into(checked), warnings)) stream = std::move(checked);
    checked.reset();
    if (bundle.command == "process" && check_itself(bundle, into(widened), warnings)) stream = std::move(widened);
    widened.reset();
    solution::take_in_force(bundle.data.config, bundle.result.findings);
    bundle.facts = solution::facts_of(bundle);
    bundle.config_toml = solution::config_in_force(bundle.data);
    bundle.ignored = solution::ignored_of(bundle, asked);
    if (bundle.command != "process") solution::add_unmade_check(bundle.ignored, request.above);
    solution::warn_of_ignored_here(bundle.ignored, request.above, warnings);
    for (fusion::Trajectory* t : {&bundle.result.forward, &bundle.result.smoothed})
        for (std::vector<SolutionRow>* rows : {&t->rows, &t->point})
            *rows = report::decimated(std::move(*rows), bundle.data.config.filter.output_rate);
    solution::warn_of_events_outside(bundle, warnings);
    if (!bundle.evaluation.errors.empty() && bundle.evaluation.summary.epochs == 0) {
        warnings.add(
            "settle",
            fmt::format("no reference epoch is later than {:.1f} s, from where errors are counted; give a smaller --settle",
                        bundle.relative(bundle.evaluation.settled)));
    }
    const fusion::Counters& n = bundle.result.counters;
    if (n.gnss_rejected > n.gnss_accepted || !bundle.result.findings.heading_found)
        dataset::diagnose_imu_log(folder, bundle.data.config);  // navigation and fixes contradict each other
    if (n.gnss_rejected > n.gnss_accepted) {
        warnings.add(
            "gnss.rejected",
            fmt::format("{} of {} fixes disagree with the inertial navigation and were rejected: the units, axes or times of "
                        "the IMU log, or the lever arm, are probably wrong; do not trust this solution (`schuler inspect` "
                        "measures them)",
                        n.gnss_rejected, n.gnss_rejected + n.gnss_accepted));
    }
    bundle.warnings = warnings.summary();
    bundle.verdict = solution::verdict_of(solution::evidence_of(bundle, warnings));

    request.begin("writing");
    const auto write_begin = std::chrono::steady_clock::now();
    // summary.json contains the writing time of the other files, so it is written last
    if (stream) stream->finish();
    out.files = report::write_outputs(bundle, folder_of_results(), stream != nullptr);
    bundle.timing.write_s = solution::seconds_since(write_begin);
    bundle.timing.read_s = bundle.data.read_seconds;
    bundle.timing.wall_s = solution::seconds_since(begin);
    out.json = report::summary_json(bundle);
    if (bundle.data.config.output.wants("summary")) {
        out.files.push_back(stage->path() / "summary.json");
        report::write_text(out.files.back(), out.json);
    }
    for (fs::path& file : out.files) file = stage->final_path(file);
    stage->publish();
    out.tables = report::summary_tables(bundle);
    out.warnings = bundle.warnings;
    out.verdict = solution::line_of(bundle.verdict);
    out.usable = bundle.verdict.word != solution::Gravity::DoNotUse;
    return out;
}

}  // namespace

report::Outcome process_dataset(const settings::ProcessRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    request.begin("reading");
    const settings::SettingList over = request.over({});
    const bool satellites_only = std::ranges::any_of(over, [](const settings::Setting& s) {
        return s.key == "filter.scheme" && s.value.text() != nullptr && *s.value.text() == "gnss";
    });
    const bool given_start = !request.config.empty() || std::ranges::any_of(request.above, [](const settings::Setting& s) {
        return s.key == "initial.lat_deg";
    });
    const settings::Dataset dataset = settings::open_dataset(
        request.input, given_start && !satellites_only ? dataset::Needs::ImuAndStart : dataset::Needs::ImuAndGnss, over);
    const settings::Config config = settings::config_from(dataset.settings);
    WarningLog warnings;
    solution::ResultBundle bundle;
    bundle.command = "process";
    bundle.name = config.name.empty() ? dataset.name : config.name;
    bundle.data = solution::load_dataset(dataset, config, warnings);
    solution::use_course(bundle.data);
    const std::set<std::string> asked = bundle.data.given;
    report::Outcome out = finished(bundle, request, asked, warnings, dataset.folder, begin);
    out.notice = dataset.inferred_toml;
    return out;
}

report::Outcome run_scenario(const settings::ProcessRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    request.begin("simulating");
    const settings::ScenarioConfig scenario = settings::read_scenario(request.input, request.seed);
    if (!scenario.compared.empty() && !request.names_a_scheme()) return study::compare_schemes(request);
    WarningLog warnings;
    solution::ResultBundle bundle = solution::simulated_bundle(scenario, request.over({}), warnings);
    bundle.command = "run";
    bundle.data.read_seconds = solution::seconds_since(begin);
    return finished(bundle, request, settings::keys_of_processing(scenario, request.over({})), warnings, {}, begin);
}

report::Outcome simulate_to_folder(const fs::path& scenario, const fs::path& folder, std::optional<std::uint64_t> seed) {
    const scenario::SimulatedDataset data = scenario::simulate_dataset(settings::read_scenario(scenario, seed));
    scenario::write_dataset(data, folder);
    report::Outcome out;
    out.folder = folder;
    const Recording& r = data.recording;
    out.tables = fmt::format("{}: {} IMU samples, {} fixes, {} barometer samples, {} reference epochs, seed {}\n", data.name,
                             r.imu.size(), r.gnss.size(), r.baro.size(), r.reference.size(), data.seed);
    return out;
}

report::Outcome run_demonstration(const settings::ProcessRequest& request) {
    settings::ProcessRequest inner = request;
    const fs::path folder = request.output.empty() ? fs::path("out/demo") : request.output;
    const settings::SettingList settings = settings::scenario_table().read(
        settings::parse_toml(settings::built_in_scenario("demo"), "built-in demonstration"), "built-in demonstration");
    scenario::write_dataset(scenario::simulate_dataset(settings::scenario_from(settings)), folder / "dataset");
    inner.input = folder / "dataset";
    inner.output = folder;
    report::Outcome out = process_dataset(inner);
    out.files.insert(out.files.begin(), folder / "dataset");
    return out;
}

}  // namespace schuler::app
