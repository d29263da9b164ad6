// The studies of the program (`schuler analyze ...`, `schuler receiver ...`) as forms, and the conversion of a form to a run.
#include "schuler/app/command.h"
#include "schuler/core/error.h"
#include "schuler/io/text/split.h"
#include "schuler/report/outputs.h"
#include "schuler/settings/command_line.h"
#include "serve/forms.h"
#include "serve/names.h"
#include "serve/replies.h"
#include "serve/service.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;
using settings::OptionSpec;

bool is_study(const app::Command& command) {
    return command.perform &&
           (command.name.starts_with("analyze ") || command.name.starts_with("receiver ") || command.name == "paper");
}

/// Of signals: made by one study, in the folder of its run, and taken by another.
constexpr const char* recording_file = "recording.ibyte";
bool makes_recording(const app::Command& command) { return command.name == "receiver generate"; }

/// Fields of its form: files are taken from the workspace only.
std::vector<OptionSpec> study_fields(const app::Command& command) {
    std::vector<OptionSpec> out;
    std::ranges::copy_if(command.options, std::back_inserter(out),
                         [](const OptionSpec& s) { return !s.line.file && !s.line.hidden; });
    return out;
}

const OptionSpec* input_of(const app::Command& command) {
    if (makes_recording(command)) return nullptr;
    const auto it = std::ranges::find_if(command.options, [](const OptionSpec& s) { return s.line.positional && s.line.file; });
    return it == command.options.end() ? nullptr : &*it;
}

bool has_option(const app::Command& command, std::string_view key) {
    return std::ranges::find(command.options, key, &OptionSpec::key) != command.options.end();
}

bool takes_recording(const app::Command& command) {
    const OptionSpec* input = input_of(command);
    return input != nullptr && input->line.role == settings::FileRole::Recording;
}

/// What a study works on: the choices that its form offers.
Json accepted_by(const OptionSpec* input) {
    using settings::FileRole;
    const FileRole role = input == nullptr ? FileRole::Any : input->line.role;
    Json out = Json::array();
    if (role == FileRole::Scenario || role == FileRole::DatasetOrScenario) out.push_back("scenario");
    if (role == FileRole::DatasetOrScenario) out.push_back("dataset");
    if (role == FileRole::Recording) out.push_back("recording");
    return out;
}

Json study_json(const app::Command& command) {
    const OptionSpec* input = input_of(command);
    return {{"command", command.name},
            {"purpose", command.purpose},
            {"examples", command.examples},
            {"input", input == nullptr ? Json(nullptr) : Json(input->help)},
            {"accepts", accepted_by(input)},
            {"optional_input", input != nullptr && !input->line.required},
            {"options", schema_of(study_fields(command), command.defaults)}};
}

const app::Command& study_named(const std::string& name) {
    const app::Command* command = app::command_named(name);
    if (command == nullptr || !is_study(*command))
        throw Refusal{422, fmt::format("\"{}\" is not a study", name), "GET /api/studies lists them", "command"};
    return *command;
}

/// A number of the form, or its default.
double number_in(const app::Command& command, const settings::SettingList& given, std::string_view key) {
    const auto s = std::ranges::find(given, key, &settings::Setting::key);
    if (s != given.end()) return s->value.number();
    const auto d = std::ranges::find(command.defaults, key, &settings::Setting::key);
    return d == command.defaults.end() ? 0.0 : d->value.number();
}

/// @throws Refusal 413
void check_recording_size(const app::Command& command, const settings::SettingList& given, std::uintmax_t most) {
    const double bytes = 2.0 * number_in(command, given, "sample-rate") * number_in(command, given, "seconds");
    if (bytes > static_cast<double>(most))
        throw Refusal{413, fmt::format("the recording would have {:.0f} MB, more than {} MB", bytes / 1048576.0, most >> 20),
                      "choose less time or a lower rate, or start the server with a larger --max-upload", "seconds"};
}

/// {run} or {dataset, file}. @throws Refusal
fs::path recording_of(const Workspace& workspace, const Json& order) {
    const Json from = order.value("recording", Json::object());
    const std::string run = from.value("run", ""), dataset = from.value("dataset", "");
    fs::path file;
    if (!run.empty()) file = inside(workspace.run_folder(run), recording_file);
    else if (!dataset.empty()) {
        file = workspace.dataset_folder(dataset);
        for (const std::string& part : io::split(from.value("file", ""), '/')) file = inside(file, part);
    } else
        throw Refusal{422, "the study needs a recording", "send {\"recording\": {\"run\": id}} or {dataset, file}", "recording"};
    if (!fs::is_regular_file(file))
        throw Refusal{422, fmt::format("there is no recording {}", file.filename().string()), "make one with receiver generate",
                      "recording"};
    return file;
}

}  // namespace

