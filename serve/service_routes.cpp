// The routes for data sets, runs and their results.
#include "serve/service.h"

#include "schuler/core/error.h"
#include "schuler/report/outputs.h"
#include "serve/aside.h"
#include "serve/forms.h"
#include "serve/names.h"
#include "serve/replies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

Reply text(std::string body, std::string type = "text/plain; charset=utf-8") {
    Reply reply;
    reply.type = std::move(type);
    reply.body = std::move(body);
    return reply;
}

std::string note_of(const Json& body) {
    constexpr std::size_t longest = 4000;
    const std::string note = body["note"].get<std::string>();
    if (note.size() > longest) throw Refusal{422, fmt::format("a note has at most {} bytes", longest), {}, "note"};
    return note;
}

SeriesRequest series_request(const Request& r) {
    SeriesRequest out;
    const std::string columns = r.asked("columns");
    for (std::size_t begin = 0; begin < columns.size();) {
        const std::size_t end = std::min(columns.find(',', begin), columns.size());
        out.columns.push_back(columns.substr(begin, end - begin));
        begin = end + 1;
    }
    out.from = number_of(r, "from", 0.0);
    out.to = number_of(r, "to", 0.0);
    out.points = points_of(r, 2000);
    return out;
}

std::string type_of(const std::string& name) {
    constexpr std::array<std::pair<std::string_view, const char*>, 8> types{{{".html", "text/html; charset=utf-8"},
                                                                             {".json", "application/json"},
                                                                             {".csv", "text/csv; charset=utf-8"},
                                                                             {".toml", "text/plain; charset=utf-8"},
                                                                             {".txt", "text/plain; charset=utf-8"},
                                                                             {".kml", "application/vnd.google-earth.kml+xml"},
                                                                             {".h5", "application/x-hdf5"},
                                                                             {".svg", "text/plain"}}};
    for (const auto& [ending, type] : types)
        if (name.ends_with(ending)) return type;
    return "application/octet-stream";
}

/// Command for a scenario or data set; empty if the order names no valid command.
std::vector<std::string> words_of(const Json& order, Form form, const std::string& input) {
    const std::string command = order.value("command", "run");
    if (command == "run") return {form == Form::Scenario ? "run" : "process", input};
    if (command == "gravity") return {"gravity", input};
    if (command == "ahrs" && form == Form::Dataset) return {"ahrs", input};
    if (command != "montecarlo" || form != Form::Scenario) return {};
    const int runs = order.value("runs", 100);
    if (runs < 2 || runs > 100'000) throw Refusal{422, "a campaign has 2 to 100000 runs", {}, "runs"};
    return {"montecarlo", input, "-n", fmt::format("{}", runs)};
}

}  // namespace

void Service::check_dataset(const fs::path& folder) const {
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(folder, ec)) {
        const std::string name = entry.path().filename().string();
        if (name == "dataset.toml") check_file_settings(settings_from_toml(text_of(entry.path()), Form::Dataset));
        if (name.ends_with(".yaml") || name.ends_with(".yml")) check_project_text(text_of(entry.path()), name);
    }
}

Json Service::asked_of_program(const std::string& what, std::vector<std::string> arguments, const fs::path& readable,
                               const fs::path& writable, double limit_s, std::size_t limit_bytes) {
    static std::atomic<unsigned> number{0};
    JobOrder order;
    order.id = fmt::format("aside {}", ++number);
    order.program = settings_.program;
    order.arguments = std::move(arguments);
    order.confinement = confinement(readable, writable);
    order.keep_output = order.aside = true;
    order.limit_s = limit_s;
    order.limit_bytes = limit_bytes;
    const std::string id = order.id;
    jobs_.start(std::move(order));
    const JobReport report = jobs_.wait(id);
    jobs_.forget(id);
    if (report.state != JobState::Done)
        throw Refusal{422, report.message.empty() ? "the " + what + " cannot be looked at" : report.message};
    return Json::parse(report.output);
}

