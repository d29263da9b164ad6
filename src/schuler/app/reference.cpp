#include "schuler/app/command.h"
#include "schuler/app/commands.h"
#include "schuler/live/settings.h"
#include "schuler/settings/command_line.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::app {
namespace {

/// A cell of a table in Markdown.
std::string cell(std::string text) {
    std::string out;
    for (const char c : text) {
        if (c == '|') out += '\\';
        out += c == '\n' ? ' ' : c;
    }
    return out.empty() ? "-" : out;
}

std::string code(const std::string& text) { return text.empty() ? "-" : "`" + cell(text) + "`"; }

std::string range_of(const settings::OptionSpec& spec) {
    if (!spec.choices.empty()) return cell(fmt::format("{}", fmt::join(spec.choices, ", ")));
    return cell(settings::accepted_form(spec));
}

std::string default_of(const settings::OptionSpec& spec, const settings::SettingList& defaults) {
    if (!spec.otherwise.empty()) return cell(spec.otherwise);
    const auto usual = std::ranges::find(defaults, spec.key, &settings::Setting::key);
    if (usual == defaults.end()) return "-";
    return code(usual->value.text() != nullptr ? *usual->value.text() : settings::shown(usual->value));
}

std::string row(const std::string& name, const settings::OptionSpec& spec, const settings::SettingList& defaults) {
    return fmt::format("| {} | {} | {} | {} | {} | {} |\n", code(name), cell(spec.unit), range_of(spec),
                       default_of(spec, defaults), cell(spec.applies), cell(spec.help));
}

constexpr const char* head = "| option | unit | accepts | default | applies | what it is |\n|---|---|---|---|---|---|\n";

std::string name_on_the_line(const settings::OptionSpec& spec) {
    if (spec.line.positional) return spec.line.value_name;
    std::string name = spec.line.letter != 0 ? fmt::format("-{}, --{}", spec.line.letter, spec.key) : "--" + spec.key;
    const std::string value = settings::value_name_of(spec);
    return value.empty() ? name : name + " " + value;
}

std::string of_keys(const std::string& title, const std::vector<settings::OptionSpec>& specs,
                    const settings::SettingList& defaults) {
    std::string out = fmt::format("\n## {}\n\n{}", title, head);
    for (const settings::OptionSpec& spec : specs) out += row(spec.key, spec, defaults);
    return out;
}

}  // namespace

std::string option_reference() {
    std::string out =
        "# Options\n\nMade by `schuler help --reference` of the tables that the program itself uses; a test compares them. Every command has\n"
        "`-q, --quiet`, `--force`, `--threads N` and `--version` besides.\n\n## Commands\n";
    for (const Command& command : commands()) {
        if (!command.perform) continue;
        out += fmt::format("\n### schuler {}\n\n{}\n\n", command.name, command.purpose);
        if (command.options.empty()) continue;
        out += head;
        for (const settings::OptionSpec& spec : command.options) out += row(name_on_the_line(spec), spec, command.defaults);
    }
    out += of_keys("Keys of dataset.toml, --config and --set", settings::config_table().specs(),
                   settings::config_table().used(settings::Config{}));
    out += of_keys("Further keys of the files of `schuler live`", live::live_table().specs(),
                   live::live_table().used(live::LiveSettings{}));
    out += of_keys("Keys of scenario files", settings::scenario_table().specs(),
                   settings::scenario_table().used(settings::ScenarioConfig{}));
    return out;
}

}  // namespace schuler::app
