#include "serve/service.h"

#include "schuler/core/error.h"
#include "schuler/dataset/data_folder.h"
#include "schuler/io/text/split.h"
#include "serve/assets.h"
#include "serve/forms.h"
#include "serve/names.h"
#include "serve/replies.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

/// Matches of the braces in the pattern, or empty if the path does not match.
bool matches(std::string_view pattern, std::string_view path, std::vector<std::string>& parts) {
    const auto wanted = io::split(pattern, '/'), given = io::split(path, '/');
    parts.clear();
    if (wanted.size() != given.size()) return false;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].starts_with('{')) parts.push_back(given[i]);
        else if (wanted[i] != given[i]) return false;
    }
    return true;
}

constexpr std::size_t deepest_folder = 4;

/// Data set, subfolders and file of an upload path; empty if the path does not match.
std::vector<std::string> upload_parts(std::string_view path) {
    std::vector<std::string> parts = io::split(path, '/');  // "", "api", "datasets", NAME, "files", ...
    if (parts.size() < 6 || parts.size() > 6 + deepest_folder || parts[1] != "api" || parts[2] != "datasets" ||
        parts[4] != "files")
        return {};
    parts.erase(parts.begin() + 4);
    parts.erase(parts.begin(), parts.begin() + 3);
    return parts;
}

/// Description of a scenario: its leading comment, up to the command that runs it.
std::string about_of(const std::string& toml) {
    std::string out;
    for (const std::string& line : io::split(toml, '\n')) {
        if (!line.starts_with("# ")) break;
        const std::string text = line.substr(2);
        if (text.starts_with(" ")) break;  // an indented command line
        out += (out.empty() ? "" : " ") + text;
    }
    return out;
}

}  // namespace

Reply refused(const Refusal& r) {
    Reply reply;
    reply.status = r.status;
    const Json error{{"text", r.text}, {"mend", r.hint}, {"key", r.key}, {"line", r.line}};
    reply.body = Json{{"error", error}}.dump(-1, ' ', false, Json::error_handler_t::replace);
    return reply;
}

Service::Service(ServiceSettings settings)
    : settings_(std::move(settings)),
      workspace_(settings_.workspace, settings_.opened),
      jobs_(settings_.runs_at_once > 0 ? settings_.runs_at_once
                                       : std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 4),
            [this](const JobReport& report) { finished(report); }) {
    add_settings_routes();
    add_dataset_routes();
    add_run_routes();
    add_study_routes();
    add_result_routes();
    add_noise_routes();
    add_kept_routes();
    add_batch_routes();
    add_live_routes();
    add_tile_routes();
    if (!workspace_.alone()) return;  // another server is using this folder: active runs are its own
    for (const Json& run : workspace_.runs()) {
        if (run["state"] != "running" && run["state"] != "waiting") continue;
        workspace_.note(run["id"], {{"state", "failed"}, {"message", "the server ended before the run did"}});
    }
}

Reply Service::dispatch(Request& request) {
    bool known_path = false;
    for (const Route& route : routes_) {
        if (!matches(route.path, request.path, request.parts)) continue;
        known_path = true;
        if (route.method == request.method && route.handle) return route.handle(request);
    }
    if (known_path) throw Refusal{405, fmt::format("{} is not possible here", request.method), "/api/openapi.json lists what is"};
    throw Refusal{404, "there is nothing of that name", "/api/openapi.json lists what there is"};
}

Reply Service::answer(Request request) noexcept {
    try {
        try {
            return dispatch(request);
        } catch (const Refusal& r) {
            return refused(r);
        } catch (const Error& e) {
            return refused({422, e.reason(), e.hint(), e.place().key, e.place().line});
        } catch (const nlohmann::json::exception&) {
            return refused({400, "the body is not the JSON that is expected here", "see /api/openapi.json"});
        } catch (const std::bad_alloc&) {
            return refused({507, "out of memory"});
        } catch (const std::exception& e) {
            return refused({500, fmt::format("unexpected failure: {}", e.what())});
        }
    } catch (...) {
        Reply reply;
        reply.status = 500;
        return reply;
    }
}

bool Service::is_upload(const std::string& method, const std::string& path) {
    return method == "PUT" && !upload_parts(path).empty();
}

std::unique_ptr<Upload> Service::upload(const std::string& path, std::uintmax_t length) {
    const std::vector<std::string> parts = upload_parts(path);
    if (parts.empty()) throw Refusal{404, "there is nothing of that name"};
    if (length > settings_.max_upload) {
        throw Refusal{413, fmt::format("larger than {} MB, the most that an upload may have", settings_.max_upload >> 20),
                      "start with --max-upload MB"};
    }
    if (workspace_.is_opened(parts[0])) throw Refusal{403, "the opened folder is yours and is never changed"};
    fs::path folder = workspace_.dataset_folder(parts[0]);
    const std::uintmax_t all = settings_.max_upload * 8, used = workspace_.uploaded_bytes();
    if (used + length >= all) throw Refusal{413, "the workspace is full", "remove data sets that are not needed"};
    for (const std::string& part : parts)  // before the first folder is created
        if (!is_file_name(part))
            throw Refusal{400, "the name cannot be that of a file here", "letters, digits, dots and dashes are always possible"};
    for (std::size_t i = 1; i + 1 < parts.size(); ++i) {
        folder = inside(folder, parts[i]);
        std::error_code ec;
        fs::create_directory(folder, ec);
        if (!fs::is_directory(folder, ec)) throw Refusal{409, fmt::format("{} is a file, not a folder", parts[i])};
    }
    return std::make_unique<Upload>(inside(folder, parts.back()), std::min(settings_.max_upload, all - used));
}

