// One function per command of the program: no printing, no exit; the interfaces display the returned result.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::app {

/// Reads, processes, evaluates, writes. @throws Error
[[nodiscard]] report::Outcome process_dataset(const settings::ProcessRequest& request);

/// Simulates, processes and evaluates in one step; equivalent to simulate_to_folder and process_dataset on that folder.
[[nodiscard]] report::Outcome run_scenario(const settings::ProcessRequest& request);

/// Simulates the reference drive, writes its logs into FOLDER/dataset, processes those, evaluates, reports.
[[nodiscard]] report::Outcome run_demonstration(const settings::ProcessRequest& request);

/// Writes the data set of a scenario. @throws Error
[[nodiscard]] report::Outcome simulate_to_folder(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                                                 std::optional<std::uint64_t> seed);

/// Compares a solution with a reference. @throws Error(Input) if they have no common time.
[[nodiscard]] report::Outcome evaluate_files(const std::filesystem::path& solution, const std::filesystem::path& reference,
                                             double settle);

/// --force: files at the destination of the results (-o, or the second file of `convert`) may be overwritten regardless of their
/// origin. @throws Error(Input) if the command was given no destination
void allow_overwrite(const settings::SettingList& given);

/// The content of a file or folder; also as a page in `folder`, if given.
[[nodiscard]] report::Outcome inspect_path(const std::filesystem::path& path, const std::filesystem::path& folder = {},
                                           const std::string& version = {});

/// Solutions between formats. `format`: csv, kml or kf-gins; raw measurements (UBX, RTCM 3, RINEX) to rinex-obs or rinex-nav;
/// empty: from the name of `out`. @throws Error(Input).
[[nodiscard]] report::Outcome convert_file(const std::filesystem::path& in, const std::filesystem::path& out,
                                           const std::string& format);

/// The options of dataset.toml, --config and --set, or of scenario files, as readable text.
[[nodiscard]] std::string settings_help(std::string_view prefix);
[[nodiscard]] std::string scenario_help(std::string_view prefix);

/// docs/options.md: every option of commands, data sets and scenarios with unit, range, default and meaning.
[[nodiscard]] std::string option_reference();

}  // namespace schuler::app
