// Trajectories of survey programs as text: Inertial Explorer and Waypoint exports, by their column names; KITTI's oxts folders.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace schuler::io {
namespace {

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        const std::size_t start = line.find_first_not_of(" \t,");
        if (start == std::string_view::npos) return words;
        line.remove_prefix(start);
        const std::size_t end = std::min(line.find_first_of(" \t,"), line.size());
        words.push_back(line.substr(0, end));
        line.remove_prefix(end);
    }
}

/// A column of an export: the start of its name in the header, its quantity, and the factor.
struct Export {
    std::string_view name;
    const char* column;
    double factor = 1.0;
    std::size_t parts = 1;  ///< degrees, minutes, seconds: three
};
constexpr std::array exports = {Export{"GPSTime", "time"},
                                Export{"Week", "week"},
                                Export{"Latitude", "lat_deg"},
                                Export{"Longitude", "lon_deg"},
                                Export{"H-Ell", "height_ellipsoidal_m"},
                                Export{"VNorth", "vel_n_m_s"},
                                Export{"VEast", "vel_e_m_s"},
                                Export{"VUp", "vel_d_m_s", -1.0},
                                Export{"Heading", "heading_deg"},
                                Export{"Pitch", "pitch_deg"},
                                Export{"Roll", "roll_deg"},
                                Export{"SDNorth", "std_n_m"},
                                Export{"SDEast", "std_e_m"},
                                Export{"SDHeight", "std_d_m"}};

const Export* export_of(std::string_view name) {
    const auto it = std::ranges::find(exports, name, &Export::name);
    return it == exports.end() ? nullptr : &*it;
}

/// The header line has at least time, latitude and longitude.
std::vector<std::string_view> export_header(std::string_view text) {
    for (Lines lines(text); lines.next() && lines.number() < 200;) {
        std::vector<std::string_view> words = words_of(lines.line());
        const auto has = [&](std::string_view name) { return std::ranges::find(words, name) != words.end(); };
        if (has("GPSTime") && has("Latitude") && has("Longitude")) return words;
    }
    return {};
}

StreamLog read_waypoint(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    const std::vector<std::string_view> header = export_header(bytes);
    if (header.empty())
        throw input_error("has no header with GPSTime, Latitude and Longitude", place_in(input.name()), "export with a header");
    Stream s("reference", TableKind::Reference, "export", {});
    std::vector<const Export*> columns;
    for (const std::string_view name : header) columns.push_back(export_of(name));
    for (const Export* e : columns)
        if (e != nullptr && std::string_view(e->column) != "time" && std::string_view(e->column) != "week" &&
            s.find(e->column) == nullptr)
            s.columns.push_back({e->column, {}});
    const auto is_angle = [](const Export* e) { return e != nullptr && (e->name == "Latitude" || e->name == "Longitude"); };
    const auto in_minutes = 2 * static_cast<std::size_t>(std::ranges::count_if(
                                    columns, is_angle));  // more words if angles are degrees, minutes, seconds
    std::size_t bad = 0;
    long first_bad = 0;
    bool weeks = false, seen = false;
    for (Lines lines(bytes); lines.next();) {
        std::vector<std::string_view> words = words_of(lines.line());
        if (!seen) {
            seen = words == header;
            continue;
        }
        if (words.empty() || words.front().front() == '(') continue;  // units
        const std::size_t extra = words.size() > columns.size() ? words.size() - columns.size() : 0;
        if (words.size() < columns.size() || (extra != 0 && extra != in_minutes)) {
            if (bad++ == 0) first_bad = lines.number();
            continue;
        }
        double time = not_given, week = not_given;
        std::vector<std::pair<const Export*, double>> row;
        std::size_t at = 0;
        for (const Export* e : columns) {
            double value = number_from(words[at]);
            if (extra != 0 && is_angle(e)) {
                const double minutes = number_from(words[at + 1]), seconds = number_from(words[at + 2]);
                value =
                    std::copysign(std::abs(value) + minutes / 60.0 + seconds / 3600.0, words[at].starts_with('-') ? -1.0 : 1.0);
                at += 2;
            }
            ++at;
            if (e == nullptr) continue;
            if (e->name == "GPSTime") time = value;
            else if (e->name == "Week") week = value;
            else row.emplace_back(e, value * e->factor);
        }
        const bool is_week = week >= 0.0 && week < 7'500.0;
        if (!std::isfinite(time) || std::abs(time) > 4e9 || (std::isfinite(week) && !is_week)) {
            if (bad++ == 0) first_bad = lines.number();
            continue;
        }
        weeks = weeks || (is_week && week > 0.0);
        s.time_ns.push_back(weeks && std::isfinite(week) ? Time::from_gps(static_cast<int>(week), time).ns
                                                         : Time::from_seconds(time).ns);
        for (Stream::Column& c : s.columns) {
            const auto it = std::ranges::find_if(row, [&](const auto& entry) { return entry.first->column == c.name; });
            c.values.push_back(it == row.end() ? not_given : it->second);
        }
    }
    if (bad > 0)
        warnings.add(input.name() + " waypoint.bad",
                     fmt::format("{}: damaged rows, the first in line {}: skipped", input.name(), first_bad), bad);
    StreamLog log;
    log.clock = weeks ? Clock::Gps : Clock::SecondsOfWeek;
    if (s.find("roll_deg") == nullptr) {  // a satellite-only solution
        s.name = "gnss";
        s.kind = TableKind::Gnss;
    }
    log.add(std::move(s));
    if (log.streams.empty()) throw input_error("has no row below its header", place_in(input.name()), "export it again");
    return log;
}

