// One flight through several schemes: what is compared, and what is made of it for people and files.
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
    std::vector<WindowStatistics> windows;        ///< one a window of the comparison
    ErrorCourse course;                           ///< as it is drawn
    std::vector<scenario::ReceiverRow> receiver;  ///< of a receiver at correlator level
};

/// The numbers of satellites of runs that are ordered by them.
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
    std::vector<ComparedRun> runs{};              ///< those of one number of satellites stand together
    std::vector<std::string> warnings{};
    std::string settings{};  ///< TOML
    /// Further plots for the report, over the time of the scenario: the windows and outages are marked in them as in the others.
    std::vector<report::Panel> plots{};

    [[nodiscard]] bool with_satellites() const { return !runs.empty() && runs.front().satellites.has_value(); }
};

/// The scenario with the given number of satellites; unchanged without one. @throws Error(Input) where it has no limit to change.
[[nodiscard]] settings::ScenarioConfig with_satellites(const settings::ScenarioConfig& scenario,
                                                       std::optional<std::size_t> satellites);
/// What is compared of a run that has been evaluated; its scheme and satellites are the caller's.
[[nodiscard]] ComparedRun compared_run(const solution::ResultBundle& bundle, const settings::ScenarioConfig& scenario);

/// The numbers of the table for a run that has been evaluated.
[[nodiscard]] std::vector<double> compared_numbers(const solution::ResultBundle& bundle);

/// The table, under it one a window.
[[nodiscard]] std::string comparison_tables(const Comparison& comparison);
/// comparison.csv and windows.csv. No timing: the same input gives the same bytes.
[[nodiscard]] std::string comparison_csv(const Comparison& comparison);
[[nodiscard]] std::string windows_csv(const Comparison& comparison);
[[nodiscard]] std::string comparison_json(const Comparison& comparison);
/// report.html: the tables, horizontal and vertical errors of all schemes over time, and the further plots.
[[nodiscard]] report::ReportInput comparison_report(const Comparison& comparison);

/// In the order of compared_numbers().
[[nodiscard]] const std::vector<report::TableColumn>& compared_columns();
/// The same without the last, the time of the filters: what is the same whenever it is run.
[[nodiscard]] std::vector<report::TableColumn> repeated_columns();
[[nodiscard]] std::vector<report::TableColumn> window_columns(const Comparison& comparison);
/// In the order of window_columns(), which has two more where there is a receiver at correlator level.
[[nodiscard]] std::vector<double> window_numbers(const WindowStatistics& statistics);
/// A row a run: its schemes after settling, `timing` with the time of the filters too; or in a window of the comparison.
[[nodiscard]] report::ResultTable scheme_table(const Comparison& comparison, bool timing);
[[nodiscard]] report::ResultTable window_table(const Comparison& comparison, std::size_t window);
/// The same with other numbers, and its rows.
[[nodiscard]] report::ResultTable table_of_schemes(std::string title, bool satellites,
                                                   const std::vector<report::TableColumn>& numbers);
[[nodiscard]] std::vector<report::Cell> row_of_scheme(const settings::KnownScheme& scheme, std::optional<std::size_t> satellites,
                                                      const std::vector<double>& numbers);

/// "window jammed, 300 to 420 s".
[[nodiscard]] std::string window_title(const settings::CompareWindow& window);
/// Of the signals' strength and of what each scheme's receiver follows; nothing without a receiver.
[[nodiscard]] std::vector<report::Panel> signal_panels(const Comparison& comparison, Time origin);

/// What the numbers of windows mean.
[[nodiscard]] std::string window_note(const Comparison& comparison);
/// Of a receiver's rows: `held`, the lowest C/N0 inside at which it followed four satellites, and `back`, the time after the
/// window until it follows four, or all there are, for a second: 0 where it did at the end and goes on.
void add_signal_statistics(WindowStatistics& out, const settings::CompareWindow& window,
                           const std::vector<scenario::ReceiverRow>& rows, Time origin);

/// The same flight through every scheme that the scenario compares, one table of them. @throws Error
[[nodiscard]] report::Outcome compare_schemes(const settings::ProcessRequest& request);

}  // namespace schuler::study
