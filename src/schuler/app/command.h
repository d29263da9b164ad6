// A command of the program: name, options and function. All interfaces (command line, page, documents) are built from the list.
#pragma once

#include "schuler/core/team.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/option_table.h"

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::app {

/// Context supplied to every command by an interface.
struct CommandContext {
    std::string version{};
    std::function<void(double)> progress{};         ///< fraction done; may be empty
    std::function<void(std::string_view)> stage{};  ///< what is being done, as "reading"; may be empty
    int threads = 0;                                ///< limit of simultaneous runs if a request does not set it; 0: one per core
    std::shared_ptr<Team> team{};                   ///< the processes started together with this one; null: none
};

struct Command {
    std::string name;                             ///< "process", "analyze equator"
    std::string purpose;                          ///< one line
    std::string examples;                         ///< terminal lines and notes
    std::vector<settings::OptionSpec> options{};  ///< in the order of the help text, each with its default in `defaults`
    settings::SettingList defaults{};
    std::string json{};  ///< output of --json; empty: not supported
    bool runs = false;   ///< it reports progress
    std::function<report::Outcome(const settings::SettingList&, const CommandContext&)>
        perform{};  ///< empty: a group of commands
};

/// All commands, groups before their members, in the order of the help text.
[[nodiscard]] const std::vector<Command>& commands();

/// Null if there is none of that name.
[[nodiscard]] const Command* command_named(std::string_view name);

}  // namespace schuler::app
