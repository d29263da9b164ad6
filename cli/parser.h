// The command line: all commands of the program's list with their options, and the commands specific to the command line.
#pragma once

#include "schuler/app/command.h"

#include <CLI/CLI.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace schuler::cli {

/// The options given for one command.
struct Given {
    std::map<std::string, std::string> word;  ///< by key
    std::map<std::string, std::vector<std::string>> words;
    std::map<std::string, bool> flag;
    std::vector<std::string> loose;  ///< arguments without an option
};

/// The parsed command line.
struct CommandLine {
    std::string command;                 ///< "analyze equator"
    std::map<std::string, Given> given;  ///< by command
    bool json = false, quiet = false, force = false;
    int threads = 0;       ///< accepted by every command; the results do not depend on it
    std::string progress;  ///< "lines": for programs that read standard error
    // for help, completion and ui
    std::string topic, prefix;
    bool manual = false, reference = false;
    std::string host = "127.0.0.1", workspace = "out", open, live, tiles;
    std::optional<int> port;
    int max_upload_mb = 2048;
};

/// Declares every command with its options, help and examples.
void add_commands(CLI::App& parser, CommandLine& line);

/// `ui`.
void add_ui_command(CLI::App& parser, CommandLine& line);

/// A command below `parent`, declared as all others: with examples and the options common to all commands.
CLI::App* add_command(CLI::App& parent, CommandLine& line, const std::string& name, const std::string& purpose,
                      const std::string& examples);

/// Serves the page of `ui` until the process is terminated.
void serve_page(const CommandLine& line);

/// The given options of the command, as settings of its table, each with its place on the command line.
/// @throws Error(Input) for an unexpected argument.
[[nodiscard]] settings::SettingList settings_of(const app::Command& command, const CommandLine& line, const CLI::App& parser);

/// " process" if argv names a command: for the hint of an error message.
[[nodiscard]] std::string command_in(int argc, char** argv, const CLI::App& parser);

/// Error text if the first word is not a command, with the nearest one; empty if it is, or if there is no word.
[[nodiscard]] std::string unknown_command(int argc, char** argv, const CLI::App& parser);

/// The same for the word after `help`.
[[nodiscard]] std::string unknown_topic(int argc, char** argv, const CLI::App& parser);

}  // namespace schuler::cli
