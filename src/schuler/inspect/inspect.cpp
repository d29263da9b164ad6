#include "schuler/inspect/inspect.h"

#include "schuler/core/error.h"
#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace schuler::inspect {
namespace {

using detail::LoadedFile;
using detail::Study;
namespace fs = std::filesystem;

constexpr std::size_t most_files = 200;

std::vector<fs::path> files_in(const fs::path& folder, Study& study) {
    std::vector<fs::path> paths;
    std::error_code failure;
    for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
        std::error_code odd;
        const std::string name = it->path().filename().string();
        if (it->is_regular_file(odd) && !name.starts_with(".")) paths.push_back(it->path());
    }
    if (failure) {
        throw input_error(fmt::format("the folder cannot be listed ({})", failure.message()), {folder.string(), 0, 0, {}},
                          "check its permissions");
    }
    std::sort(paths.begin(), paths.end());
    if (paths.size() > most_files) {
        study.problem(Level::Warning, fmt::format("{} files; only the first {} by name were looked at", paths.size(), most_files),
                      "give the folder of one recording");
        paths.resize(most_files);
    }
    return paths;
}

bool is_prose(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".md" || extension == ".html" || extension == ".kml" || extension == ".json" || extension == ".h5" ||
           extension == ".png" || extension == ".jpg" || extension == ".pdf" || extension == ".py" || extension == ".m";
}

// How well a file fills its role: dated formats and those with more of the wished columns first, then the name decides.
int preference(const LoadedFile& file) {
    int points = file.has("height_m") ? 1 : 0;
    if (file.has("vel_n_m_s")) points += 2;
    if (file.report.rows > 10) points += 4;
    return points;
}

LoadedFile* choose(Study& study, io::TableKind kind, const std::string& section) {
    LoadedFile* best = nullptr;
    for (LoadedFile& file : study.files) {
        if (file.table != kind) continue;
        const bool comparable = kind == io::TableKind::Gnss;
        if (best == nullptr || (comparable && preference(file) > preference(*best))) best = &file;
    }
    if (best == nullptr) return nullptr;
    best->report.chosen = true;
    for (const LoadedFile& file : study.files) {
        if (file.table != kind || &file == best) continue;
        study.problem(Level::Info,
                      fmt::format("{} could be [{}] as well; {} was taken", file.report.path, section, best->report.path),
                      fmt::format("to use it: [{}] file = {}", section, detail::toml_string(file.report.path)));
        study.draft.note(section, fmt::format("or file = {}", detail::toml_string(file.report.path)));
    }
    return best;
}

void choose_files(Study& study) {
    // The order in which sections appear in the draft.
    for (const char* section : {"", "time", "vehicle", "imu", "gnss", "baro", "mag", "reference"}) study.draft.begin(section);
    study.imu_file = choose(study, io::TableKind::Imu, "imu");
    study.gnss_file = choose(study, io::TableKind::Gnss, "gnss");
    study.baro_file = choose(study, io::TableKind::Baro, "baro");
    study.mag_file = choose(study, io::TableKind::Mag, "mag");
    study.reference_file = choose(study, io::TableKind::Reference, "reference");
}

void report_lacking(Study& study) {
    const auto any = [&](const char* kind) {
        return std::any_of(study.files.begin(), study.files.end(), [&](const LoadedFile& f) { return f.report.kind == kind; });
    };
    for (const LoadedFile& file : study.files) {
        if (file.report.kind == "kfgins_yaml") {
            study.problem(Level::Info,
                          file.report.path + " is a project of the KF-GINS program: it says more than can be inferred",
                          "use it as it is: schuler process " + file.report.path);
        }
        if (file.report.kind == "dataset_toml")
            study.problem(Level::Info,
                          fmt::format("there is already a {}: what follows is inferred without it", file.report.path), "");
    }
    const bool raw = any("rinex_obs") || any("rinex_nav") || any("ubx") || any("rtcm3") || any("sp3") || any("adsb");
    if (any("rinex_obs") && !any("rinex_nav") && !any("ubx") && !any("rtcm3") && !any("sp3")) {
        study.problem(Level::Warning, "there are raw measurements, and no ephemerides",
                      "put the navigation file of the same day beside them");
    }
    if (study.imu_file == nullptr && study.gnss_file == nullptr && raw) return;
    if (study.imu_file == nullptr && study.gnss_file == nullptr) {
        study.problem(Level::Error, "no IMU and no GNSS data were recognised",
                      "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ... and time_s, lat_deg, lon_deg, height_m, or "
                      "map them with columns = { ... } in dataset.toml");
    } else if (study.imu_file == nullptr) {
        study.problem(Level::Warning, "no IMU data were recognised",
                      "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ..., or map them in dataset.toml");
    } else if (study.gnss_file == nullptr) {
        study.problem(Level::Info, "no GNSS data: attitude only (schuler ahrs), or dead reckoning from an [initial] state", "");
    }
}

std::string name_of_set(const fs::path& path) {
    const fs::path clean = fs::absolute(path).lexically_normal();
    const std::string name = clean.has_filename() ? clean.filename().string() : clean.parent_path().filename().string();
    return fs::is_directory(clean) ? name : clean.stem().string();
}

}  // namespace

std::string_view name_of(Level level) {
    switch (level) {
        case Level::Info: return "info";
        case Level::Warning: return "warning";
        case Level::Error: return "error";
    }
    return "";
}

InspectReport inspect(const std::filesystem::path& path) {
    std::error_code failure;
    if (!fs::exists(path, failure))
        throw input_error("there is no such file or folder", {path.string(), 0, 0, {}}, "check the spelling");
    Study study;
    const bool folder = fs::is_directory(path, failure);
    const std::vector<fs::path> paths = folder ? files_in(path, study) : std::vector<fs::path>{path};
    study.files.reserve(paths.size());   // the study points into it
    for (const fs::path& file : paths) {
        if (!is_prose(file)) study.files.push_back(detail::load_file(file, file.filename().string()));
    }
    study.draft.set("", "name", detail::toml_string(name_of_set(path)));
    choose_files(study);
    if (study.imu_file != nullptr) study.imu_units = detail::judge_units(*study.imu_file);
    if (study.gnss_file != nullptr) study.gnss_units = detail::judge_units(*study.gnss_file);
    if (study.mag_file != nullptr) study.mag_units = detail::judge_units(*study.mag_file);
    report_lacking(study);
    detail::judge_time(study);
    detail::study_motion(study);
    detail::judge_vehicle(study);
    detail::judge_imu(study);
    detail::judge_gnss(study);
    detail::judge_latency(study);
    detail::judge_baro(study);
    detail::judge_mag(study);
    detail::judge_reference(study);

    InspectReport report;
    report.path = path.string();
    for (LoadedFile& file : study.files) report.files.push_back(std::move(file.report));
    report.findings = std::move(study.findings);
    report.problems = std::move(study.problems);
    if (study.imu_file != nullptr || study.gnss_file != nullptr) report.dataset_toml = study.draft.text();
    return report;
}

}  // namespace schuler::inspect
