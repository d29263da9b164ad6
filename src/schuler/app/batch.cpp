#include "schuler/app/batch.h"

#include "schuler/app/commands.h"
#include "schuler/core/parallel.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outputs.h"
#include "schuler/report/report.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <tuple>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;
using report::Json;

constexpr const char* entry_file = "batch.json";  ///< in the folder of each completed data set

/// A data set of the batch and its result.
struct Entry {
    fs::path input;
    std::string name;  ///< of its folder
    std::string failure;
    std::string verdict;  ///< empty if it failed
    std::vector<std::string> reasons;
    Json numbers = Json::object();

    [[nodiscard]] int rank() const { return !failure.empty() ? 0 : verdict == "do not use" ? 1 : verdict == "care" ? 2 : 3; }
    [[nodiscard]] double number(const std::string& key) const {
        const auto it = numbers.find(key);
        return it != numbers.end() && it->is_number() ? it->get<double>() : std::nan("");
    }
};

struct Column {
    report::TableColumn column;
    const char* pointer;  ///< into summary.json
};
const std::array columns{Column{{"duration_s", "duration", "s"}, "/duration_s"},
                         Column{{"horizontal_rms_m", "horizontal, rms", "m"}, "/errors/position_m/horizontal/rms"},
                         Column{{"horizontal_max_m", "largest", "m"}, "/errors/position_m/horizontal/max"},
                         Column{{"heading_rms_deg", "heading, rms", "deg"}, "/errors/attitude_deg/heading/rms"},
                         Column{{"self_check_rms_m", "self-check", "m"}, "/self_check/end_rms_m"},
                         Column{{"gnss_rejected", "fixes rejected", "", ".4g"}, "/gnss/rejected"}};

bool is_list(const fs::path& path) {
    return fs::is_regular_file(path) &&
           (path.extension() == ".txt" || path.extension() == ".list" || path.extension() == ".lst" || !path.has_extension());
}

void add_from_list(const fs::path& list, std::vector<fs::path>& out) {
    std::ifstream in(list);
    long number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
        const std::size_t begin = line.find_first_not_of(" \t");
        if (begin == std::string::npos || line[begin] == '#') continue;
        const fs::path path = line.substr(begin);
        const fs::path whole = path.is_absolute() ? path : list.parent_path() / path;
        if (line.find('\0') != std::string::npos)
            throw input_error("is no text", {.file = list.string(), .line = number},
                              "give a text file with the path of a data set in each line");
        out.push_back(whole.lexically_normal());
    }
}

/// A folder is one data set if it has a dataset.toml or any file; a folder that contains only folders has one in each.
void add_from_folder(const fs::path& folder, std::vector<fs::path>& out) {
    std::vector<fs::path> inner;
    bool file = false;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entry.path().filename().string().starts_with(".")) continue;
        if (entry.is_directory()) inner.push_back(entry.path());
        if (entry.is_regular_file()) file = true;
    }
    if (file || inner.empty()) {
        out.push_back(folder);
        return;
    }
    std::ranges::sort(inner);
    out.insert(out.end(), inner.begin(), inner.end());
}

std::vector<Entry> entries_of(const std::vector<std::string>& inputs) {
    std::vector<fs::path> paths;
    for (const std::string& text : inputs) {
        const fs::path path = text;
        std::error_code ec;
        if (!fs::exists(path, ec))
            throw input_error("does not exist", {.file = text}, "give a list of data sets, data sets, or a folder of them");
        if (fs::is_directory(path)) {
            add_from_folder(path, paths);
        } else if (is_list(path)) {
            add_from_list(path, paths);
        } else {
            paths.push_back(path);
        }
    }
    if (paths.empty())
        throw input_error("there is no data set in it", {.file = inputs.front()},
                          "give a text file with the path of a data set in each line");
    std::vector<Entry> out;
    std::map<std::string, int> taken;
    std::set<fs::path> seen;
    for (const fs::path& path : paths) {
        if (!seen.insert(fs::weakly_canonical(path)).second) continue;  // named twice
        Entry& entry = out.emplace_back();
        entry.input = path;
        fs::path named = path.filename().empty() ? path.parent_path() : path;
        if (named.filename() == "dataset.toml") named = named.parent_path();
        entry.name = fs::is_directory(named) ? named.filename().string() : named.stem().string();
        if (entry.name.empty() || entry.name == "." || entry.name == "..") entry.name = "data";
        if (const int n = ++taken[entry.name]; n > 1) entry.name += fmt::format("-{}", n);
    }
    return out;
}

/// Identifies the input of an entry: if it differs the entry is reprocessed.
std::string identity_of(const Entry& entry, const settings::ProcessRequest& common) {
    std::string out = common.version + "\n" + fs::weakly_canonical(entry.input).string() + "\n";
    for (const settings::Setting& s : common.over({})) out += s.key + " = " + settings::to_toml(s.value) + "\n";
    return out;
}

Json json_of(const Entry& e) {
    Json out{{"name", e.name}, {"input", e.input.string()}, {"verdict", e.failure.empty() ? Json(e.verdict) : Json("failed")}};
    for (const Column& c : columns)
        out[c.column.key] = e.numbers.contains(c.column.key) ? e.numbers[c.column.key] : Json(nullptr);
    out["reasons"] = e.reasons;
    out["failure"] = e.failure.empty() ? Json(nullptr) : Json(e.failure);
    return out;
}

void take_summary(Entry& e, const std::string& json) {
    const Json summary = Json::parse(json);
    for (const Column& c : columns) {
        const Json::json_pointer pointer(c.pointer);
        e.numbers[c.column.key] = summary.contains(pointer) ? summary[pointer] : Json(nullptr);
    }
    if (const auto it = summary.find("verdict"); it != summary.end() && it->is_object()) {
        e.verdict = it->value("word", "");
        e.reasons = it->value("reasons", std::vector<std::string>{});
    }
}

