// A command of the program: its name, its options, its function. Every door (command line, page, documents) is made of the list.
#pragma once

#include "schuler/core/team.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/option_table.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace schuler::app {

/// What a door gives every command.
struct CommandContext {
    std::string version{};
    std::function<void(double)> progress{};  ///< share done; may be empty
    int threads = 0;                         ///< at most so many runs at once where a request leaves it open; 0: one a core
    std::shared_ptr<Team> team{};            ///< the processes that this one is started with; null: it is alone
};

struct Command {
    std::string name;                             ///< "process", "analyze equator"
    std::string purpose;                          ///< one line
    std::string examples;                         ///< lines of a terminal, and notes
    std::vector<settings::OptionSpec> options{};  ///< in the order of help, each with its default in `defaults`
    settings::SettingList defaults{};
    std::string json{};  ///< what --json prints; empty: there is none
    bool runs = false;   ///< it shows how far it is
    std::function<report::Outcome(const settings::SettingList&, const CommandContext&)>
        perform{};  ///< empty: a group of commands
};

/// All of them, groups before their members, in the order of help.
[[nodiscard]] const std::vector<Command>& commands();

/// Null where there is none of that name.
[[nodiscard]] const Command* command_named(std::string_view name);

}  // namespace schuler::app
