#include "schuler/inspect/detail/recognise.h"

#include "schuler/core/error.h"
#include "schuler/core/fact.h"
#include "schuler/inspect/detail/bare_table.h"
#include "schuler/inspect/detail/plausible.h"
#include "schuler/inspect/detail/robust.h"
#include "schuler/io/regular_file.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/own_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace schuler::inspect::detail {
namespace {

/// Columns missing from a kind of table, for files that nearly match one: that kind, and what is to be said.
struct Nearly {
    std::string kind, text = "no data that Schuler uses (a table with other columns)", hint;
};
Nearly nearly(const io::TableLayout& layout) {
    Nearly best;
    std::size_t fewest = 4;
    const auto judge = [&](io::TableKind kind, std::initializer_list<const char*> needed) {
        const io::ColumnPlan plan = io::match_columns(layout, kind);
        std::string lacking;
        std::size_t n = 0;
        for (const char* name : needed) {
            if (plan.find(name) != nullptr) continue;
            lacking += (n++ > 0 ? ", " : "") + std::string(name);
        }
        if (n > 0 && n < fewest && n < needed.size() - 1) {
            fewest = n;
            best = {std::string(io::name_of(kind)), "not usable as it is",
                    fmt::format("it looks like {} data but lacks {}: name the columns in dataset.toml, [{}] columns = {{ {} = "
                                "\"NAME\" }}",
                                io::name_of(kind), lacking, io::name_of(kind), lacking.substr(0, lacking.find(',')))};
            if (lacking == "accel_x_m_s2, accel_y_m_s2, accel_z_m_s2") best.text = "a gyroscope without an accelerometer";
            if (lacking == "gyro_x_rad_s, gyro_y_rad_s, gyro_z_rad_s") best.text = "an accelerometer without a gyroscope";
        }
    };
    judge(io::TableKind::Imu,
          {"time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
    judge(io::TableKind::Gnss, {"time_s", "lat_deg", "lon_deg", "height_m"});
    judge(io::TableKind::Mag, {"time_s", "mag_x_ut", "mag_y_ut", "mag_z_ut"});
    return best;
}

/// The role is given; missing columns are reported by the reader of that role.
void read_as_said(LoadedFile& file, const io::TableLayout& layout) {
    file.plan = io::match_columns(layout, *file.as.kind, file.as.overrides);
    const auto has = [&](const char* name) { return file.plan.find(name) != nullptr; };
    const bool complete = *file.as.kind == io::TableKind::Imu
                              ? (has("gyro_x_rad_s") && has("accel_x_m_s2")) || has("dtheta_x_rad")
                          : *file.as.kind == io::TableKind::Gnss ? has("lat_deg") && has("lon_deg")
                          : *file.as.kind == io::TableKind::Baro ? has("height_m") || has("pressure_pa")
                          : *file.as.kind == io::TableKind::Mag  ? has("mag_x_ut")
                                                                 : true;
    if (!has("time_s") || !complete) return;
    file.table = file.as.kind;
    file.report.kind = io::name_of(*file.table);
    read_table(file, layout);
    judge_time_unit(file, layout);
}

/// Wheel speed, or heading, by the names of the interface: these logs have no other names.
bool recognise_plain_companion(LoadedFile& file, const io::TableLayout& layout) {
    const auto is = [&](const char* value, const char* sigma) {
        const auto known = [&](const std::string& name) { return name == "time_s" || name == value || name == sigma; };
        const auto has = [&](const char* name) { return std::ranges::find(layout.names, name) != layout.names.end(); };
        return has("time_s") && has(value) && std::ranges::all_of(layout.names, known);
    };
    const char* kind = is("speed_m_s", "std_m_s") ? "odometer" : is("heading_deg", "std_deg") ? "heading" : nullptr;
    if (kind == nullptr) return false;
    file.report.kind = kind;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        io::ColumnMatch match;
        match.canonical = match.file_name = layout.names[i];
        match.column = static_cast<int>(i);
        match.unit_stated = true;
        file.plan.matches.push_back(match);
    }
    read_table(file, layout);
    return true;
}

/// The archiver or compression of a file by its signature; empty for any other file.
std::string_view packed_with(std::string_view bytes) {
    using namespace std::string_view_literals;
    static constexpr std::array signatures = {std::pair("PK\3\4"sv, "zip"sv),
                                              std::pair("7z\xbc\xaf\x27\x1c"sv, "7z"sv),
                                              std::pair("\xfd"
                                                        "7zXZ\0"sv,
                                                        "xz"sv),
                                              std::pair("\x28\xb5\x2f\xfd"sv, "zstd"sv),
                                              std::pair("Rar!\x1a\x07"sv, "rar"sv),
                                              std::pair("\x04\x22\x4d\x18"sv, "lz4"sv)};
    for (const auto& [signature, name] : signatures)
        if (bytes.starts_with(signature)) return name;
    if (bytes.starts_with("BZh") && bytes.size() > 4 && bytes.substr(4).starts_with("1AY&SY")) return "bzip2";
    constexpr std::size_t place_of_tar = 257;
    return bytes.size() > place_of_tar && bytes.substr(place_of_tar).starts_with("ustar") ? "tar" : "";
}

/// The format of several instruments usual for files of this extension.
const io::Format* format_by_name(const std::string& extension) {
    if (extension.empty() || extension == ".log" || extension == ".txt" || extension == ".bin" || extension == ".out")
        return nullptr;  // of anything
    for (const io::Format* format : io::formats()) {
        if (format->read == nullptr) continue;
        const std::string names = fmt::format(" {} ", format->extensions);
        if (names.find(fmt::format(" {} ", extension)) != std::string::npos) return format;
    }
    return nullptr;
}

/// Columns of other instruments in the table of one: they are read only if the table is named for them.
void tell_other_instruments(LoadedFile& file, const io::TableLayout& layout) {
    const auto unused = [&](const io::ColumnMatch* match) {
        return match != nullptr && std::ranges::find(file.plan.unused, match->file_name) != file.plan.unused.end();
    };
    const auto tell = [&](io::TableKind kind, std::initializer_list<const char*> needed, const char* what) {
        if (file.table == kind) return;
        const io::ColumnPlan plan = io::match_columns(layout, kind);
        std::string names;
        for (const char* name : needed) {
            const io::ColumnMatch* match = plan.find(name);
            if (!unused(match)) return;
            names += (names.empty() ? "" : ", ") + match->file_name;
        }
        file.problem(Level::Info, fmt::format("has columns of {} too, which are not used: {}", what, names),
                     fmt::format("to use them: [{}] file = {}", io::name_of(kind), toml_text(file.report.path)));
    };
    if (file.table != io::TableKind::Imu && file.table != io::TableKind::Gnss) return;
    if (file.table != io::TableKind::Imu)  // there they are used: beside_imu.h
        tell(io::TableKind::Mag, {"mag_x_ut", "mag_y_ut", "mag_z_ut"}, "a magnetometer");
    tell(io::TableKind::Baro, {"pressure_pa"}, "a barometer");
    std::string speeds, headings;
    for (const std::string& name : file.plan.unused) {
        const std::vector<std::string> words = io::words_of_name(name);
        const auto has = [&](std::initializer_list<std::string_view> any) {
            return std::ranges::any_of(words, [&](const std::string& w) { return std::ranges::find(any, w) != any.end(); });
        };
        if (has({"wheel", "wheels", "odometer", "odo", "odometry", "obd", "can"})) speeds += (speeds.empty() ? "" : ", ") + name;
        if (has({"heading", "yaw", "compass", "azimuth"})) headings += (headings.empty() ? "" : ", ") + name;
    }
    if (!speeds.empty())
        file.problem(Level::Info, fmt::format("has columns that look like an odometer's, which are not used: {}", speeds),
                     "to use one: a table time_s,speed_m_s,std_m_s of its own, [odometer] file = ...");
    if (!headings.empty())
        file.problem(Level::Info, fmt::format("has columns that look like headings, which are not used: {}", headings),
                     "to use one that is measured: a table time_s,heading_deg,std_deg of its own, [heading] file = ...");
}

/// The GPS week of the first row, where a column beside the seconds of the week has it. Weeks counted modulo 1024 date nothing.
void take_week(LoadedFile& file, const io::TableLayout& layout) {
    constexpr int first_usable = 1024, last_usable = 6000;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const std::string& name = layout.names[i];
        std::string words;
        for (const std::string& word : io::words_of_name(name)) words += word;
        static constexpr std::array known = {"week", "gpsweek", "weekno", "weeknumber", "gpsweekno", "gpsweeknumber", "gwk"};
        const auto unused = std::ranges::find(file.plan.unused, name);
        if (unused == file.plan.unused.end() || std::ranges::find(known, words) == known.end()) continue;
        const auto row =
            std::ranges::find_if(layout.sample, [&](const auto& r) { return i < r.size() && !io::is_missing_value(r[i]); });
        const double week = row != layout.sample.end() ? io::number_from((*row)[i]) : 0.0;
        if (!(week >= first_usable && week <= last_usable) || week != std::floor(week)) continue;
        file.week = static_cast<int>(week);
        file.week_column = name;
        file.plan.unused.erase(unused);
        return;
    }
}

void recognise_table(LoadedFile& file) {
    const io::TextInput input(file.path);
    io::TableLayout layout = io::inspect_table(input);
    file.report.columns = layout.names;
    if (file.as.kind && (!layout.names.empty() || !file.as.overrides.columns.empty())) {
        read_as_said(file, layout);
        return;
    }
    if (layout.names.empty()) {
        if (!recognise_without_header(file, layout)) {
            if (layout.columns >= 2)
                file.problem(Level::Info, fmt::format("{} columns without a header line, not recognised", layout.columns),
                             "put a header line that names the columns first");
            return;
        }
        for (const auto& match : file.plan.matches) file.report.columns.push_back(match.canonical);
        for (int i = static_cast<int>(file.report.columns.size()); i < layout.columns; ++i)
            file.report.columns.push_back(fmt::format("#{}", i + 1));
        read_table(file, layout);
        return;
    }
    if (recognise_plain_companion(file, layout)) return;
    file.table = io::guess_table_kind(layout);
    const auto has_blank = [](const std::vector<std::string>& row) { return std::ranges::any_of(row, &std::string::empty); };
    if (!file.table && std::ranges::any_of(layout.sample, has_blank)) {
        // Columns that are blank in the first rows (a marker not yet seen) are included.
        layout.sample.clear();
        file.table = io::guess_table_kind(layout);
    }
    if (!file.table) {
        const Nearly table = nearly(layout);
        file.report.resembles = table.kind;
        file.problem(table.hint.empty() ? Level::Info : Level::Warning, table.text, table.hint);
        return;
    }
    file.report.kind = io::name_of(*file.table);
    file.plan = io::match_columns(layout, *file.table);
    if (file.table == io::TableKind::Reference && io::is_own_frame(layout)) {
        file.report.kind = "trajectory";
        file.report.contents.emplace_back("attitude and position in a local frame that is unrelated to the other logs");
    }
    read_table(file, layout);
    judge_time_unit(file, layout);
    if (const auto [reason, hint] = implausible(file); !reason.empty()) {
        file.report.kind = "unknown";
        file.table.reset();
        file.problem(Level::Warning, reason, hint);
        return;
    }
    take_week(file, layout);
    tell_other_instruments(file, layout);
    if (file.report.kind == "trajectory") file.table.reset();
}

}  // namespace

