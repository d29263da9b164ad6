#include "schuler/inspect/inspect.h"

#include "schuler/core/error.h"
#include "schuler/inspect/detail/study.h"
#include "schuler/io/raw_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
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

const GivenFile* named(const Given& given, io::TableKind kind) {
    const GivenFile* file = kind == io::TableKind::Imu         ? &given.imu
                            : kind == io::TableKind::Gnss      ? &given.gnss
                            : kind == io::TableKind::Baro      ? &given.baro
                            : kind == io::TableKind::Mag       ? &given.mag
                            : kind == io::TableKind::Reference ? &given.reference
                                                               : nullptr;
    return file != nullptr && !file->path.empty() ? file : nullptr;
}

LoadedFile* choose(Study& study, io::TableKind kind, const std::string& section) {
    LoadedFile* best = nullptr;
    if (named(study.given, kind) != nullptr) {
        for (LoadedFile& file : study.files)
            if (file.as.kind == kind && file.table == kind) best = &file;
        if (best != nullptr) best->report.chosen = true;
        return best;
    }
    const bool aid = kind == io::TableKind::Baro || kind == io::TableKind::Mag;
    if (!(aid ? study.given.find_aids : study.given.find_logs)) return nullptr;
    for (LoadedFile& file : study.files) {
        if (file.table != kind || file.as.kind) continue;
        const bool comparable = kind == io::TableKind::Gnss;
        if (best == nullptr || (comparable && preference(file) > preference(*best))) best = &file;
    }
    if (best == nullptr) return nullptr;
    best->report.chosen = true;
    for (const LoadedFile& file : study.files) {
        if (file.table != kind || file.as.kind || &file == best) continue;
        study.problem(Level::Info,
                      fmt::format("{} could be [{}] as well; {} was taken", file.report.path, section, best->report.path),
                      fmt::format("to use it: [{}] file = {}", section, toml_text(file.report.path)));
        study.draft.note(section, fmt::format("or file = {}", toml_text(file.report.path)));
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
    const auto shift = [](LoadedFile* file, const GivenFile& given) {
        if (file != nullptr && !file->as.kind) file->add_to_times(given.time_offset);
    };
    shift(study.imu_file, study.given.imu);
    shift(study.gnss_file, study.given.gnss);
    shift(study.baro_file, study.given.baro);
    shift(study.mag_file, study.given.mag);
    shift(study.reference_file, study.given.reference);
}

/// Logs with the names of the interface and nothing else to be found in them: speed by wheels, heading.
void choose_plain_aids(Study& study) {
    if (!study.given.find_aids) return;
    for (const char* section : {"odometer", "heading"}) {
        const bool named = study.given.has(std::string(section) + ".file") || (section == std::string_view("heading") && study.given.has("compass.file"));
        for (LoadedFile& file : study.files) {
            if (named || file.report.kind != section) continue;
            if (study.draft.has(section)) {
                study.problem(Level::Info, fmt::format("{} could be [{}] as well; the first by name was taken", file.report.path, section), "");
                continue;
            }
            file.report.chosen = true;
            study.draft.set(section, "file", file.report.path, fmt::format("{:.4g} Hz", file.report.rate_hz));
        }
    }
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
        if (file.report.kind == "dataset_toml" && study.given.keys.empty())
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

namespace {

/// Loads the files with a given role, then the others of the folder (or the one file) where they may take one.
void load_files(const fs::path& path, Study& study) {
    std::error_code failure;
    const bool folder = fs::is_directory(path, failure);
    const Given& given = study.given;
    std::vector<fs::path> others;
    if (given.find_logs || given.find_aids || !folder) others = folder ? files_in(path, study) : std::vector<fs::path>{path};
    study.files.reserve(others.size() + 5);   // the study points into it
    for (const auto kind : {io::TableKind::Imu, io::TableKind::Gnss, io::TableKind::Baro, io::TableKind::Mag, io::TableKind::Reference}) {
        const GivenFile* file = named(given, kind);
        if (file == nullptr || !fs::is_regular_file(file->path, failure)) continue;
        std::erase_if(others, [&](const fs::path& p) { return fs::equivalent(p, file->path, failure); });
        detail::ReadAs as{kind, {file->columns, file->scale, {}}, {}, file->time_offset};
        if (kind == io::TableKind::Gnss) as.fix_codes = given.fix_codes;
        study.files.push_back(detail::load_file(file->path, file->name, as));
    }
    for (const fs::path& file : others) {
        // beside files that are named, only tables can take a role
        if (is_prose(file) || (!given.find_logs && (io::raw_format(file) != io::RawFormat::None || file.extension() == ".toml"))) continue;
        study.files.push_back(detail::load_file(file, file.filename().string()));
    }
}

/// The span that shows what follows from motion, s after the first epoch of the GNSS log (of the IMU log where there is none).
void date_facts(const Study& study, std::vector<Fact>& facts) {
    if (study.imu.empty()) return;
    double from = study.imu.t.front(), to = study.imu.t.back();
    if (study.overlap) {
        from = std::max(from, study.gnss.t.front());
        to = std::min(to, study.gnss.t.back());
    }
    for (Fact& fact : facts) {
        const bool by_motion = fact.key == "vehicle.kind" || fact.key == "imu.axes" || fact.key == "imu.mounting_deg" ||
                               fact.key == "imu.grade" || fact.key.ends_with("latency_s");
        if (!by_motion || fact.how != Known::Found) continue;
        fact.from = from;
        fact.to = to;
    }
}

}  // namespace

InspectReport inspect(const std::filesystem::path& path) { return inspect(path, Given{}); }

InspectReport inspect(const std::filesystem::path& path, const Given& given) {
    std::error_code failure;
    if (!fs::exists(path, failure))
        throw input_error("there is no such file or folder", {path.string(), 0, 0, {}}, "check the spelling");
    Study study;
    study.given = given;
    load_files(path, study);
    study.draft.set("", "name", name_of_set(path), {}, true, Known::Default);
    choose_files(study);
    if (study.imu_file != nullptr) study.imu_units = detail::judge_units(*study.imu_file);
    if (study.gnss_file != nullptr) study.gnss_units = detail::judge_units(*study.gnss_file);
    if (study.mag_file != nullptr) study.mag_units = detail::judge_units(*study.mag_file);
    report_lacking(study);
    detail::judge_coordinates(study);
    detail::judge_time(study);
    detail::judge_clock_steps(study);
    const bool compared = study.overlap;
    detail::judge_clock(study);
    if (!compared) detail::judge_clock_steps(study);
    detail::study_motion(study);
    detail::judge_vehicle(study);
    detail::judge_imu(study);
    detail::judge_gnss(study);
    detail::judge_latency(study);
    detail::judge_baro(study);
    detail::judge_mag(study);
    detail::judge_reference(study);
    choose_plain_aids(study);

    InspectReport report;
    report.path = path.string();
    for (LoadedFile& file : study.files) report.files.push_back(std::move(file.report));
    report.findings = std::move(study.findings);
    report.problems = std::move(study.problems);
    report.contradictions = std::move(study.contradictions);
    report.doubts = std::move(study.doubts);
    report.clock_steps = std::move(study.clock_steps);
    report.refusal = std::move(study.refusal);
    report.facts = study.draft.facts();
    std::ranges::move(study.stated, std::back_inserter(report.facts));
    std::erase_if(report.facts, [&](const Fact& fact) {
        const bool table = std::holds_alternative<std::map<std::string, std::string>>(fact.value) ||
                           std::holds_alternative<std::map<std::string, double>>(fact.value);
        return given.has(fact.key) && !table;   // a table may say less than was found
    });
    date_facts(study, report.facts);
    if (study.imu_file != nullptr || study.gnss_file != nullptr) report.dataset_toml = study.draft.text();
    return report;
}

}  // namespace schuler::inspect
