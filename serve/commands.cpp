// The commands that create runs of scenarios and data sets, as forms; and the layouts saved by the page.
#include "schuler/app/command.h"
#include "schuler/io/text/split.h"
#include "schuler/report/outputs.h"
#include "schuler/settings/command_line.h"
#include "serve/aside.h"
#include "serve/assets.h"
#include "serve/forms.h"
#include "serve/names.h"
#include "serve/replies.h"
#include "serve/service.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;
using settings::OptionSpec;

constexpr std::array run_commands{"process", "run", "ahrs", "gravity", "montecarlo"};

/// Options set by the server itself, and options replaced by settings.
constexpr std::array not_asked{"output", "outputs", "progress", "json", "set", "config", "force", "settings_file"};

std::vector<OptionSpec> fields_of(const app::Command& command) {
    std::vector<OptionSpec> out;
    std::ranges::copy_if(command.options, std::back_inserter(out), [](const OptionSpec& s) {
        return !s.line.file && !s.line.hidden && !s.line.positional && std::ranges::find(not_asked, s.key) == not_asked.end();
    });
    return out;
}

/// Also within lists and tables: gravity fields are tables.
bool mentions(const settings::Value& value, const std::string& name) {
    if (value.text() != nullptr) return *value.text() == name;
    if (const auto* list = value.list())
        return std::ranges::any_of(*list, [&](const settings::Value& v) { return mentions(v, name); });
    if (const auto* table = value.table())
        return std::ranges::any_of(*table, [&](const auto& entry) { return mentions(entry.second, name); });
    return false;
}

}  // namespace

std::vector<std::string> argument_words(const std::string& command_name, const Json& arguments) {
    std::vector<std::string> words;
    if (arguments.is_null() || arguments.empty()) return words;
    const app::Command* command = app::command_named(command_name);
    if (command == nullptr) throw Refusal{422, fmt::format("\"{}\" has no options here", command_name), {}, "arguments"};
    const std::vector<OptionSpec> fields = fields_of(*command);
    for (const settings::Setting& s : settings_from_json(arguments, fields)) {
        const OptionSpec& spec = *std::ranges::find(fields, s.key, &OptionSpec::key);
        settings::check_value(spec, s.value, s.place);
        for (std::string& word : settings::words_from_value(spec, s.value)) words.push_back(std::move(word));
    }
    return words;
}

void add_example_files(const settings::SettingList& settings, const std::filesystem::path& folder) {
    for (const Asset& a : assets()) {
        if (!a.path.starts_with("/examples/") || a.path.ends_with(".toml")) continue;
        const std::string name(a.path.substr(a.path.rfind('/') + 1));
        const bool named = std::ranges::any_of(settings, [&](const settings::Setting& s) { return mentions(s.value, name); });
        if (named) report::write_text(folder / name, std::string(a.bytes));
    }
}

void Service::add_kept_routes() {
    routes_.push_back({"GET",
                       "/api/commands",
                       "what can be done with a scenario or a data set, each with the form of its options",
                       {},
                       "",
                       "[{command, purpose, examples, options: as /api/options}]",
                       [=](const Request&) {
                           Json out = Json::array();
                           for (const char* name : run_commands) {
                               const app::Command* command = app::command_named(name);
                               if (command == nullptr) continue;
                               out.push_back({{"command", command->name},
                                              {"purpose", command->purpose},
                                              {"examples", command->examples},
                                              {"options", schema_of(fields_of(*command), command->defaults)}});
                           }
                           return json_reply(out);
                       }});
    routes_.push_back({"GET",
                       "/api/datasets/{dataset}/raw",
                       "the columns of one of its logs before anything is processed, decimated",
                       {{"file", "string", "its path as in inspect, also of one instrument of a log: log.ulg#imu"},
                        {"from", "number", "start of the range, s after the first row"},
                        {"to", "number", "end of the range; left out: everything"},
                        {"points", "integer",
                         "approximate number of rows, extremes kept (default 3000); 0: every row, at most 2 million numbers"}},
                       "",
                       "{rows, thinned, zero, time, time_s, columns: {name: []}, units: {name: unit}}",
                       [=, this](const Request& r) {
                           const fs::path folder = workspace_.dataset_folder(r.parts[0]);
                           const std::string given = r.asked("file");
                           const std::size_t mark = given.find('#');
                           fs::path file = folder;
                           for (const std::string& part : io::split(given.substr(0, mark), '/')) file = inside(file, part);
                           if (mark != std::string::npos) file += given.substr(mark);
                           return json_reply(asked_of_program(
                               "log",
                               {std::string(aside_word), "raw", file.string(), fmt::format("{}", number_of(r, "from", 0.0)),
                                fmt::format("{}", number_of(r, "to", 0.0)), fmt::format("{}", points_of(r, 3000))},
                               folder, {}, 60.0));
                       }});
    routes_.push_back({"GET",
                       "/api/layouts",
                       "the layouts of plots that are kept in the workspace",
                       {},
                       "",
                       "{name: layout}, or null",
                       [=, this](const Request&) { return json_reply(workspace_.kept()); }});
    routes_.push_back({"PUT",
                       "/api/layouts",
                       "keeps layouts of plots in the workspace",
                       {},
                       "{name: layout}, at most 1 MB",
                       "{}",
                       [=, this](const Request& r) {
                           const Json given = Json::parse(r.body);
                           if (!given.is_object()) throw Refusal{422, "layouts are an object of names and layouts"};
                           if (r.body.size() > (1u << 20)) throw Refusal{413, "the layouts are larger than 1 MB", "remove some"};
                           workspace_.keep(given);
                           return json_reply(Json::object());
                       }});
}

}  // namespace schuler::serve
