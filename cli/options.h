// What the command line says, and how it becomes settings of the application.
#pragma once

#include "schuler/app/receiver/if_recording.h"
#include "schuler/settings/value.h"
#include "schuler/study/studies.h"
#include "schuler/study/theory/analyze.h"
#include "schuler/study/theory/observability.h"
#include "schuler/study/triad/protection.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::cli {

struct Options {
    std::string command;
    std::string input, second, output, config, format;
    std::string scheme, mechanization, loop, start, stop, self_check;
    std::vector<std::string> outputs;
    std::vector<std::string> outages, set, loose_arguments;
    std::optional<double> settle, output_rate;
    std::optional<std::uint64_t> seed;
    std::string topic, prefix;
    bool manual = false;               ///< of help
    bool response = false;             ///< of gravity
    std::string filter = "mekf";       ///< of ahrs
    bool six_axis = false, offline = false, calibrate = false;
    std::string progress;              ///< "lines": for programs that read standard error
    std::string host = "127.0.0.1", workspace = "out", open;  ///< of ui
    std::optional<int> port;
    int max_upload_mb = 2048;
    bool smooth = false, backward = false, json = false, quiet = false;
    study::EquatorRequest equator;
    study::SchulerRequest schuler;
    study::RequirementsRequest requirements;
    study::StudyRequest study;
    study::ObservabilityRequest observability;
    study::TriadRequest triad;
    study::ProtectionRequest protection;
    app::GenerateRequest generate;
    app::TrackRequest track;
    std::vector<double> misalignment;   ///< three numbers or none
    std::optional<std::size_t> runs;    ///< of a campaign
    int jobs = 0;
    int threads = 0;                    ///< accepted everywhere; the results do not depend on it
};

/// Declares every command with its options, help and examples.
void add_commands(CLI::App& parser, Options& options);

/// How a command is declared: parent, name, purpose, examples.
using AddCommand = std::function<CLI::App*(CLI::App&, const std::string&, const std::string&, const std::string&)>;

/// `ui`.
void add_ui_command(CLI::App& parser, Options& options, const AddCommand& add_command);

/// Serves the page of `ui` until the process is told to end.
void serve_page(const Options& options);

/// `analyze` and its studies; Options::command becomes "analyze equator" and so on.
void add_analyze_command(CLI::App& parser, Options& options, const AddCommand& add_command);

/// -o.
void add_output(CLI::App& app, Options& options, const char* what = "folder to write to (default out/NAME)");
/// --json.
void add_json(CLI::App& app, Options& options, const char* what = "one JSON document");
/// Settings over those of the data set, with the result as JSON: of every command that processes one.
void add_settings(CLI::App& app, Options& options);
/// Loop, outages, what is counted and written, progress: of every command that runs a filter once.
void add_run_options(CLI::App& app, Options& options);

/// `receiver` with `generate` and `track`; Options::command becomes "receiver track" and so on.
void add_receiver_command(CLI::App& parser, Options& options, const AddCommand& add_command);

/// `gravity`.
void add_gravity_command(CLI::App& parser, Options& options, const AddCommand& add_command);

/// The options of process, run and demo as settings of the option table, each with its place on the command line.
/// @throws Error(Input)
[[nodiscard]] settings::SettingList settings_of(const Options& options);

/// " process" if argv names a command: for the hint of an error message.
[[nodiscard]] std::string command_in(int argc, char** argv, const CLI::App& parser);

/// What to say where the first word is no command, with the nearest one; empty where it is one or there is none.
[[nodiscard]] std::string unknown_command(int argc, char** argv, const CLI::App& parser);

}  // namespace schuler::cli
