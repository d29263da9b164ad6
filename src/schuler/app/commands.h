// One function per command of the program: no printing, no exit; the doors show what these return.
#pragma once

#include "schuler/app/bundle.h"
#include "schuler/app/scenario.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::app {

/// What every command that fuses data is asked for. `above` are the settings of the command line, the last word.
struct ProcessRequest {
    std::filesystem::path input;                 ///< data set or scenario
    std::filesystem::path output;                ///< folder; empty: out/NAME
    std::filesystem::path config;                ///< --config; empty: none
    SettingList above;
    std::optional<std::uint64_t> seed;           ///< of a scenario
    std::string version;
    std::function<void(double)> progress;        ///< may be empty

    /// All settings of the run: those of the data set, over them --config, over them `above`.
    [[nodiscard]] SettingList over(const SettingList& base) const;
    [[nodiscard]] std::filesystem::path folder_for(const std::string& name) const;

    /// Whether one coupling was asked for (`--scheme`, `filter.scheme` in --config): then it stands in place of a scenario's `[compare]`.
    [[nodiscard]] bool names_a_scheme() const;
};

/// What a command has done, for its door to show.
struct Outcome {
    std::string tables;                          ///< for people
    std::string json;                            ///< one document
    std::vector<std::string> warnings;
    std::string notice;                          ///< for standard error: the inferred dataset.toml
    std::string verdict;                         ///< the last line: whether the solution may be trusted; empty where there is none
    bool usable = true;                          ///< false: everything is written, and the exit status is that of a failed computation
    std::filesystem::path folder;                ///< what was written where
    std::vector<std::filesystem::path> files;
};

/// Reads, fuses, evaluates, writes. @throws Error
[[nodiscard]] Outcome process_dataset(const ProcessRequest& request);

/// Simulates, fuses and evaluates in one go; the same as simulate_to_folder and process_dataset on that folder.
[[nodiscard]] Outcome run_scenario(const ProcessRequest& request);

/// The same flight through every scheme that the scenario compares, one table of them. @throws Error
[[nodiscard]] Outcome compare_schemes(const ProcessRequest& request);

/// Many seeds of a scenario on `jobs` threads (0: one a core): errors and consistency over the runs. @throws Error
[[nodiscard]] Outcome run_montecarlo(const ProcessRequest& request, std::optional<std::size_t> runs, int jobs);

/// The same through every scheme that the scenario compares, what run_montecarlo does where there are such.
[[nodiscard]] Outcome montecarlo_of_schemes(const ProcessRequest& request, std::size_t runs, int jobs);

/// Simulates the reference drive, writes its logs into FOLDER/dataset, processes those, evaluates, reports.
[[nodiscard]] Outcome run_demonstration(const ProcessRequest& request);

/// Writes the data set of a scenario. @throws Error
[[nodiscard]] Outcome simulate_to_folder(const std::filesystem::path& scenario, const std::filesystem::path& folder,
                                         std::optional<std::uint64_t> seed);

/// Compares a solution with a reference. @throws Error(Input) where they have no time in common.
[[nodiscard]] Outcome evaluate_files(const std::filesystem::path& solution, const std::filesystem::path& reference,
                                     double settle);

/// What is in a file or folder.
[[nodiscard]] Outcome inspect_path(const std::filesystem::path& path);

/// Solutions between formats. `format`: csv, kml or kf-gins; raw measurements (UBX, RTCM 3, RINEX) to rinex-obs or rinex-nav;
/// empty: by the name of `out`. @throws Error(Input).
[[nodiscard]] Outcome convert_file(const std::filesystem::path& in, const std::filesystem::path& out, const std::string& format);

/// The options of dataset.toml, --config and --set, or of scenario files, for people.
[[nodiscard]] std::string settings_help(std::string_view prefix);
[[nodiscard]] std::string scenario_help(std::string_view prefix);

}  // namespace schuler::app