/// KITTI: a folder with timestamps.txt and data/0000000000.txt, ..., thirty numbers each.
StreamLog read_kitti(const TextInput& input, WarningLog& warnings) {
    const std::filesystem::path folder = input.name();
    const std::string times = read_bytes(TextInput(folder / "timestamps.txt"));
    Stream imu("imu", TableKind::Imu, "wx, wy, wz, ax, ay, az",
               {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
    Stream gnss("gnss", TableKind::Gnss, "lat, lon, alt, vn, ve",
                {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "std_h_m", "std_vel_m_s", "satellites"});
    Stream reference(
        "reference", TableKind::Reference, "roll, pitch, yaw",
        {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "roll_deg", "pitch_deg", "heading_deg"});
    std::size_t bad = 0, index = 0;
    std::string first_bad;
    for (Lines lines(times); lines.next(); ++index) {
        const std::string line(lines.line());
        int year = 0, month = 0, day = 0, hour = 0, minute = 0;
        double second = 0.0;
        const std::filesystem::path file = folder / "data" / fmt::format("{:010}.txt", index);
        std::array<double, 30> v{};
        std::size_t n = 0;
        if (std::sscanf(line.c_str(), "%4d-%2d-%2d %2d:%2d:%lf", &year, &month, &day, &hour, &minute, &second) == 6 &&
            detail::is_date(year, month, day)) {
            std::error_code ec;
            const std::string text = std::filesystem::exists(file, ec) ? read_bytes(TextInput(file), 65'536) : std::string();
            for (const std::string_view word : words_of(std::string_view(text).substr(0, text.find('\n')))) {
                if (n == v.size()) break;
                v[n++] = number_from(word);
            }
        }
        if (n < 25) {
            if (!line.empty() && bad++ == 0) first_bad = file.string();
            continue;
        }
        // no time zone is stated: taken as UTC, which causes no relative shift
        const double whole = std::floor(second);
        const std::int64_t t = gps_from_utc({year, month, day, hour, minute, whole}).ns + std::llround((second - whole) * 1e9);
        imu.add(t, {v[17], -v[18], -v[19], v[11], -v[12], -v[13]});  // forward-left-up to forward-right-down
        gnss.add(t, {v[0], v[1], v[2], v[6], v[7], v[23], v[24], v[26]});
        reference.add(t, {v[0], v[1], v[2], v[6], v[7], v[3] / units::deg, -v[4] / units::deg,
                          std::fmod(450.0 - v[5] / units::deg, 360.0)});
    }
    if (bad > 0)
        warnings.add(input.name() + " kitti.bad",
                     fmt::format("samples that are missing or damaged, the first {}: skipped", first_bad), bad);
    StreamLog log;
    log.clock = Clock::Gps;
    log.add(std::move(imu));
    log.add(std::move(gnss));
    log.add(std::move(reference));
    if (log.streams.empty())
        throw input_error("holds no sample of an OXTS unit", place_in(input.name()),
                          "the folder has timestamps.txt and data/0000000000.txt, ...");
    return log;
}

}  // namespace

extern const Format waypoint_format, kitti_format;
const Format waypoint_format = {
    .name = "waypoint",
    .title = "Inertial Explorer, Waypoint text",
    .extensions = ".txt .pos",
    .holds =
        "exports with a header: `GPSTime`, `Week`, `Latitude`, `Longitude` (degrees, or degrees, minutes, seconds), `H-Ell`, `VNorth`, `VEast`, `VUp`, `Heading`, `Pitch`, "
        "`Roll`, `SDNorth`, `SDEast`, `SDHeight` as reference; without attitude as fixes",
    .time = "GPS time, or seconds of the week without `Week`",
    .recognise =
        [](const FileHead& head) { return head.bytes.find('\0') == std::string::npos && !export_header(head.bytes).empty(); },
    .read = read_waypoint};
const Format kitti_format = {
    .name = "kitti",
    .title = "KITTI oxts",
    .extensions = "(folder)",
    .holds =
        "a folder with `timestamps.txt` and `data/`: IMU, position and velocity, attitude as reference, all of one OXTS unit",
    .time = "the stamps, taken as UTC",
    .recognise =
        [](const FileHead& head) {
            std::error_code ec;
            return std::filesystem::exists(head.path / "timestamps.txt", ec) &&
                   std::filesystem::exists(head.path / "data" / "0000000000.txt", ec);
        },
    .read = read_kitti,
    .folder = true};

}  // namespace schuler::io
