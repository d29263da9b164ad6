#include "schuler/inspect/inspect.h"

#include "schuler/core/error.h"
#include "schuler/inspect/detail/beside_imu.h"
#include "schuler/inspect/detail/folder_files.h"
#include "schuler/inspect/detail/parts.h"
#include "schuler/inspect/detail/recognise.h"
#include "schuler/inspect/detail/study.h"
#include "schuler/inspect/explain.h"
#include "schuler/io/formats.h"
#include "schuler/io/own_files.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <system_error>

namespace schuler::inspect {
namespace {

using detail::files_in;
using detail::LoadedFile;
using detail::Study;
namespace fs = std::filesystem;

bool is_prose(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".md" || extension == ".html" || extension == ".kml" || extension == ".geojson" || extension == ".json" ||
           extension == ".png" || extension == ".jpg" || extension == ".pdf" || extension == ".py" || extension == ".m";
}

/// A solution that Schuler wrote: the result of an earlier run, or a conversion of it.
bool is_own_solution(const fs::path& path) {
    const std::string name = path.filename().string();
    if (name == "run.h5" || name == "run.mat") return fs::exists(path.parent_path() / "summary.json");
    try {
        const io::FileHead head(path);
        const std::string_view start = std::string_view(head.bytes).substr(0, 512);
        if (path.extension() == ".pos") return start.starts_with("% program   : schuler");
        if (path.extension() == ".mcap") return start.substr(0, 64).find("schuler") != std::string_view::npos;
        return path.extension() == ".csv" && start.starts_with(io::solution_csv_header());
    } catch (const Error&) {
        return false;  // its reader reports the error
    }
}

// Suitability of a file for its role: dated formats and those with more of the desired columns first, then by name.
int preference(const LoadedFile& file) {
    int points = file.has("height_m") ? 1 : 0;
    if (file.has("vel_n_m_s")) points += 2;
    if (file.report.rows > 10) points += 4;
    if (file.beside_imu) points -= 4;
    if (file.report.path.find(".ubx#") != std::string::npos)
        points -= 8;  // the receiver's own processing, used if nothing better is available
    return points;
}

const GivenFile* given_for(const Given& given, io::TableKind kind) {
    return kind == io::TableKind::Imu         ? &given.imu
           : kind == io::TableKind::Gnss      ? &given.gnss
           : kind == io::TableKind::Baro      ? &given.baro
           : kind == io::TableKind::Mag       ? &given.mag
           : kind == io::TableKind::Reference ? &given.reference
                                              : nullptr;
}
const GivenFile* named(const Given& given, io::TableKind kind) {
    const GivenFile* file = given_for(given, kind);
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
    const Given& given = study.given;
    if (kind == io::TableKind::Gnss && !study.files.empty() && study.files.back().computed) return &study.files.back();
    const bool companion = kind == io::TableKind::Baro || kind == io::TableKind::Mag;
    const bool may = companion ? given.find_companions
                               : given.find_logs || (kind == io::TableKind::Imu && given.find_imu) ||
                                     (kind == io::TableKind::Gnss && given.find_gnss);
    if (!may) return nullptr;
    for (LoadedFile& file : study.files) {
        if (file.table != kind || file.as.kind || detail::is_result(file)) continue;
        const bool comparable = kind == io::TableKind::Gnss;
        if (best == nullptr || (comparable && preference(file) > preference(*best))) best = &file;
    }
    if (best == nullptr) return nullptr;
    best = detail::with_parts(study, best, section);
    best->report.chosen = true;
    for (const LoadedFile& file : study.files) {
        if (file.table != kind || file.as.kind || &file == best || file.report.chosen || detail::is_result(file)) continue;
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

/// Logs with the names of the interface and no further content to evaluate: wheel speed, heading.
void choose_plain_companions(Study& study) {
    if (!study.given.find_companions) return;
    for (const char* section : {"odometer", "heading"}) {
        const bool named = study.given.has(std::string(section) + ".file") ||
                           (section == std::string_view("heading") && study.given.has("compass.file"));
        for (LoadedFile& file : study.files) {
            if (named || file.report.kind != section) continue;
            if (study.draft.has(section)) {
                study.problem(Level::Info,
                              fmt::format("{} could be [{}] as well; the first by name was taken", file.report.path, section),
                              "");
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
                          file.report.path + " is a project of the KF-GINS program: it states more than can be inferred",
                          "use it as it is: schuler process " + file.report.path);
        }
        if (file.report.kind == "dataset_toml" && study.given.keys.empty())
            study.problem(Level::Info,
                          fmt::format("there is already a {}: what follows is inferred without it", file.report.path), "");
    }
    const bool raw =
        any("rinex_obs") || any("rinex_nav") || any("ubx") || any("novatel") || any("rtcm3") || any("sp3") || any("adsb");
    if (any("rinex_obs") && !any("rinex_nav") && !any("ubx") && !any("novatel") && !any("rtcm3") && !any("sp3")) {
        study.problem(Level::Warning, "there are raw measurements, and no ephemerides",
                      "add the navigation file of the same day to the folder");
    }
    if (study.imu_file == nullptr && study.gnss_file == nullptr && raw) return;
    if (study.imu_file == nullptr && study.gnss_file == nullptr) {
        const auto packed = std::ranges::find_if(study.files, [](const LoadedFile& f) { return f.report.kind == "archive"; });
        if (packed != study.files.end()) {
            study.problem(Level::Error, "no IMU and no GNSS data were recognised", fmt::format("unpack {}", packed->report.path));
            return;
        }
        study.problem(Level::Error, "no IMU and no GNSS data were recognised",
                      "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ... and time_s, lat_deg, lon_deg, height_m, or "
                      "map them with columns = { ... } in dataset.toml");
    } else if (study.imu_file == nullptr) {
        study.problem(Level::Warning, "no IMU data were recognised",
                      "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ..., or map them in dataset.toml");
    } else if (study.gnss_file == nullptr && !raw) {
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

constexpr std::array roles{io::TableKind::Imu, io::TableKind::Gnss, io::TableKind::Baro, io::TableKind::Mag,
                           io::TableKind::Reference};

/// A log that was found, with the columns, scales and codes given for its role without a file. Columns may also tell the role.
LoadedFile as_given(LoadedFile file, const Given& given) {
    for (const io::TableKind kind : roles) {
        const GivenFile& given_file = *given_for(given, kind);
        detail::ReadAs as{kind, {given_file.columns, given_file.scale, {}}, {}, 0.0};
        if (kind == io::TableKind::Gnss) as.fix_codes = given.fix_codes;
        if (!given_file.path.empty() || (given_file.columns.empty() && given_file.scale.empty() && as.fix_codes.empty()))
            continue;
        const bool stream = !io::stream_path(file.path).stream.empty();
        if (file.table ? *file.table != kind : stream || given_file.columns.empty()) continue;
        LoadedFile again = stream ? detail::load_given_stream(file.path, file.report.path, as)
                                  : detail::load_file(file.path, file.report.path, as);
        if (!again.table) continue;
        again.as.kind.reset();  // found, not named
        return again;
    }
    return file;
}

/// Loads a file according to its type: a table, or a log of several instruments.
void load_one(const fs::path& file, const std::string& name, Study& study) {
    const io::Format* format = nullptr;
    try {
        format = io::format_of(file);
    } catch (const Error&) {
        // load_file reports the error
    }
    const bool streams = format != nullptr && format->read != nullptr && !format->one_stream;
    const bool receiver =
        streams &&
        (format->name == "ubx" ||
         (format->name == "novatel" &&
          io::raw_format(file) == io::RawFormat::Novatel));  // raw measurements first, then the receiver's own solution
    if (!streams || receiver) study.files.push_back(as_given(detail::load_file(file, name), study.given));
    if (!streams) {
        const std::size_t table = study.files.size() - 1;
        if (std::optional<LoadedFile> fixes = detail::fixes_beside(study.files[table]))
            study.files.push_back(as_given(std::move(*fixes), study.given));
        if (std::optional<LoadedFile> mag = detail::magnetometer_beside(study.files[table]))
            study.files.push_back(as_given(std::move(*mag), study.given));
    }
    if (!streams || (receiver && study.files.back().report.kind != format->name)) return;
    const std::size_t whole = study.files.size() - 1;
    for (LoadedFile& stream : detail::load_streams(file, name, *format)) {
        if (receiver && !stream.table) continue;
        if (receiver) std::erase_if(study.files[whole].report.problems, [](const Problem& p) { return p.level == Level::Error; });
        study.files.push_back(as_given(std::move(stream), study.given));
    }
}

/// Loads the files with a given role, then the others of the folder (or the one file) if they may take one.
void load_files(const fs::path& path, Study& study) {
    std::error_code failure;
    const bool folder = fs::is_directory(path, failure) && io::format_of(path) == nullptr;
    const Given& given = study.given;
    std::vector<fs::path> others;
    if (given.find_logs || given.find_imu || given.find_gnss || given.find_companions || !folder)
        others = folder ? files_in(path, study) : std::vector<fs::path>{path};
    study.files.reserve(others.size() + 6);
    for (const io::TableKind kind : roles) {
        const GivenFile* file = named(given, kind);
        if (file == nullptr) continue;
        const auto add_parts = [&](const detail::ReadAs& as) {
            std::vector<LoadedFile> parts;
            for (const fs::path& part : file->parts) {
                std::erase_if(others, [&](const fs::path& p) { return fs::equivalent(p, part, failure); });
                const std::string name = part.filename().string();
                parts.push_back(io::stream_path(part).stream.empty() ? detail::load_file(part, name, as)
                                                                     : detail::load_given_stream(part, name, as));
            }
            detail::join_given(study.files.back(), std::move(parts));
        };
        if (!fs::is_regular_file(file->path, failure)) {
            const io::StreamPath where = io::stream_path(file->path);
            if (where.stream.empty()) continue;
            if (!given.find_imu)  // otherwise the IMU may be in the same log
                std::erase_if(others, [&](const fs::path& p) { return fs::equivalent(p, where.file, failure); });
            const detail::ReadAs as{kind, {file->columns, file->scale, {}}, {}, file->time_offset};
            study.files.push_back(detail::load_given_stream(file->path, file->name, as));
            add_parts(as);
            continue;
        }
        if (!detail::is_table_of_another(file->path, kind))
            std::erase_if(others, [&](const fs::path& p) { return fs::equivalent(p, file->path, failure); });
        detail::ReadAs as{kind, {file->columns, file->scale, {}}, {}, file->time_offset};
        if (kind == io::TableKind::Gnss) as.fix_codes = given.fix_codes;
        study.files.push_back(detail::load_file(file->path, file->name, as));
        add_parts(as);
        if (kind != io::TableKind::Imu) continue;
        const std::size_t imu = study.files.size() - 1;
        if (given.find_gnss && named(given, io::TableKind::Gnss) == nullptr)
            if (std::optional<LoadedFile> fixes = detail::fixes_beside(study.files[imu]))
                study.files.push_back(as_given(std::move(*fixes), given));
        if (given.find_companions && named(given, io::TableKind::Mag) == nullptr)
            if (std::optional<LoadedFile> mag = detail::magnetometer_beside(study.files[imu]))
                study.files.push_back(as_given(std::move(*mag), given));
    }
    const auto load = [&](const fs::path& file) {
        // in addition to named files, only tables can take a role, and the IMU's in the log of a receiver
        const bool raw = io::raw_format(file) != io::RawFormat::None;
        if (is_prose(file) || (!given.find_logs && ((raw && !given.find_imu) || file.extension() == ".toml"))) return;
        const std::string name = folder ? file.lexically_relative(path).generic_string() : file.filename().string();
        if (folder && is_own_solution(file)) {
            LoadedFile& own = study.files.emplace_back();
            own.path = file;
            own.report.path = name;
            own.report.kind = "solution";
            own.report.start_s = own.report.stop_s = not_given;
            own.problem(Level::Info, "a solution that Schuler wrote, which is neither a log nor a reference",
                        fmt::format("to compare with it: [reference] file = {}", toml_text(name)));
            return;
        }
        load_one(file, name, study);
    };
    for (const fs::path& file : others) load(file);
    const auto usable = [](const LoadedFile& file) {
        return file.table == io::TableKind::Imu || file.table == io::TableKind::Gnss;
    };
    const auto raw = [](const LoadedFile& file) { return !file.report.contents.empty(); };
    const auto nothing_found = [&] {
        return std::ranges::none_of(study.files, usable) && std::ranges::none_of(study.files, raw);
    };
    if (folder && given.find_logs && nothing_found()) {
        const detail::FilesBelow below = detail::files_below(path, study);
        for (const fs::path& file : below.files) load(file);
        detail::tell_folders_further_down(path, below.folders, nothing_found() ? Level::Warning : Level::Info, study);
    }
    if (!given.computed.fixes.empty()) study.files.push_back(detail::load_computed(given.computed));
}

/// The interval of the evidence from motion, s after the first epoch of the GNSS log (of the IMU log if there is none).
void date_facts(const Study& study, std::vector<Fact>& facts) {
    if (study.imu.empty()) return;
    double from = study.imu.t.front(), to = study.imu.t.back();
    if (study.overlap && !study.gnss.empty()) {
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

/// Times on the axis of the study's series: that of the GNSS log, or of the IMU log if there is none.
Motion motion_of(const Study& study) {
    Motion m;
    const double origin = study.origin.seconds();
    m.imu_shift = study.gnss_file == nullptr ? 0.0 : study.imu_shift + study.clock_shift;
    for (const auto& interval : study.still.intervals) m.still.emplace_back(origin + interval.start, origin + interval.stop);
    for (std::size_t i = 0; i < study.gnss.size(); ++i) {
        m.t.push_back(origin + study.gnss.t[i]);
        m.north.push_back(study.gnss.p[i].x());
        m.east.push_back(study.gnss.p[i].y());
        m.up.push_back(study.gnss.has_height ? -study.gnss.p[i].z() : not_given);
    }
    return m;
}

}  // namespace

std::string explain(const std::filesystem::path& path) {
    std::error_code failure;
    if (!fs::exists(path, failure))
        throw input_error("there is no such file or folder", {path.string(), 0, 0, {}}, "check the spelling");
    Study study;
    load_files(path, study);
    std::string out = "How the files were understood\n";
    for (const LoadedFile& file : study.files) {
        out += fmt::format("  {}: {}\n", file.report.path, file.report.kind);
        for (const std::string& line : detail::explained_columns(file)) out += "      " + line + "\n";
    }
    return out;
}

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
    detail::judge_idle_velocity(study);
    detail::judge_coordinates(study);
    detail::judge_velocity(study);
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
    detail::draft_clock(study);
    detail::judge_baro(study);
    detail::judge_mag(study);
    detail::judge_reference(study);
    choose_plain_companions(study);

    InspectReport report;
    report.path = path.string();
    report.motion = motion_of(study);
    for (LoadedFile& file : study.files) {
        if (file.computed) continue;
        if (file.table) file.report.understood = detail::explained_columns(file);
        if (file.table == io::TableKind::Imu) file.report.provides.emplace_back("imu");
        if (file.table == io::TableKind::Gnss) file.report.provides.emplace_back("fixes");
        report.files.push_back(std::move(file.report));
    }
    report.findings = std::move(study.findings);
    report.problems = std::move(study.problems);
    report.contradictions = std::move(study.contradictions);
    report.doubts = std::move(study.doubts);
    report.clock_steps = std::move(study.clock_steps);
    report.refusal = std::move(study.refusal);
    report.forward_supposed = study.forward_supposed;
    report.facts = study.draft.facts();
    std::ranges::move(study.stated, std::back_inserter(report.facts));
    std::erase_if(report.facts, [&](const Fact& fact) {
        const bool table = std::holds_alternative<std::map<std::string, std::string>>(fact.value) ||
                           std::holds_alternative<std::map<std::string, double>>(fact.value);
        return given.has(fact.key) && !table;  // a given table may have fewer entries than found
    });
    date_facts(study, report.facts);
    if (study.imu_file != nullptr || study.gnss_file != nullptr) report.dataset_toml = study.draft.text();
    return report;
}

}  // namespace schuler::inspect
