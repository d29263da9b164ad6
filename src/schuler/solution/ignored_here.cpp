#include "schuler/solution/ignored_here.h"

#include <algorithm>
#include <string>

namespace schuler::solution {
namespace {

bool is_typed(const settings::SettingList& list, const std::string& key) {
    return std::ranges::find(list, key, &settings::Setting::key) != list.end();
}

}  // namespace

void add_unmade_check(std::vector<Ignored>& ignored, const settings::SettingList& command_line) {
    const std::string key = "filter.self_check";
    if (is_typed(command_line, key) && std::ranges::find(ignored, key, &Ignored::key) == ignored.end())
        ignored.push_back({key, "it belongs to `schuler process`"});
}

void warn_of_ignored_here(const std::vector<Ignored>& ignored, const settings::SettingList& command_line, WarningLog& warnings) {
    std::vector<Ignored> others;
    for (const Ignored& i : ignored) {
        if (is_typed(command_line, i.key)) warn_of_ignored({i}, warnings);  // a line each: none is shortened to "and N more"
        else others.push_back(i);
    }
    warn_of_ignored(others, warnings);
}

}  // namespace schuler::solution
