#include "schuler/app/dataset.h"

#include "schuler/app/facts.h"
#include "schuler/app/kfgins_settings.h"
#include "schuler/app/toml_file.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/kfgins.h"

#include <algorithm>
#include <cstdlib>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

std::string name_of(const fs::path& path) {
    fs::path p = path.lexically_normal();
    if (p.filename().empty()) p = p.parent_path();
    if (p.filename() == "." || p.filename() == ".." || p.filename().empty()) {
        std::error_code ec;
        p = fs::absolute(p, ec).lexically_normal();
        if (p.filename().empty()) p = p.parent_path();
    }
    return p.stem().empty() ? std::string("dataset") : p.stem().string();
}

std::set<std::string> keys_of(const SettingList& settings) {
    std::set<std::string> keys;
    for (const Setting& s : settings) keys.insert(s.key);
    return keys;
}

/// Finds what `given` leaves open and puts it below.
void resolve(Dataset& d, const fs::path& path, Needs needs, const SettingList& given, bool may_find_aids) {
    const Config said = config_from(given);
    inspect::Given g = given_of(said, given, d.folder);
    g.find_aids = may_find_aids;
    g.weighs_field = needs == Needs::Attitude;
    if (said.scheme == Scheme::Gnss && said.imu.file.empty() && !g.find_logs) needs = Needs::Imu;   // nothing to look for
    dataset::Recognised r = dataset::recognise(path, needs, g);
    if (!d.folder.empty() && !g.find_logs) {
        // axes of time are the loader's where it knows dates; names are the folder's
        std::erase_if(r.facts, [](const Fact& f) { return f.key == "name"; });
    }
    if (r.report.refusal && needs == Needs::ImuAndGnss) {
        const inspect::Refusal& refused = *r.report.refusal;
        throw input_error(refused.text, {refused.file, 0, 0, refused.key}, refused.mend);
    }
    const std::string origin = "found in " + path.string();
    d.contradictions = std::move(r.report.contradictions);
    SettingList believed = given;   // all but what is refuted
    for (const inspect::Contradiction& c : d.contradictions) {
        if (!c.refuted) continue;
        std::erase_if(believed, [&](const Setting& s) { return s.key == c.key; });
        d.given.erase(c.key);
        if (!c.better) continue;
        Fact& fact = r.facts.emplace_back();
        fact.key = c.key;
        fact.value = *c.better;
        fact.how = Known::Found;
        fact.sigma = c.sigma;
        fact.note = c.text;
    }
    d.settings = completed(settings_of(r.facts, origin), believed);
    d.facts = std::move(r.facts);
    d.doubts = std::move(r.doubts);
    d.inferred_toml = std::move(r.dataset_toml);
    d.report = std::move(r.report);
}

Dataset from_toml(const fs::path& file, Needs needs, const SettingList& above) {
    Dataset d;
    d.folder = file.parent_path();
    const bool of_folder = file.filename() == "dataset.toml";
    const fs::path place = d.folder.empty() ? fs::path(".") : d.folder;
    const SettingList given = overlaid(config_table().read(read_toml(file), file.string()), above);
    d.given = keys_of(given);
    d.name = name_of(of_folder ? place : file);
    // a file of another name may be one of several that share a folder of logs
    resolve(d, place, needs, given, of_folder);
    d.inferred_toml.clear();
    return d;
}

Dataset from_kfgins(const fs::path& file, const SettingList& above) {
    Dataset d;
    d.folder = file.parent_path();
    d.settings = overlaid(kfgins_settings(io::read_kfgins_project(file.string()), file), above);
    d.given = keys_of(d.settings);
    d.name = name_of(file);
    return d;
}

Dataset from_files(const fs::path& path, Needs needs, const SettingList& above) {
    Dataset d;
    std::error_code ec;
    d.folder = fs::is_directory(path, ec) ? path : path.parent_path();
    d.name = name_of(path);
    d.given = keys_of(above);
    resolve(d, path, needs, above, true);
    return d;
}

}  // namespace

std::string with_environment(const std::string& path, const std::string& key) {
    std::string out;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] != '$') {
            out += path[i];
            continue;
        }
        const bool braces = i + 1 < path.size() && path[i + 1] == '{';
        std::size_t begin = i + (braces ? 2 : 1), end = begin;
        while (end < path.size() && (std::isalnum(static_cast<unsigned char>(path[end])) != 0 || path[end] == '_')) ++end;
        const std::string name = path.substr(begin, end - begin);
        const char* value = name.empty() ? nullptr : std::getenv(name.c_str());
        if (value == nullptr) {
            throw input_error(fmt::format("environment variable ${} in \"{}\" is not set", name, path), {{}, 0, 0, key},
                              fmt::format("export {}=... or write the path out", name.empty() ? "NAME" : name));
        }
        out += value;
        i = end - 1 + (braces && end < path.size() && path[end] == '}' ? 1 : 0);
    }
    return out;
}

fs::path resolved(const fs::path& folder, const std::string& file, const std::string& key) {
    const fs::path path = with_environment(file, key);
    return path.is_absolute() ? path : folder / path;
}

void blame_the_imu_log(const fs::path& folder, const Config& config) {
    if (folder.empty() || config.imu.file.empty() || !config.imu.scale.empty()) return;
    const fs::path file = resolved(folder, config.imu.file, "imu.file");
    for (const inspect::FileReport& report : inspect::inspect(file.parent_path()).files) {   // with the fixes to compare with
        if (report.path != file.filename()) continue;
        for (const inspect::Problem& problem : report.problems)
            if (problem.level == inspect::Level::Error) throw input_error(problem.text, {file.string(), 0, 0, {}}, problem.mend);
    }
}

Dataset open_dataset(const fs::path& path, Needs needs, const SettingList& above) {
    std::error_code ec;
    if (!fs::exists(path, ec)) throw input_error("no such file or folder", {path.string(), 0, 0, {}}, "check the path");
    const bool folder = fs::is_directory(path, ec);
    Dataset d = folder && fs::exists(path / "dataset.toml", ec)                   ? from_toml(path / "dataset.toml", needs, above)
                : folder                                                          ? from_files(path, needs, above)
                : path.extension() == ".toml"                                     ? from_toml(path, needs, above)
                : path.extension() == ".yaml" || path.extension() == ".yml"       ? from_kfgins(path, above)
                                                                                  : from_files(path, needs, above);
    const auto named = std::find_if(d.settings.rbegin(), d.settings.rend(), [](const Setting& s) { return s.key == "name"; });
    if (named != d.settings.rend() && named->value.text() != nullptr && !named->value.text()->empty())
        d.name = *named->value.text();
    return d;
}

}  // namespace schuler::app
