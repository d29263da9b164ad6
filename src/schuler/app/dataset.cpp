#include "schuler/app/dataset.h"

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

Dataset from_inspection(const fs::path& path) {
    const inspect::InspectReport report = inspect::inspect(path);
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
    Dataset d;
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

Dataset open_dataset(const fs::path& path) {
    std::error_code ec;
    if (!fs::exists(path, ec)) throw input_error("no such file or folder", {path.string(), 0, 0, {}}, "check the path");
    Dataset d;
    if (fs::is_directory(path, ec)) {
        d = fs::exists(path / "dataset.toml", ec) ? from_toml(path / "dataset.toml") : from_inspection(path);
    } else if (path.extension() == ".toml") {
        d = from_toml(path);
    } else if (path.extension() == ".yaml" || path.extension() == ".yml") {
        d = from_kfgins(path);
    } else {
        d = from_inspection(path);
    }
    const auto named = std::find_if(d.settings.rbegin(), d.settings.rend(), [](const Setting& s) { return s.key == "name"; });
    if (named != d.settings.rend() && named->value.text() != nullptr && !named->value.text()->empty())
        d.name = *named->value.text();
    return d;
}

}  // namespace schuler::app