Confinement Service::confinement(const fs::path& readable, const fs::path& writable) const {
    Confinement c;
    const fs::path home = settings_.program.parent_path();
    c.readable = {settings_.program, home / "../share/schuler", dataset::magnetic_model_folder()};
    if (!readable.empty()) c.readable.push_back(readable);
    if (!writable.empty()) c.writable.push_back(writable);
    return c;
}

void Service::finished(const JobReport& report) {
    try {
        if (report.state != JobState::Done) workspace_.clear_results(report.id);
        const fs::path folder = workspace_.run_folder(report.id), summary = folder / "summary.json";
        std::ofstream(folder / "log.txt", std::ios::binary) << report.log;
        std::error_code ec;
        if (report.state == JobState::Done && !report.output.empty() && !fs::exists(summary, ec))
            std::ofstream(summary, std::ios::binary) << report.output;  // printed by a study
        workspace_.note(report.id,
                        {{"state", name_of(report.state)}, {"message", report.message}, {"exit_status", report.exit_status}});
    } catch (const std::exception&) {  // the folder was removed: nothing to record
    } catch (const Refusal&) {}
}

void Service::add_settings_routes() {
    const auto form_of = [](const Request& r) { return r.asked("of", "scenario") == "dataset" ? Form::Dataset : Form::Scenario; };
    const Parameter of{"of", "string", "scenario (default) or dataset"};
    routes_.push_back({"GET", "/api/openapi.json", "this document", {}, "", "OpenAPI 3.1", [=, this](const Request&) {
                           return json_reply(openapi());
                       }});
    routes_.push_back({"GET",
                       "/api/about",
                       "version and limits",
                       {},
                       "",
                       "{version, max_upload, confined, opened, live, tiles: [zoom]}",
                       [=, this](const Request&) {
                           return json_reply({{"version", settings_.version},
                                              {"max_upload", settings_.max_upload},
                                              {"confined", can_confine()},
                                              {"tiles", tile_zooms()},
                                              {"live", settings_.live.empty() ? Json(nullptr) : Json(settings_.live.text())},
                                              {"opened", settings_.opened.empty() ? Json(nullptr)
                                                                                  : Json(settings_.opened.filename().string())}});
                       }});
    routes_.push_back({"GET",
                       "/api/options",
                       "the options of scenario or dataset files, as for a form",
                       {of},
                       "",
                       "[{key, shape, length, low, high, choices, accepts, help, unit, default}]",
                       [=](const Request& r) { return json_reply(form_schema(form_of(r))); }});
    routes_.push_back(
        {"GET", "/api/examples", "scenarios that come with the program", {}, "", "[{name, about, toml}]", [=](const Request&) {
             Json out = Json::array();
             for (const Asset& a : assets()) {
                 if (!a.path.starts_with("/examples/") || !a.path.ends_with(".toml")) continue;
                 const std::string toml(a.bytes);
                 const std::string about = about_of(toml);
                 const std::string file(a.path.substr(10));
                 out.push_back({{"name", file.substr(0, file.rfind('.'))}, {"about", about}, {"toml", toml}});
             }
             return json_reply(out);
         }});
    routes_.push_back({"POST",
                       "/api/settings",
                       "what settings come to: presets applied, TOML, what is wrong, the track of a scenario",
                       {of},
                       "{settings: {key: value}} or {toml: text}",
                       "{settings, used, toml, problem, track}",
                       [=, this](const Request& r) { return json_reply(understood_aside(Json::parse(r.body), form_of(r))); }});
}

void Service::add_live_routes() {
    routes_.push_back({"GET",
                       "/api/live",
                       "messages of the `schuler live` that --live names, as server-sent events",
                       {},
                       "",
                       "text/event-stream of \"live\" (a message of docs/live.md) and \"link\" ({connected, text, address})",
                       [this](const Request&) {
                           if (settings_.live.empty())
                               throw Refusal{404, "no live navigation is shown", "start with --live tcp://HOST:PORT"};
                           Reply reply;
                           reply.type = "text/event-stream";
                           reply.events = [feed = std::make_shared<LiveFeed>(settings_.live)] { return feed->next(); };
                           return reply;
                       }});
}

Json Service::openapi() const {
    Json paths = Json::object();
    for (const Route& route : routes_) {
        Json parameters = Json::array();
        for (const std::string& part : io::split(route.path, '/')) {
            if (!part.starts_with('{')) continue;
            parameters.push_back({{"name", part.substr(1, part.size() - 2)},
                                  {"in", "path"},
                                  {"required", true},
                                  {"schema", {{"type", "string"}}}});
        }
        for (const Parameter& p : route.query)
            parameters.push_back({{"name", p.name}, {"in", "query"}, {"description", p.what}, {"schema", {{"type", p.type}}}});
        Json operation{{"summary", route.summary}, {"parameters", parameters}};
        if (!route.handle) {
            operation["requestBody"] = {
                {"required", true},
                {"content", {{"application/octet-stream", {{"schema", {{"type", "string"}, {"format", "binary"}}}}}}}};
        } else if (!route.body.empty()) {
            operation["requestBody"] = {{"description", route.body},
                                        {"required", true},
                                        {"content", {{"application/json", {{"schema", {{"type", "object"}}}}}}}};
        }
        operation["responses"] = {{"200", {{"description", route.answer}}},
                                  {"default", {{"description", "{error: {text, mend, key, line}}"}}}};
        std::string method = route.method;
        std::ranges::transform(method, method.begin(), [](char c) { return static_cast<char>(c | 0x20); });
        paths[route.path][method] = operation;
    }
    return {{"openapi", "3.1.0"},
            {"info",
             {{"title", "Schuler"},
              {"version", settings_.version},
              {"description", "Requests of the page of `schuler ui` to its server. Times are seconds on the axis of the run."}}},
            {"paths", paths}};
}

}  // namespace schuler::serve
