#include "schuler/app/dataset.h"

#include "schuler/app/kfgins_settings.h"
#include "schuler/app/raw_gnss.h"
#include "schuler/app/toml_file.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/kfgins.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

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

Dataset from_toml(const fs::path& file) {
    Dataset d;
    d.folder = file.parent_path();
    d.settings = config_table().read(read_toml(file), file.string());
    d.name = name_of(file.filename() == "dataset.toml" ? (d.folder.empty() ? fs::path(".") : d.folder) : file);
    return d;
}

Dataset from_kfgins(const fs::path& file) {
    Dataset d;
    d.folder = file.parent_path();
    d.settings = kfgins_settings(io::read_kfgins_project(file.string()), file);
    d.name = name_of(file);
    return d;
}

/// No log of this kind was recognised: the most telling thing known about a file that might have been one.
[[noreturn]] void throw_missing(const fs::path& path, const inspect::InspectReport& report, std::string_view kind) {
    std::error_code ec;
    const fs::path folder = fs::is_directory(path, ec) ? path : path.parent_path();
    for (const inspect::FileReport& file : report.files) {
        if (file.chosen || (file.kind != "unknown" && file.kind != kind)) continue;
        for (const inspect::Problem& problem : file.problems) {
            if (problem.level == inspect::Level::Info) continue;
            throw input_error(problem.text, {(folder / file.path).string(), 0, 0, {}}, problem.mend);
        }
    }
    if (fs::is_directory(folder / fmt::format("{}.csv", kind), ec)) {
        throw input_error("this is a folder, not a file", {(folder / fmt::format("{}.csv", kind)).string(), 0, 0, {}},
                          "put the log itself there, or name it in a dataset.toml");
    }
    const bool imu = kind == "imu";
    throw input_error(fmt::format("no {} log was recognised in it", imu ? "IMU" : "GNSS"), {path.string(), 0, 0, {}},
                      imu ? "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ..., or map them in a dataset.toml"
                          : "give the folder that holds both logs, or a dataset.toml with [initial] to navigate without GNSS");
}

bool recognised(const inspect::InspectReport& report, std::initializer_list<std::string_view> kinds) {
    return std::ranges::any_of(report.files, [&](const inspect::FileReport& file) {
        return file.chosen && std::ranges::find(kinds, std::string_view(file.kind)) != kinds.end();
    });
}

/// Raw satellite measurements without inertial data.
std::optional<Dataset> from_raw_gnss(const fs::path& path) {
    Dataset d;
    d.inferred_toml = raw_dataset_toml(path);
    if (d.inferred_toml.empty()) return std::nullopt;
    std::error_code ec;
    d.folder = fs::is_directory(path, ec) ? path : path.parent_path();
    const std::string origin = "dataset.toml inferred from " + path.string();
    d.settings = config_table().read(parse_toml(d.inferred_toml, origin), origin);
    d.name = name_of(path);
    return d;
}

Dataset from_inspection(const fs::path& path, Needs needs) {
    const inspect::InspectReport report = inspect::inspect(path);
    if (needs == Needs::ImuAndGnss && !recognised(report, {"imu", "kfgins_imu"})) {
        if (auto raw = from_raw_gnss(path)) return std::move(*raw);
    }
    if (report.dataset_toml.empty()) {
        std::string why = "no IMU log was recognised in it";
        std::string mend = "`schuler inspect` says what was found; write a dataset.toml";
        for (const auto& problem : report.problems) {
            if (problem.level != inspect::Level::Error) continue;
            why = problem.text;
            if (!problem.mend.empty()) mend = problem.mend;
        }
        throw input_error(why, {path.string(), 0, 0, {}}, mend);
    }
    if (!recognised(report, {"imu", "kfgins_imu"})) throw_missing(path, report, "imu");
    if (needs == Needs::ImuAndGnss && !recognised(report, {"gnss", "kfgins_gnss", "rtklib_pos", "nmea"}))
        throw_missing(path, report, "gnss");
    Dataset d;
    for (const inspect::FileReport& file : report.files) {
        if (!file.chosen) continue;
        for (const inspect::Problem& problem : file.problems) {
            if (problem.level == inspect::Level::Error)
                d.doubts.push_back(fmt::format("{}: {}; taken with {}", file.path, problem.text, problem.mend));
        }
    }
    std::error_code ec;
    d.folder = fs::is_directory(path, ec) ? path : path.parent_path();
    const std::string origin = "dataset.toml inferred from " + path.string();
    d.settings = config_table().read(parse_toml(report.dataset_toml, origin), origin);
    d.name = name_of(path);
    d.inferred_toml = report.dataset_toml;
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

Dataset open_dataset(const fs::path& path, Needs needs) {
    std::error_code ec;
    if (!fs::exists(path, ec)) throw input_error("no such file or folder", {path.string(), 0, 0, {}}, "check the path");
    Dataset d;
    if (fs::is_directory(path, ec)) {
        d = fs::exists(path / "dataset.toml", ec) ? from_toml(path / "dataset.toml") : from_inspection(path, needs);
    } else if (path.extension() == ".toml") {
        d = from_toml(path);
    } else if (path.extension() == ".yaml" || path.extension() == ".yml") {
        d = from_kfgins(path);
    } else {
        d = from_inspection(path, needs);
    }
    const auto named = std::find_if(d.settings.rbegin(), d.settings.rend(), [](const Setting& s) { return s.key == "name"; });
    if (named != d.settings.rend() && named->value.text() != nullptr && !named->value.text()->empty())
        d.name = *named->value.text();
    return d;
}

}  // namespace schuler::app