Json Service::understood_aside(const Json& body, Form form) {
    static std::atomic<unsigned> number{0};
    const settings::SettingList settings =
        body.contains("toml") ? settings_from_toml(body["toml"], form) : settings_from_json(body.at("settings"), form);
    if (form == Form::Dataset) return understood(settings, form);  // no file is read, nothing is computed
    try {
        check_file_settings(settings);
    } catch (const Refusal& r) {
        return {{"settings", settings_json(settings)},
                {"used", Json::object()},
                {"toml", toml_of(settings, form)},
                {"problem", {{"text", r.text}, {"mend", r.hint}, {"key", r.key}, {"line", r.line}}}};
    }
    const fs::path folder = workspace_.temporary_folder(fmt::format("settings-{}", ++number));
    constexpr double limit_s = 10.0;
    constexpr std::size_t limit_bytes = std::size_t{1} << 30;
    try {
        add_example_files(settings, folder);
        report::write_text(folder / "body.json", body.dump(-1, ' ', false, Json::error_handler_t::replace));
        const Json printed = asked_of_program(
            "scenario", {std::string(aside_word), "understand", std::string(name_of(form)), (folder / "body.json").string()},
            folder, {}, limit_s, limit_bytes);
        workspace_.remove_temporary(folder);
        return understanding_of(printed);
    } catch (...) {
        workspace_.remove_temporary(folder);
        throw;
    }
}

fs::path Service::readable_run(const std::string& id) {
    const fs::path folder = workspace_.run_folder(id), file = folder / "run.h5";
    std::error_code ec;
    if (!fs::is_regular_file(file, ec)) return folder;
    const std::string key =
        fmt::format("{}|{}|{}", file.string(), fs::last_write_time(file, ec).time_since_epoch().count(), fs::file_size(file, ec));
    {
        const std::lock_guard lock(read_mutex_);
        if (read_before_.contains(key)) return folder;
    }
    try {
        (void)asked_of_program("run", {std::string(aside_word), "read", folder.string()}, folder, {});
    } catch (const Refusal&) {
        throw Refusal{422, "run.h5 is damaged", "run it again"};
    }
    const std::lock_guard lock(read_mutex_);
    read_before_.insert(key);
    return folder;
}

Json Service::inspected(const std::string& dataset) {
    const fs::path folder = workspace_.dataset_folder(dataset);
    Json out = asked_of_program("data set", {"inspect", folder.string(), "--json"}, folder, {});
    out["path"] = dataset;
    // a dataset.toml of the user takes precedence; otherwise the inferred one is used
    const std::string own = text_of(folder / "dataset.toml");
    out["own_toml"] = !own.empty();
    try {
        const std::string toml = own.empty() ? out.value("dataset_toml", "") : own;
        out["form"] = understood(settings_from_toml(toml, Form::Dataset), Form::Dataset);
    } catch (const Error& e) {
        out["form"] = {{"settings", Json::object()},
                       {"used", Json::object()},
                       {"toml", own},
                       {"problem", {{"text", e.reason()}, {"mend", e.hint()}, {"key", e.place().key}, {"line", e.place().line}}}};
    }
    return out;
}

void Service::add_dataset_routes() {
    routes_.push_back({"GET",
                       "/api/datasets",
                       "uploaded data sets, and the folder given with --open",
                       {},
                       "",
                       "[{name, title, opened, files: [{name, bytes}]}]",
                       [this](const Request&) { return json_reply(workspace_.datasets()); }});
    routes_.push_back({"POST", "/api/datasets", "a new, empty data set", {}, "{title}", "{name}", [this](const Request& r) {
                           return json_reply({{"name", workspace_.new_dataset(title_of(Json::parse(r.body), "data"))}});
                       }});
    routes_.push_back(
        {"DELETE", "/api/datasets/{dataset}", "removes an uploaded data set", {}, "", "{}", [this](const Request& r) {
             workspace_.remove_dataset(r.parts[0]);
             return json_reply(Json::object());
         }});
    routes_.push_back(
        {"PUT", "/api/datasets/{dataset}/files/{file}", "uploads one file of a data set", {}, "", "{name, bytes}", {}});
    routes_.push_back({"GET",
                       "/api/datasets/{dataset}/inspect",
                       "what is in its files, what is wrong with them, its settings as a form",
                       {},
                       "",
                       "as `schuler inspect --json`, with form: {settings, used, toml, problem}",
                       [this](const Request& r) { return json_reply(inspected(r.parts[0])); }});
}

