#include "schuler/settings/dataset.h"

#include "schuler/dataset/raw_observations.h"
#include "schuler/dataset/recognise.h"
#include "schuler/io/formats.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/facts.h"
#include "schuler/settings/kfgins_settings.h"
#include "schuler/settings/toml_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace schuler::settings {
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

/// Finds settings not in `given` and adds them as the lowest layer.
void resolve(Dataset& d, const fs::path& path, dataset::Needs needs, const SettingList& given, bool may_find_companions) {
    const Config said = config_from(given);
    inspect::Given g = given_of(said, given, d.folder);
    g.find_companions = may_find_companions;
    g.find_imu = g.find_imu && may_find_companions;
    g.find_gnss = g.find_gnss && may_find_companions && needs == dataset::Needs::ImuAndGnss;
    g.weighs_field = needs == dataset::Needs::Attitude;
    if (said.scheme == Scheme::Gnss && said.imu.file.empty() && !g.find_logs) {  // nothing to search for
        needs = dataset::Needs::Imu;
        g.find_imu = false;
    } else if ((needs == dataset::Needs::ImuAndGnss || needs == dataset::Needs::ImuAndStart) && said.scheme != Scheme::Gnss &&
               said.gnss.file.empty() && !said.raw.observations.empty()) {
        g.computed = dataset::computed_fixes(d.folder, said.raw);
    }
    dataset::Recognised r = dataset::recognise(path, needs, g);
    if (!d.folder.empty() && !g.find_logs) {
        // the loader handles dated time axes; names follow from the folder
        std::erase_if(r.facts, [](const Fact& f) { return f.key == "name"; });
    }
    if (r.report.refusal && needs == dataset::Needs::ImuAndGnss) {
        const inspect::Refusal& refused = *r.report.refusal;
        throw input_error(refused.text, {refused.file, 0, 0, refused.key}, refused.hint);
    }
    const std::string origin = "found in " + path.string();
    d.contradictions = std::move(r.report.contradictions);
    SettingList accepted = given;  // all except refuted ones
    for (inspect::Contradiction& c : d.contradictions) {
        if (said.run.keep_given) c.refuted = false;
        if (!c.refuted) continue;
        std::erase_if(accepted, [&](const Setting& s) { return s.key == c.key; });
        d.given.erase(c.key);
        if (!c.better) continue;
        Fact& fact = r.facts.emplace_back();
        fact.key = c.key;
        fact.value = *c.better;
        fact.how = Known::Found;
        fact.sigma = c.sigma;
        fact.note = c.text;
    }
    d.settings = completed(settings_of(r.facts, origin), accepted);
    d.facts = std::move(r.facts);
    d.doubts = std::move(r.doubts);
    d.inferred_toml = std::move(r.dataset_toml);
    d.report = std::move(r.report);
}

/// States that the file has and a preset above it takes away, in words.
std::vector<std::string> states_switched_off(const SettingList& own, const Dataset& d) {
    const Config c = config_from(d.settings);
    std::vector<std::string> keys;
    for (const auto& [key, on] :
         {std::pair{"filter.scale_factors", c.filter.scale_factors}, std::pair{"filter.misalignments", c.filter.misalignments}}) {
        const auto its = std::ranges::find(own, key, &Setting::key);
        if (!on && its != own.end() && *its->value.flag() && !d.given.contains(key)) keys.emplace_back(key);
    }
    if (keys.empty()) return {};
    return {fmt::format(
        "filter.preset = \"{}\" switches off {} of the data set's own file; to keep these states, set them beside the preset",
        c.preset, fmt::join(keys, " and "))};
}

Dataset from_toml(const fs::path& file, dataset::Needs needs, const SettingList& above) {
    Dataset d;
    d.folder = file.parent_path();
    const bool of_folder = file.filename() == "dataset.toml";
    const fs::path place = d.folder.empty() ? fs::path(".") : d.folder;
    const SettingList own = config_table().read(read_toml(file), file.string());
    const SettingList given = overlaid(own, above);
    d.given = keys_of(given);
    d.name = name_of(of_folder ? place : file);
    // a file of another name may be one of several that share a folder of logs
    resolve(d, place, needs, given, of_folder);
    std::ranges::move(states_switched_off(own, d), std::back_inserter(d.doubts));
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

Dataset from_files(const fs::path& path, dataset::Needs needs, const SettingList& above) {
    Dataset d;
    std::error_code ec;
    // a folder that is a log itself (KITTI, a ROS 2 bag) lies in another one, as a file does
    const bool of_logs = fs::is_directory(path, ec) && io::format_of(path) == nullptr;
    const fs::path log = of_logs || path.has_filename() ? path : path.parent_path();
    d.folder = of_logs ? log : log.parent_path();
    d.name = name_of(log);
    d.given = keys_of(above);
    resolve(d, log, needs, above, true);
    return d;
}

}  // namespace

Dataset open_dataset(const fs::path& path, dataset::Needs needs, const SettingList& above) {
    std::error_code ec;
    if (!fs::exists(path, ec)) throw input_error("no such file or folder", {path.string(), 0, 0, {}}, "check the path");
    const bool folder = fs::is_directory(path, ec);
    Dataset d = folder && fs::exists(path / "dataset.toml", ec)             ? from_toml(path / "dataset.toml", needs, above)
                : folder                                                    ? from_files(path, needs, above)
                : path.extension() == ".toml"                               ? from_toml(path, needs, above)
                : path.extension() == ".yaml" || path.extension() == ".yml" ? from_kfgins(path, above)
                                                                            : from_files(path, needs, above);
    const auto named = std::find_if(d.settings.rbegin(), d.settings.rend(), [](const Setting& s) { return s.key == "name"; });
    if (named != d.settings.rend() && named->value.text() != nullptr && !named->value.text()->empty())
        d.name = *named->value.text();
    return d;
}

}  // namespace schuler::settings
