#include "serve/aside.h"

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/table.h"
#include "schuler/report/decimate.h"
#include "serve/message.h"
#include "serve/results.h"

#include <fmt/format.h>

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
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

/// The columns of a log unchanged, decimated for drawing; times from the first row on.
Json raw_columns(const fs::path& file) {
    constexpr std::size_t most_columns = 60, most_points = 3000;
    WarningLog warnings;
    io::LogFiles files;
    const io::TextInput input = files.open(file, warnings);
    const io::TableLayout layout = io::inspect_table(input);
    std::vector<io::FieldRequest> fields;
    for (int c = 0; c < layout.columns && fields.size() < most_columns; ++c) {
        io::FieldRequest field;
        field.column = c;
        field.name = static_cast<std::size_t>(c) < layout.names.size() ? layout.names[static_cast<std::size_t>(c)]
                                                                       : fmt::format("column {}", c + 1);
        fields.push_back(field);
    }
    std::vector<std::vector<double>> values(fields.size());
    io::TableReader reader(input, layout, fields);
    while (reader.next())
        for (std::size_t c = 0; c < fields.size(); ++c) values[c].push_back(reader.number(c));
    const auto time =
        std::ranges::find_if(fields, [](const io::FieldRequest& f) { return f.name.find("time") != std::string::npos; });
    const std::size_t t = time == fields.end() ? 0 : static_cast<std::size_t>(time - fields.begin());
    const std::size_t rows = values.empty() ? 0 : values.front().size();
    const double zero = rows > 0 && std::isfinite(values[t].front()) ? values[t].front() : 0.0;
    std::vector<std::span<const double>> channels;
    for (const auto& v : values)
        if (std::ranges::all_of(v, [](double x) { return std::isfinite(x); })) channels.emplace_back(v);
    std::vector<std::size_t> chosen;
    if (channels.empty() || rows <= most_points)
        for (std::size_t r = 0; r < rows; r += std::max<std::size_t>(1, rows / most_points)) chosen.push_back(r);
    else chosen = report::decimate(channels, most_points * 2);
    Json out{{"rows", rows},
             {"zero", zero},
             {"time", rows > 0 ? fields[t].name : ""},
             {"time_s", Json::array()},
             {"columns", Json::object()}};
    for (const std::size_t r : chosen) out["time_s"].push_back(values[t][r] - zero);
    for (std::size_t c = 0; c < fields.size(); ++c) {
        if (c == t) continue;
        Json column = Json::array();
        for (const std::size_t r : chosen) column.push_back(std::isfinite(values[c][r]) ? Json(values[c][r]) : Json(nullptr));
        out["columns"][fields[c].name] = std::move(column);
    }
    return out;
}

}  // namespace

std::string_view name_of(Form form) { return form == Form::Dataset ? "dataset" : "scenario"; }

int aside(int count, const char* const* arguments) noexcept {
    try {
        const std::string_view task = count > 0 ? arguments[0] : "";
        Json out;
        if (task == "understand" && count == 3) out = understand(arguments[1], fs::absolute(arguments[2]));
        else if (task == "read" && count == 2) out = read_all(arguments[1]);
        else if (task == "raw" && count == 2) out = raw_columns(arguments[1]);
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
