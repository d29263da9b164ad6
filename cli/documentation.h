// Shell completion and manual page, generated from the same declarations as the help.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace schuler::cli {

/// `help COMMAND...` as `COMMAND... --help`, and `help` alone as `--help`; other command lines unchanged. Without the program's name.
[[nodiscard]] std::vector<std::string> with_help_of_commands(std::vector<std::string> arguments, const CLI::App& parser);

/// A completion function for `shell`, bash or zsh: commands, options and their permitted words; file names elsewhere.
[[nodiscard]] std::string completion_script(const CLI::App& parser, const std::string& shell);

/// The manual page in man(7) macros: every command with its options and examples.
[[nodiscard]] std::string manual_page(const CLI::App& parser, const std::string& version);

}  // namespace schuler::cli