/// Reads the results of an earlier batch; false if there are none.
bool taken_up(Entry& e, const fs::path& folder, const std::string& identity) {
    std::ifstream in(folder / entry_file);
    if (!in) return false;
    const Json kept = Json::parse(in, nullptr, false);
    if (kept.is_discarded() || kept.value("identity", "") != identity || !kept.contains("entry")) return false;
    const Json& entry = kept["entry"];
    e.verdict = entry.value("verdict", "");
    e.reasons = entry.value("reasons", std::vector<std::string>{});
    for (const Column& c : columns)
        if (entry.contains(c.column.key)) e.numbers[c.column.key] = entry[c.column.key];
    return true;
}

void process_entry(Entry& e, const BatchRequest& request, const fs::path& folder) {
    const std::string identity = identity_of(e, request.common);
    if (request.resume && taken_up(e, folder, identity)) return;
    settings::ProcessRequest one = request.common;
    one.input = e.input;
    one.output = folder;
    one.progress = {};
    one.stage = {};
    try {
        take_summary(e, process_dataset(one).json);
        report::write_text(folder / entry_file, report::text_of(Json{{"identity", identity}, {"entry", json_of(e)}}));
    } catch (const Error& error) {
        e.failure = error.what();
    } catch (const std::bad_alloc&) {
        e.failure = "out of memory; process a part of it with --start and --stop";
    }
}

/// A path as part of a link.
std::string link_to(const std::string& name) {
    std::string out;
    for (const char c : name)
        out += std::isalnum(static_cast<unsigned char>(c)) || std::string_view("-_.").find(c) != std::string_view::npos
                   ? std::string(1, c)
                   : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return out;
}

/// For display, and batch.csv.
report::ResultTable table_of(const std::vector<Entry>& entries) {
    report::ResultTable table{"", {{"name", "data set, worst first"}, {"verdict", "verdict"}}};
    for (const Column& c : columns) table.columns.push_back(c.column);
    table.columns.insert(table.columns.end(), {{"input", ""}, {"why", ""}, {"", "why"}});
    for (const Entry& e : entries) {
        const std::string why = !e.failure.empty() ? e.failure : e.reasons.empty() ? "" : e.reasons.front();
        const char* word = !e.failure.empty() ? "failed" : e.verdict.empty() ? "-" : e.verdict.c_str();
        std::vector<report::Cell>& row = table.rows.emplace_back(std::vector<report::Cell>{e.name, word});
        for (const Column& c : columns) row.emplace_back(e.number(c.column.key));
        row.insert(row.end(), {e.input.string(), why, e.rank() < 3 ? why : ""});
    }
    return table;
}

/// The same as a page, with names linked to the reports.
std::string page_of(const std::vector<Entry>& entries, const fs::path& folder, const std::string& version) {
    report::ReportInput page{"Batch", fmt::format("{} data sets, worst first", entries.size())};
    page.version = version;
    report::TableBlock block = report::table_block(table_of(entries));
    for (const Entry& e : entries)
        block.links.push_back(e.failure.empty() && fs::exists(folder / e.name / "report.html") ? link_to(e.name) + "/report.html"
                                                                                               : std::string());
    page.sections.push_back({"Data sets", "", {{"", {}, {std::move(block)}}}});
    return report::render(page);
}

}  // namespace

report::Outcome process_batch(const BatchRequest& request) {
    std::vector<Entry> entries = entries_of(request.inputs);
    report::Outcome out;
    out.folder = request.common.output.empty() ? fs::path("out/batch") : request.common.output;
    report::make_folder(out.folder);
    report::write_text(out.folder / "batch.csv",
                       report::table_csv(table_of({})));  // an unwritable folder is detected before the work
    for_each_run(
        entries.size(), request.jobs, [&](std::size_t k) { process_entry(entries[k], request, out.folder / entries[k].name); },
        request.common.progress);
    // Worst first: by the verdict, then by the errors, or the data set's own consistency.
    const auto badness = [](const Entry& e) {
        for (const char* key : {"horizontal_rms_m", "self_check_rms_m"})
            if (std::isfinite(e.number(key))) return e.number(key);
        return 0.0;
    };
    std::ranges::stable_sort(entries, [&](const Entry& a, const Entry& b) {
        return std::tuple(a.rank(), -badness(a), a.name) < std::tuple(b.rank(), -badness(b), b.name);
    });
    Json list = Json::array();
    std::size_t failed = 0, unusable = 0;
    for (const Entry& e : entries) {
        list.push_back(json_of(e));
        failed += e.rank() == 0 ? 1 : 0;
        unusable += e.rank() == 1 ? 1 : 0;
        if (!e.failure.empty()) out.warnings.push_back(fmt::format("{}: {}", e.name, e.failure));
    }
    out.json = report::text_of(Json{{"datasets", entries.size()}, {"failed", failed}, {"do_not_use", unusable}, {"rows", list}});
    out.tables = report::table_text(table_of(entries));
    for (const auto& [name, text] : {std::pair{"batch.csv", report::table_csv(table_of(entries))},
                                     {"batch.json", out.json},
                                     {"index.html", page_of(entries, out.folder, request.common.version)}})
        report::write_text(out.files.emplace_back(out.folder / name), text);
    out.usable = failed + unusable == 0;
    out.verdict = fmt::format("{} data sets: {} failed, {} rejected (verdict: do not use)", entries.size(), failed, unusable);
    return out;
}

}  // namespace schuler::app