Reply Service::start_run(const Json& order) {
    const std::string kind = order.value("kind", "scenario"), command = order.value("command", "run");
    if (kind != "scenario" && kind != "dataset") throw Refusal{422, "kind is scenario or dataset", {}, "kind"};
    const Form form = kind == "scenario" ? Form::Scenario : Form::Dataset;
    if (words_of(order, form, {}).empty())
        throw Refusal{422, fmt::format("\"{}\" is nothing to be done with a {}", command, kind),
                      "run and gravity, of a scenario montecarlo and of a data set ahrs are", "command"};
    settings::SettingList settings = order.contains("toml") ? settings_from_toml(order["toml"], form)
                                                            : settings_from_json(order.value("settings", Json::object()), form);
    check_file_settings(settings);
    Json body;
    if (order.contains("toml")) body["toml"] = order["toml"];
    else body["settings"] = order.value("settings", Json::object());
    if (const Json problem = understood_aside(body, form)["problem"]; !problem.is_null())
        throw Refusal{422, problem["text"], problem["mend"], problem["key"], problem["line"]};
    const std::vector<std::string> words =
        argument_words(words_of(order, form, {}).front(), order.value("arguments", Json::object()));
    const std::string dataset = order.value("dataset", "");
    const Json batch = order.value("batch", Json(nullptr));
    if (!batch.is_null() && !batch.is_string()) throw Refusal{422, "batch is the name of one", {}, "batch"};
    fs::path input;
    if (form == Form::Dataset) {
        input = workspace_.dataset_folder(dataset);
        check_dataset(input);
    }
    std::string name = form == Form::Dataset ? dataset : "scenario";
    for (const settings::Setting& s : settings)
        if (s.key == "name" && s.value.text() != nullptr && !s.value.text()->empty()) name = *s.value.text();
    const std::string id = workspace_.new_run(
        title_of(order, name),
        {{"kind", command == "run" ? kind : command},
         {"state", "waiting"},
         {"message", ""},
         // clang-format off
         {"order", {{"command", command}, {"runs", order.value("runs", 0)}, {"arguments", order.value("arguments", Json::object())}}},
         {"dataset", dataset.empty() ? Json(nullptr) : Json(dataset)},
         {"batch", batch}});
    // clang-format on
    const fs::path folder = workspace_.run_folder(id);
    const fs::path file = folder / (form == Form::Scenario ? "scenario.toml" : "settings.toml");
    report::write_text(file, toml_of(settings, form));
    if (form == Form::Scenario) add_example_files(settings, folder);
    JobOrder job;
    job.id = id;
    job.program = settings_.program;
    job.arguments = words_of(order, form, form == Form::Scenario ? file.string() : input.string());
    if (form == Form::Dataset) job.arguments.insert(job.arguments.end(), {"--config", file.string()});
    job.arguments.insert(job.arguments.end(), words.begin(), words.end());
    job.arguments.insert(job.arguments.end(), {"-o", folder.string(), "--progress", "lines"});
    if (order.contains("output_rate_hz") && command == "run")
        job.arguments.insert(job.arguments.end(), {"--output-rate", fmt::format("{}", order["output_rate_hz"].get<double>())});
    job.confinement = confinement(input, folder);
    job.result = folder / "summary.json";
    jobs_.start(std::move(job));
    return json_reply(run_now(id), 201);
}

Json Service::run_now(const std::string& id) const {
    Json run = workspace_.run(id);
    if (const auto job = jobs_.report(id)) {
        run["state"] = name_of(job->state);
        run["progress"] = job->progress;
        run["stage"] = job->stage;
        run["spent_s"] = job->spent_s;
        run["message"] = job->message;
    }
    return run;
}

std::string Service::events_after(std::uint64_t& version) const {
    std::string out;
    for (const JobReport& r : jobs_.changes(version)) {
        const Json event{{"id", r.id},       {"state", name_of(r.state)}, {"progress", r.progress},
                         {"stage", r.stage}, {"spent_s", r.spent_s},      {"message", r.message}};
        out += "event: run\ndata: " + event.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
    }
    return out;
}

