// The command line: every command of the program's list with its options, and the commands that are the door's own.
#pragma once

#include "schuler/app/command.h"

#include <CLI/CLI.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace schuler::cli {

/// What was said of one command's options.
struct Given {
    std::map<std::string, std::string> word;  ///< by key
    std::map<std::string, std::vector<std::string>> words;
    std::map<std::string, bool> flag;
    std::vector<std::string> loose;  ///< arguments of no option
};

/// What the command line says.
struct CommandLine {
    std::string command;                 ///< "analyze equator"
    std::map<std::string, Given> given;  ///< by command
    bool json = false, quiet = false, force = false;
    int threads = 0;       ///< accepted everywhere; the results do not depend on it
    std::string progress;  ///< "lines": for programs that read standard error
    // of help, completion and ui
    std::string topic, prefix;
    bool manual = false, reference = false;
    std::string host = "127.0.0.1", workspace = "out", open;
    std::optional<int> port;
    int max_upload_mb = 2048;
};

/// Declares every command with its options, help and examples.
void add_commands(CLI::App& parser, CommandLine& line);

/// `ui`.
void add_ui_command(CLI::App& parser, CommandLine& line);

/// A command below `parent` as all are declared: with examples and with the options of every command.
CLI::App* add_command(CLI::App& parent, CommandLine& line, const std::string& name, const std::string& purpose,
                      const std::string& examples);

/// Serves the page of `ui` until the process is told to end.
void serve_page(const CommandLine& line);

/// The options of the command that was given, as settings of its table, each with its place on the command line.
/// @throws Error(Input) for an argument that belongs to nothing.
[[nodiscard]] settings::SettingList settings_of(const app::Command& command, const CommandLine& line, const CLI::App& parser);

/// " process" if argv names a command: for the hint of an error message.
[[nodiscard]] std::string command_in(int argc, char** argv, const CLI::App& parser);

/// What to report where the first word is no command, with the nearest one; empty where it is one or there is none.
[[nodiscard]] std::string unknown_command(int argc, char** argv, const CLI::App& parser);

/// The same of the word after `help`.
[[nodiscard]] std::string unknown_topic(int argc, char** argv, const CLI::App& parser);

}  // namespace schuler::cli