Reply Service::start_study(const Json& order) {
    const app::Command& command = study_named(order.value("command", ""));
    const std::vector<OptionSpec> fields = study_fields(command);
    const settings::SettingList given = settings_from_json(order.value("settings", Json::object()), fields);
    std::vector<std::string> words = io::split(command.name, ' ');
    const auto name_words = static_cast<std::ptrdiff_t>(words.size());
    for (const OptionSpec& spec : fields) {  // in their order: some are positional
        const auto s = std::ranges::find(given, spec.key, &settings::Setting::key);
        if (s == given.end()) {
            if (spec.line.required) throw Refusal{422, spec.key + " is missing", spec.help, spec.key};
            continue;
        }
        settings::check_value(spec, s->value, s->place);
        for (std::string& word : settings::words_from_value(spec, s->value)) {
            if (spec.line.positional && word.starts_with('-'))  // would be taken for an option
                throw Refusal{422, fmt::format("\"{}\" cannot be {}", word, spec.key), spec.help, spec.key};
            words.push_back(std::move(word));
        }
    }
    const std::string dataset = order.value("dataset", "");
    const OptionSpec* input = input_of(command);
    if (input != nullptr && !input->line.required && dataset.empty() && !order.contains("scenario")) input = nullptr;
    settings::SettingList scenario;
    fs::path recording;
    if (makes_recording(command)) check_recording_size(command, given, settings_.max_upload);
    if (takes_recording(command)) recording = recording_of(workspace_, order);
    else if (input != nullptr && dataset.empty()) {
        if (!order.contains("scenario"))
            throw Refusal{422, "the study needs a scenario", "send {\"scenario\": {\"toml\": text}}", "scenario"};
        const Json& of = order["scenario"];
        scenario = of.contains("toml") ? settings_from_toml(of["toml"], Form::Scenario)
                                       : settings_from_json(of.value("settings", Json::object()), Form::Scenario);
        check_file_settings(scenario);
    }
    fs::path readable = recording.parent_path();
    if (recording.empty() && input != nullptr && !dataset.empty()) {
        readable = workspace_.dataset_folder(dataset);
        check_dataset(readable);
    }
    const std::string title = order.contains("title") ? order["title"].get<std::string>() : command.name;
    if (title.empty() || title.size() > 200) throw Refusal{422, "a title has 1 to 200 bytes", {}, "title"};
    const std::string id = workspace_.new_run(title, {{"kind", "study"},
                                                      {"command", command.name},
                                                      {"state", "waiting"},
                                                      {"message", ""},
                                                      {"dataset", dataset.empty() ? Json(nullptr) : Json(dataset)}});
    const fs::path folder = workspace_.run_folder(id);
    fs::path file = makes_recording(command) ? folder / recording_file : recording.empty() ? readable : recording;
    if (input != nullptr && recording.empty() && dataset.empty()) {
        file = folder / "scenario.toml";
        report::write_text(file, toml_of(scenario, Form::Scenario));
    }
    // before the options, of which lists take every word that follows
    if (!file.empty()) words.insert(words.begin() + name_words, file.string());
    if (has_option(command, "output")) words.insert(words.end(), {"--output", folder.string()});
    words.push_back("--json");
    if (command.runs) words.insert(words.end(), {"--progress", "lines"});
    JobOrder job;
    job.id = id;
    job.program = settings_.program;
    job.arguments = std::move(words);
    job.keep_output = true;  // becomes summary.json
    job.confinement = confinement(readable, folder);
    jobs_.start(std::move(job));
    return json_reply(run_now(id), 201);
}

void Service::add_study_routes() {
    routes_.push_back(
        {"GET",
         "/api/studies",
         "the studies of `schuler analyze`, `schuler receiver` and `schuler paper`, each with its form",
         {},
         "",
         "[{command, purpose, examples, input: what it works on, or null, accepts: of scenario, dataset, recording, optional_input, options: as /api/options}]",
         [](const Request&) {
             Json out = Json::array();
             for (const app::Command& command : app::commands())
                 if (is_study(command)) out.push_back(study_json(command));
             return json_reply(out);
         }});
    routes_.push_back({"GET",
                       "/api/papers",
                       "the tables and figures of the papers that `schuler paper` computes",
                       {},
                       "",
                       "[{paper, items: [{item, what, page, place, printed_numbers, runs, seconds}]}]",
                       [this](const Request&) {
                           Json out = Json::array();
                           const auto& options = study_named("paper").options;
                           for (const std::string& paper : std::ranges::find(options, "paper", &OptionSpec::key)->choices)
                               out.push_back(asked_of_program("paper", {"paper", paper, "--json"}, {}, {}));
                           return json_reply(out);
                       }});
    routes_.push_back(
        {"POST",
         "/api/studies",
         "starts a study; its JSON document is the summary of the run",
         {},
         "{command, title, settings: {option: value}, scenario: {settings or toml}, or dataset: name, or recording: {run} or {dataset, file}}",
         "201 and the run",
         [this](const Request& r) { return start_study(Json::parse(r.body)); }});
}

}  // namespace schuler::serve
