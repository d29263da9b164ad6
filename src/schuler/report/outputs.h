// The files of a run, each under its name only when complete.
#pragma once

#include "schuler/report/report.h"
#include "schuler/solution/bundle.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::report {

/// What the page of report.html shows; and the page. The same bundle gives the same bytes: no clock, no timing.
[[nodiscard]] ReportInput report_page(const solution::ResultBundle& bundle);
[[nodiscard]] std::string report_html(const solution::ResultBundle& bundle);

/// run.h5 with solution, sensor errors, innovations, sky, outages, and truth and errors where there is a reference (docs/ui.md).
void write_run_h5(const std::filesystem::path& file, const solution::ResultBundle& bundle);

/// protection.csv: protection levels and alarms of the tight filter, an epoch of ranges a row.
[[nodiscard]] std::string protection_csv(const solution::ResultBundle& bundle);
/// receiver.csv: the receiver's own filter of the medium coupling and its check against the tight one.
[[nodiscard]] std::string receiver_csv(const solution::ResultBundle& bundle);

/// Writes a text under its name when complete.
void write_text(const std::filesystem::path& file, const std::string& text);

/// The folder and those above it. @throws Error(Input) where it cannot be made.
void make_folder(const std::filesystem::path& folder);

/// The first row in each period of the time axis, at `rate` Hz; 0 = all rows.
[[nodiscard]] std::vector<SolutionRow> decimated(std::vector<SolutionRow> rows, double rate);

/// Before the work: that no file in the folder which a run may write is somebody else's (io/own_files.h). @throws Error(Input)
void check_overwrite_of_outputs(const std::filesystem::path& folder);

/// Writes the outputs that the settings choose into a folder, each under its name only when complete, summary.json last.
/// solution.csv only where it is not there already, `streamed` while the filter ran.
/// Returns their paths. @throws Error(Input) where the folder cannot be written.
std::vector<std::filesystem::path> write_outputs(solution::ResultBundle& bundle, const std::filesystem::path& folder,
                                                 bool streamed);

}  // namespace schuler::report