void Service::add_run_routes() {
    routes_.push_back(
        {"GET",
         "/api/events",
         "server-sent events \"run\": every change of a run at work",
         {},
         "",
         "text/event-stream of {id, state, progress, stage: reading, simulating, filtering, checking, writing or empty, spent_s: since it was started, message}",
         [this](const Request&) {
             Reply reply;
             reply.type = "text/event-stream";
             reply.events = [this, version = std::uint64_t{0}]() mutable { return events_after(version); };
             return reply;
         }});
    routes_.push_back(
        {"GET",
         "/api/runs",
         "all runs of the workspace, newest first",
         {},
         "",
         "[{id, title, kind, state, message, created, dataset, command, order, batch, note, verdict, scheme, duration_s, error_m, "
         "reference}]",
         [this](const Request&) {
             Json all = workspace_.runs();
             for (Json& run : all) run = run_now(run["id"]);
             return json_reply(all);
         }});
    routes_.push_back(
        {"POST",
         "/api/runs",
         "starts a run",
         {},
         "{kind: scenario or dataset, command: run (default), gravity, ahrs (of a data set) or montecarlo (of a scenario, with runs: how many "
         "seeds), arguments: {option: value} as /api/commands, title, settings: {key: value} or toml: text, dataset: name, output_rate_hz}",
         "201 and the run",
         [this](const Request& r) { return start_run(Json::parse(r.body)); }});
    routes_.push_back(
        {"GET",
         "/api/runs/{run}",
         "one run with its summary",
         {{"channels", "boolean", "1: and with what /channels tells of it"}},
         "",
         "the run with summary (as summary.json) and files; with channels, empty where there are none or it is at work",
         [this](const Request& r) {
             Json run = run_now(r.parts[0]);
             const fs::path folder = workspace_.run_folder(r.parts[0]);
             const Json summary = Json::parse(text_of(folder / "summary.json"), nullptr, false);
             run["summary"] = summary.is_discarded() ? Json(nullptr) : summary;
             Json files = Json::array();
             std::error_code ec;
             for (const auto& entry : fs::directory_iterator(folder, ec)) {
                 const std::string name = entry.path().filename().string();
                 if (entry.is_regular_file(ec) && is_file_name(name) && name != "run.json") files.push_back(name);
             }
             std::sort(files.begin(), files.end());
             run["files"] = files;
             if (r.asked("channels") == "1") {
                 const bool tables = !jobs_.busy(r.parts[0]) && Results::has_tables(folder);
                 run["channels"] = tables ? results_.channels(readable_run(r.parts[0])) : Json::array();
             }
             return json_reply(run);
         }});
    routes_.push_back({"PATCH",
                       "/api/runs/{run}",
                       "gives a run another title or a note",
                       {},
                       "{title, note}, one of them or both",
                       "the run",
                       [this](const Request& r) {
                           const Json body = Json::parse(r.body);
                           Json fields = Json::object();
                           if (body.contains("title") || !body.contains("note")) fields["title"] = title_of(body, "");
                           if (body.contains("note")) fields["note"] = note_of(body);
                           workspace_.note(r.parts[0], fields);
                           return json_reply(run_now(r.parts[0]));
                       }});
    routes_.push_back({"DELETE", "/api/runs/{run}", "removes a run and its files", {}, "", "{}", [this](const Request& r) {
                           if (jobs_.busy(r.parts[0])) throw Refusal{409, "the run is still at work", "cancel it first"};
                           workspace_.remove_run(r.parts[0]);
                           jobs_.forget(r.parts[0]);
                           return json_reply(Json::object());
                       }});
    routes_.push_back({"POST", "/api/runs/{run}/cancel", "ends a run that is at work", {}, "", "{}", [this](const Request& r) {
                           if (!jobs_.cancel(r.parts[0])) throw Refusal{409, "the run is not at work"};
                           return json_reply(Json::object());
                       }});
    routes_.push_back({"GET", "/api/runs/{run}/log", "messages of the program", {}, "", "text", [this](const Request& r) {
                           const fs::path folder = workspace_.run_folder(r.parts[0]);
                           if (const auto job = jobs_.report(r.parts[0])) return text(job->log);
                           return text(text_of(folder / "log.txt"));
                       }});
    routes_.push_back({"GET",
                       "/api/runs/{run}/settings",
                       "the settings that the run was started with, as a form",
                       {},
                       "",
                       "{kind, settings, used, toml, problem, track}",
                       [this](const Request& r) {
                           const fs::path folder = workspace_.run_folder(r.parts[0]);
                           const std::string scenario = text_of(folder / "scenario.toml");
                           const Form form = scenario.empty() ? Form::Dataset : Form::Scenario;
                           const std::string toml = scenario.empty() ? text_of(folder / "settings.toml") : scenario;
                           std::error_code ec;  // no setting of its own is an empty file
                           if (toml.empty() && !fs::is_regular_file(folder / "settings.toml", ec))
                               throw Refusal{404, "this run was not started here: its settings are in config.toml"};
                           Json out = understood_aside({{"toml", toml}}, form);
                           out["kind"] = form == Form::Scenario ? "scenario" : "dataset";
                           return json_reply(out);
                       }});
}

