// Everything one run has made: data, result, evaluation, timing; and what is written of it.
#pragma once

#include "schuler/app/dataset.h"
#include "schuler/app/evaluate.h"
#include "schuler/app/published.h"
#include "schuler/app/self_check.h"
#include "schuler/app/simulated_receiver.h"
#include "schuler/app/verdict.h"
#include "schuler/fusion/result.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace schuler::report {
struct ReportInput;
}

namespace schuler::app {

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct Timing {
    double read_s = 0.0, filter_s = 0.0, check_s = 0.0, write_s = 0.0, wall_s = 0.0;
};

/// A setting that was given and had no effect on a run.
struct Ignored {
    std::string key, reason;
};

struct ResultBundle {
    std::string command;                         ///< "process", "run"
    std::string version;
    std::string name;
    std::optional<std::uint64_t> seed;
    LoadedDataset data;
    std::shared_ptr<const SimulatedSky> sky;     ///< a simulated receiver's, which takes part in medium and deep runs; or null
    std::vector<ReceiverRow> receiver_rows;      ///< what became of its channels
    fusion::Result result;
    HiddenTruth truth;                           ///< simulated data
    Evaluation evaluation;
    Published published;                         ///< for the scenario, to compare with
    std::string config_toml;                     ///< every setting as used
    std::vector<Fact> facts;                     ///< how each setting of the data is known
    std::vector<Ignored> ignored;                ///< what was given and had no effect
    std::vector<std::string> warnings;
    std::optional<SelfCheck> self_check;         ///< of `process`
    SolutionVerdict verdict;
    Timing timing;

    [[nodiscard]] bool smoothed() const { return !result.smoothed.rows.empty(); }
    [[nodiscard]] const fusion::Trajectory& solution() const { return smoothed() ? result.smoothed : result.forward; }
    [[nodiscard]] double relative(Time t) const { return (t - data.origin).seconds(); }
};

/// Every setting as it was in force, as TOML that repeats the run.
[[nodiscard]] std::string config_in_force(const LoadedDataset& data);

/// As in settings and summaries.
[[nodiscard]] std::string_view scheme_name(Scheme scheme);
[[nodiscard]] std::string_view loop_name(fusion::Loop loop);

[[nodiscard]] std::string_view integrity_test_name(fusion::IntegrityTest test);

/// summary.json, with the fields of the interface contract; numbers that do not apply are null.
[[nodiscard]] std::string summary_json(const ResultBundle& bundle);

/// The same numbers as tables for people.
[[nodiscard]] std::string summary_tables(const ResultBundle& bundle);

/// What the page of report.html shows; and the page. The same bundle gives the same bytes: no clock, no timing.
[[nodiscard]] report::ReportInput report_page(const ResultBundle& bundle);
[[nodiscard]] std::string report_html(const ResultBundle& bundle);

/// run.h5 with solution, sensor errors, innovations, sky, outages, and truth and errors where there is a reference (docs/ui.md).
void write_run_h5(const std::filesystem::path& file, const ResultBundle& bundle);

/// The solution at each event of the data, in the order of its file; all but the time is NaN at those outside the solution.
struct EventRows {
    std::vector<NamedInstant> events;
    std::vector<SolutionRow> rows;
    std::vector<NamedInstant> outside;
};
[[nodiscard]] EventRows event_rows(const ResultBundle& bundle);
/// Names the lines of events outside the solution.
void warn_of_events_outside(const ResultBundle& bundle, WarningLog& warnings);

/// Takes out what only a run of the navigation filter gives: the point, the events, the filter backward in time; with a warning each.
void leave_out_chosen(LoadedDataset& data, WarningLog& warnings);

/// protection.csv: protection levels and alarms of the tight filter, an epoch of ranges a row.
[[nodiscard]] std::string protection_csv(const ResultBundle& bundle);
/// receiver.csv: the receiver's own filter of the medium coupling and its check against the tight one.
[[nodiscard]] std::string receiver_csv(const ResultBundle& bundle);

/// Writes a text under its name when complete.
void write_text(const std::filesystem::path& file, const std::string& text);

/// The folder and those above it. @throws Error(Input) where it cannot be made.
void make_folder(const std::filesystem::path& folder);

/// The first row in each period of the time axis, at `rate` Hz; 0 = all rows.
[[nodiscard]] std::vector<SolutionRow> thinned(std::vector<SolutionRow> rows, double rate);

/// Before the work: that no file in the folder which a run may write is somebody else's (io/own_files.h). @throws Error(Input)
void check_overwrite_of_outputs(const std::filesystem::path& folder);

/// Writes the outputs that the settings choose into a folder, each under its name only when complete, summary.json last.
/// solution.csv only where it is not there already, `streamed` while the filter ran.
/// Returns their paths. @throws Error(Input) where the folder cannot be written.
std::vector<std::filesystem::path> write_outputs(ResultBundle& bundle, const std::filesystem::path& folder, bool streamed);

}  // namespace schuler::app
