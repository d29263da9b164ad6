#include "schuler/app/commands/builders.h"

#include <algorithm>

namespace schuler::app {

const std::vector<Command>& commands() {
    static const std::vector<Command> list = [] {
        std::vector<Command> all;
        add_data_commands(all);
        add_live_commands(all);
        add_file_commands(all);
        add_gravity_command(all);
        add_paper_command(all);
        add_receiver_commands(all);
        all.push_back({.name = "analyze",
                       .purpose = "theory and studies: error solutions, modes, requirements, budgets, integrity, noise",
                       .examples = "  schuler analyze equator --paper\n  schuler analyze schuler --tilt-east 1e-3 --time 5064\n"
                                   "`schuler analyze STUDY --help` lists the options of a study."});
        add_theory_commands(all);
        add_study_commands(all);
        return all;
    }();
    return list;
}

const Command* command_named(std::string_view name) {
    const auto it = std::ranges::find(commands(), name, &Command::name);
    return it == commands().end() ? nullptr : &*it;
}

}  // namespace schuler::app
