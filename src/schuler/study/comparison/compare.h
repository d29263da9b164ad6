// One flight processed by several schemes: the comparison, and its presentation as text and files.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/report/report.h"
#include "schuler/report/result_table.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/study/comparison/compare_windows.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

/// One scheme on the flight.
struct ComparedRun {
    const settings::KnownScheme* scheme = nullptr;
    std::optional<std::size_t> satellites;        ///< compare.satellites
    std::vector<double> numbers;                  ///< of the table, see compared_numbers
    std::vector<WindowStatistics> windows;        ///< one per window of the comparison
    ErrorCourse course;                           ///< for plotting
    std::vector<scenario::ReceiverRow> receiver;  ///< for a receiver at correlator level
    bool unsmoothed = false;                      ///< smoothing was requested, and the scheme has no smoother
};

/// The numbers of satellites of runs ordered by them.
template <class Runs>
std::vector<std::optional<std::size_t>> counts_of_satellites(const Runs& runs) {
    std::vector<std::optional<std::size_t>> counts;
    for (const auto& run : runs)
        if (counts.empty() || counts.back() != run.satellites) counts.push_back(run.satellites);
    return counts;
}

struct Comparison {
    std::string name{}, version{};
    std::uint64_t seed = 0;
    double duration = 0.0;  ///< s
    std::vector<settings::CompareWindow> windows{};
    settings::WindowRules rules{};
    std::vector<settings::OutageSpan> outages{};  ///< of GNSS
    std::vector<ComparedRun> runs{};              ///< those with equal number of satellites are contiguous
    std::vector<std::string> warnings{};
    std::string settings{};  ///< TOML
    /// Additional plots for the report, over the time of the scenario: windows and outages are marked as in the others.
    std::vector<report::Panel> plots{};

    [[nodiscard]] bool with_satellites() const { return !runs.empty() && runs.front().satellites.has_value(); }
};

/// The scenario with the given number of satellites; unchanged without one. @throws Error(Input) if it has no limit to change.
[[nodiscard]] settings::ScenarioConfig with_satellites(const settings::ScenarioConfig& scenario,
                                                       std::optional<std::size_t> satellites);
/// Fuses and evaluates a run of a comparison: smoothed if that is requested and its scheme has a smoother, never backward in time, which a
/// comparison does not show. True if it is not smoothed although that is requested. @throws Error
[[nodiscard]] bool fuse_compared(solution::ResultBundle& bundle, WarningLog& warnings, double output_rate);
/// The warning that names the schemes without a smoother; empty if all have one.
[[nodiscard]] std::vector<std::string> warning_of_unsmoothed(const std::vector<const settings::KnownScheme*>& schemes);
/// The compared results of an evaluated run; scheme and satellites are set by the caller.
[[nodiscard]] ComparedRun compared_run(const solution::ResultBundle& bundle, const settings::ScenarioConfig& scenario);

/// The numbers of the table for an evaluated run.
[[nodiscard]] std::vector<double> compared_numbers(const solution::ResultBundle& bundle);

/// The table, followed by one per window.
[[nodiscard]] std::string comparison_tables(const Comparison& comparison);
/// comparison.csv and windows.csv. No timing: the same input gives the same bytes.
[[nodiscard]] std::string comparison_csv(const Comparison& comparison);
[[nodiscard]] std::string windows_csv(const Comparison& comparison);
[[nodiscard]] std::string comparison_json(const Comparison& comparison);
/// report.html: the tables, horizontal and vertical errors of all schemes over time, and the additional plots.
[[nodiscard]] report::ReportInput comparison_report(const Comparison& comparison);

/// In the order of compared_numbers().
[[nodiscard]] const std::vector<report::TableColumn>& compared_columns();
/// The same without the last one, the computing time: columns that are identical in every run.
[[nodiscard]] std::vector<report::TableColumn> repeated_columns();
[[nodiscard]] std::vector<report::TableColumn> window_columns(const Comparison& comparison);
/// In the order of window_columns(), with two more for a receiver at correlator level.
[[nodiscard]] std::vector<double> window_numbers(const WindowStatistics& statistics);
/// One row per run: its schemes after settling, with `timing` also the computing time; or within a window of the comparison.
[[nodiscard]] report::ResultTable scheme_table(const Comparison& comparison, bool timing);
[[nodiscard]] report::ResultTable window_table(const Comparison& comparison, std::size_t window);
/// The same with other numbers, and its rows.
[[nodiscard]] report::ResultTable table_of_schemes(std::string title, bool satellites,
                                                   const std::vector<report::TableColumn>& numbers);
[[nodiscard]] std::vector<report::Cell> row_of_scheme(const settings::KnownScheme& scheme, std::optional<std::size_t> satellites,
                                                      const std::vector<double>& numbers);

/// "window jammed, 300 to 420 s".
[[nodiscard]] std::string window_title(const settings::CompareWindow& window);
/// Signal strength, and signals tracked by the receiver of each scheme; empty without a receiver.
[[nodiscard]] std::vector<report::Panel> signal_panels(const Comparison& comparison, Time origin);

/// Explanation of the numbers of windows.
[[nodiscard]] std::string window_note(const Comparison& comparison);
/// From a receiver's rows: `held`, the lowest C/N0 in the window at which it tracked four satellites, and `back`, the time after
/// the window until it tracks four, or all present, for a second: 0 if it did at the end and continues to do so.
void add_signal_statistics(WindowStatistics& out, const settings::CompareWindow& window,
                           const std::vector<scenario::ReceiverRow>& rows, Time origin);

/// The same flight processed by every scheme compared in the scenario, in one table. @throws Error
[[nodiscard]] report::Outcome compare_schemes(const settings::ProcessRequest& request);

}  // namespace schuler::study
