// What the program says about itself to a shell and to man, made of the same declarations as its help.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace schuler::cli {

/// `help COMMAND...` as `COMMAND... --help`, and `help` alone as `--help`; other command lines as they are. Without the program's name.
[[nodiscard]] std::vector<std::string> with_help_of_commands(std::vector<std::string> arguments, const CLI::App& parser);

/// A completion function for `shell`, bash or zsh: commands, options and the words an option is chosen from; file names elsewhere.
[[nodiscard]] std::string completion_script(const CLI::App& parser, const std::string& shell);

/// The manual page in the macros of man(7): every command with its options and examples.
[[nodiscard]] std::string manual_page(const CLI::App& parser, const std::string& version);

}  // namespace schuler::cli