Json Service::noise_of_run(const std::string& run) {
    const fs::path folder = workspace_.run_folder(run);
    std::error_code ec;
    if (fs::is_regular_file(folder / "scenario.toml", ec))
        return asked_of_program("run", {"analyze", "allan", (folder / "scenario.toml").string(), "--json"}, folder, {});
    const Json dataset = workspace_.run(run)["dataset"];
    if (!dataset.is_string() || !fs::is_regular_file(folder / "settings.toml", ec))
        throw Refusal{404, "the IMU log of this run is not known here", "start it from the page, or use `schuler analyze allan`"};
    const fs::path input = workspace_.dataset_folder(dataset);
    check_dataset(input);
    // the settings are in the run's folder, the logs in that of the data set; neither is written
    return asked_of_program(
        "run", {"analyze", "allan", input.string(), "--config", (folder / "settings.toml").string(), "--json"}, input, folder);
}

void Service::add_noise_routes() {
    const std::string answer =
        "as `schuler analyze allan --json`: {name, rate_hz, duration_s, gaps, axes: [{sensor, axis, unit, density_unit, white, "
        "bias_instability, random_walk, ramp, quantization: {value, unit}, allan: {tau_s, deviation, relative_sigma}, spectrum: "
        "{frequency_hz, density}}]}";
    routes_.push_back({"GET",
                       "/api/runs/{run}/noise",
                       "Allan deviations and spectra of the IMU of a run that was started here",
                       {},
                       "",
                       answer,
                       [this](const Request& r) { return json_reply(noise_of_run(r.parts[0])); }});
    routes_.push_back(
        {"GET", "/api/datasets/{dataset}/noise", "the same of a data set's IMU log", {}, "", answer, [this](const Request& r) {
             const fs::path folder = workspace_.dataset_folder(r.parts[0]);
             check_dataset(folder);
             return json_reply(asked_of_program("data set", {"analyze", "allan", folder.string(), "--json"}, folder, {}));
         }});
}

void Service::add_result_routes() {
    const std::vector<Parameter> range{
        {"from", "number", "start of the range, s"},
        {"to", "number", "end of the range, s; left out: everything"},
        {"points", "integer",
         "approximate number of rows, extremes kept (default 2000); 0: every row, or of more than 500000 rows about 20000"}};
    routes_.push_back(
        {"GET",
         "/api/runs/{run}/channels",
         "which columns the run has",
         {},
         "",
         "[{group, rows, start_s, stop_s, columns: [{id, name, unit, names: the meaning of its numbers, where it is a list}]}]",
         [this](const Request& r) { return json_reply(results_.channels(readable_run(r.parts[0]))); }});
    std::vector<Parameter> query{
        {"columns", "string", "ids of /channels with commas, all of one group"},
        {"origin", "string", "run whose first position is the origin of local columns; default: this one"}};
    query.insert(query.end(), range.begin(), range.end());
    routes_.push_back({"GET", "/api/runs/{run}/series", "columns in a range of time, decimated with the extremes kept", query, "",
                       "{rows, thinned, time_s: [], columns: {id: []}, units: {id: unit}}", [this](const Request& r) {
                           const fs::path folder = readable_run(r.parts[0]);
                           const fs::path origin = r.asked("origin").empty() ? folder : readable_run(r.asked("origin"));
                           return text(results_.series(folder, series_request(r), origin), "application/json");
                       }});
    query = {{"with", "string", "the other run"}};
    query.insert(query.end(), range.begin(), range.end());
    routes_.push_back({"GET", "/api/runs/{run}/difference", "this run's solution minus another one's", query, "",
                       "as series: north, east, down in m, velocities in m/s, angles in deg", [this](const Request& r) {
                           return text(
                               results_.difference(readable_run(r.parts[0]), readable_run(r.asked("with")), series_request(r)),
                               "application/json");
                       }});
    routes_.push_back({"GET",
                       "/api/runs/{run}/files/{file}",
                       "one file of the run, as report.html or solution.csv",
                       {{"save", "boolean", "1: to be saved, not shown"}},
                       "",
                       "the file",
                       [this](const Request& r) {
                           const fs::path file = inside(workspace_.run_folder(r.parts[0]), r.parts[1]);
                           std::error_code ec;
                           if (!fs::is_regular_file(file, ec))
                               throw Refusal{404, fmt::format("there is no {} in this run", r.parts[1])};
                           Reply reply;
                           reply.type = type_of(r.parts[1]);
                           reply.file = file;
                           reply.page_of_its_own = true;
                           if (r.asked("save") == "1") reply.download = r.parts[0] + "-" + r.parts[1];
                           return reply;
                       }});
}

}  // namespace schuler::serve
