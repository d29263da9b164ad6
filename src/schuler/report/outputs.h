// The files of a run, each written atomically.
#pragma once

#include "schuler/report/report.h"
#include "schuler/solution/bundle.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::report {

/// Content of report.html; and the page. The same bundle gives the same bytes: no clock, no timing.
[[nodiscard]] ReportInput report_page(const solution::ResultBundle& bundle);
[[nodiscard]] std::string report_html(const solution::ResultBundle& bundle);

/// run.h5 with solution, sensor errors, innovations, sky, outages, and truth and errors if there is a reference (docs/ui.md).
void write_run_h5(const std::filesystem::path& file, const solution::ResultBundle& bundle);

/// protection.csv: protection levels and alarms of the tight filter, one row per epoch of ranges.
[[nodiscard]] std::string protection_csv(const solution::ResultBundle& bundle);
/// Of each epoch with carrier phases relative to a base.
[[nodiscard]] std::string ambiguities_csv(const solution::ResultBundle& bundle);
/// receiver.csv: the receiver's own filter of the intermediate coupling and its comparison with the tight one.
[[nodiscard]] std::string receiver_csv(const solution::ResultBundle& bundle);

/// Writes a text file atomically.
void write_text(const std::filesystem::path& file, const std::string& text);

/// Creates the folder and its parents. @throws Error(Input) if it cannot be created.
void make_folder(const std::filesystem::path& folder);

/// The first row in each period of the time axis, at `rate` Hz; 0 = all rows.
[[nodiscard]] std::vector<SolutionRow> decimated(std::vector<SolutionRow> rows, double rate);

/// To be called before the run: an output in the folder must not overwrite a foreign file (io/own_files.h). @throws Error(Input)
void check_overwrite_of_outputs(const std::filesystem::path& folder);

/// Writes the outputs selected in the settings into a folder, each atomically, summary.json last.
/// solution.csv is written only if not already `streamed` during the run.
/// Returns their paths. @throws Error(Input) if the folder cannot be written.
std::vector<std::filesystem::path> write_outputs(solution::ResultBundle& bundle, const std::filesystem::path& folder,
                                                 bool streamed);

}  // namespace schuler::report
