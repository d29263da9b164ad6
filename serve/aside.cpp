#include "serve/aside.h"

#include "schuler/core/error.h"
#include "serve/message.h"
#include "serve/raw_log.h"
#include "serve/results.h"

#include <fmt/format.h>

#include <malloc.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

Json refusal_json(const Refusal& r) {
    return {{"refusal", {{"status", r.status}, {"text", r.text}, {"mend", r.hint}, {"key", r.key}, {"line", r.line}}}};
}

Json understand(const std::string& form_name, const fs::path& file) {
    std::stringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    fs::current_path(file.parent_path());  // base of file names in the settings
    const Form form = form_name == name_of(Form::Dataset) ? Form::Dataset : Form::Scenario;
    try {
        const Json body = Json::parse(text.str());
        return {{"answer", understood(body.contains("toml") ? settings_from_toml(body["toml"], form)
                                                            : settings_from_json(body.at("settings"), form),
                                      form)}};
    } catch (const Refusal& r) {
        return refusal_json(r);
    } catch (const Error& e) {
        return refusal_json({422, e.reason(), e.hint(), e.place().key, e.place().line});
    } catch (const nlohmann::json::exception&) {
        return refusal_json({400, "the body is not the JSON that is expected here", "see /api/openapi.json"});
    }
}

Json read_all(const fs::path& folder) {
    // memory of one table is that of the next: most of the time would go into fresh pages
    constexpr int never = 1 << 30;
    mallopt(M_MMAP_THRESHOLD, never);
    mallopt(M_TRIM_THRESHOLD, never);
    Results().read_all(folder);
    return {{"read", true}};
}

/// "0 600 3000": range and number of points of a request.
RawRequest raw_request(const char* file, const char* from, const char* to, const char* points) {
    return {file, std::strtod(from, nullptr), std::strtod(to, nullptr),
            static_cast<std::size_t>(std::strtoul(points, nullptr, 10))};
}

}  // namespace

std::string_view name_of(Form form) { return form == Form::Dataset ? "dataset" : "scenario"; }

int aside(int count, const char* const* arguments) noexcept {
    try {
        const std::string_view task = count > 0 ? arguments[0] : "";
        Json out;
        if (task == "understand" && count == 3) out = understand(arguments[1], fs::absolute(arguments[2]));
        else if (task == "read" && count == 2) out = read_all(arguments[1]);
        else if (task == "raw" && count == 5)
            out = raw_columns(raw_request(arguments[1], arguments[2], arguments[3], arguments[4]));
        else return 2;
        fmt::print("{}\n", out.dump(-1, ' ', false, Json::error_handler_t::replace));
        return std::fflush(stdout) == 0 ? 0 : 1;
    } catch (const Refusal& r) {
        fmt::print(stderr, "schuler: {}\n", r.text);
    } catch (const std::exception& e) {
        fmt::print(stderr, "schuler: {}\n", e.what());
    } catch (...) {
        fmt::print(stderr, "schuler: unexpected failure\n");
    }
    return 1;
}

Json understanding_of(const Json& printed) {
    if (!printed.contains("refusal")) return printed.at("answer");
    const Json& r = printed["refusal"];
    throw Refusal{r["status"].get<int>(), r["text"].get<std::string>(), r["mend"].get<std::string>(), r["key"].get<std::string>(),
                  r["line"].get<long>()};
}

}  // namespace schuler::serve