void judge_time_unit(LoadedFile& file, const io::TableLayout& layout) {
    const auto match =
        std::find_if(file.plan.matches.begin(), file.plan.matches.end(), [](const auto& m) { return m.canonical == "time_s"; });
    if (match->unit_stated || file.time_ns.size() < 3 || match->time_unit != io::TimeUnit::Seconds) return;
    const auto column = static_cast<std::size_t>(match->column);
    const auto is_text = [&](const std::vector<std::string>& row) {  // a date or a time of day needs no unit
        return column < row.size() && std::isnan(io::number_from(row[column])) && !io::is_missing_value(row[column]);
    };
    if (std::ranges::any_of(layout.sample, is_text)) return;
    std::vector<double> steps;
    for (std::size_t i = 1; i < std::min<std::size_t>(file.time_ns.size(), 2000); ++i) {
        const double step = static_cast<double>(file.time_ns[i] - file.time_ns[i - 1]) * 1e-9;
        if (step > 0.0) steps.push_back(step);
    }
    // Instruments sample every 0.1 ms to 2 s: a median interval of 10 is 10 ms and one of 10000 is 10 ms in microseconds.
    const double step = steps.empty() ? 0.0 : median(std::move(steps));
    const bool slow = file.table == io::TableKind::Gnss || file.table == io::TableKind::Reference;
    const bool fast =
        file.table == io::TableKind::Imu;  // at least four samples per second: 250 is 250 us and not a quarter of a second
    io::TimeUnit unit = io::TimeUnit::Seconds;
    if (step >= (slow ? 40.0 : 2.5)) unit = io::TimeUnit::Milliseconds;
    if (step >= (slow ? 20'000.0 : fast ? 250.0 : 1'200.0)) unit = io::TimeUnit::Microseconds;
    if (step >= 1e6 * (slow ? 20.0 : fast ? 0.25 : 1.2)) unit = io::TimeUnit::Nanoseconds;
    if (unit == io::TimeUnit::Seconds) return;
    const char* name = unit == io::TimeUnit::Milliseconds   ? "milliseconds"
                       : unit == io::TimeUnit::Microseconds ? "microseconds"
                                                            : "nanoseconds";
    match->time_unit = unit;
    file.time_ns.clear();
    file.columns.clear();
    file.fix.clear();
    read_table(file, layout);
    file.time_unit_judged = unit;
    file.problem(Level::Warning, fmt::format("column {} does not state its unit; its steps indicate {}", match->file_name, name),
                 fmt::format("rename it to {}_{}", match->file_name,
                             unit == io::TimeUnit::Milliseconds   ? "ms"
                             : unit == io::TimeUnit::Microseconds ? "us"
                                                                  : "ns"));
}

bool is_table_of_another(const std::filesystem::path& path, io::TableKind named) {
    if (named != io::TableKind::Mag && named != io::TableKind::Baro) return false;
    try {
        const io::Format* format = io::format_of(path);
        if (format == nullptr || format->read != nullptr) return false;
        const std::optional<io::TableKind> own = io::guess_table_kind(io::inspect_table(io::TextInput(path)));
        return own == io::TableKind::Imu || own == io::TableKind::Gnss;
    } catch (const Error&) {
        return false;  // the reader of its role reports it
    }
}

void recognise_and_read(LoadedFile& file) {
    io::check_regular_file(file.path);
    const io::FileHead head(file.path);
    if (head.bytes.empty()) {
        file.problem(Level::Error, "the file is empty", "check that the log was written and copied completely");
        return;
    }
    if (const std::string_view method = packed_with(head.bytes); !method.empty()) {
        file.report.kind = "archive";
        file.problem(Level::Warning, fmt::format("is packed with {}, and not read", method),
                     head.extension == ".xlsx" || head.extension == ".ods"
                         ? "save the sheet as CSV"
                         : "unpack it beside the other logs (of compressed files only .gz is read)");
        return;
    }
    const io::RawFormat raw = io::raw_format(file.path);
    if (raw != io::RawFormat::None && read_raw(file, raw)) return;
    const io::Format* format = io::format_of(file.path);
    if (format != nullptr && format->name == "ubx" && raw == io::RawFormat::Ubx)
        format = io::format_named("nmea");  // the better format
    if (head.bytes.substr(0, 200).find("RINEX VERSION") != std::string::npos) {
        file.report.kind = "rinex";
        file.problem(Level::Info, "RINEX of another kind than observations and navigation", "");
    } else if (format == nullptr) {
        if (const io::Format* by_name = format_by_name(head.extension))
            file.problem(
                Level::Error,
                fmt::format("is not a {} although its name suggests one: its content is different, or damaged at the beginning",
                            by_name->title),
                "copy the log completely; `schuler help formats` lists what is read");
        else file.problem(Level::Info, "a binary file of no known format", "");
    } else if (format->name == "sp3") {
        read_precise_orbits(file);
    } else if (format->name == "antex") {
        read_antennas(file);
    } else if (format->name == "adsb") {
        read_squitters(file);
    } else if (format->name == "kfgins_yaml" || format->name == "dataset_toml") {
        file.report.kind = format->name;
    } else if (format->read != nullptr) {
        read_one_stream(file, *format);
    } else if (head.extension == ".yaml" || head.extension == ".yml") {
        file.problem(Level::Info, "a YAML file without imupath and gnsspath", "");
    } else {
        recognise_table(file);
    }
}

}  // namespace schuler::inspect::detail
