// IGC files of gliders' flight recorders: the fixes and pressure altitudes of their B records (FAI/IGC, Technical Specification for GNSS
// Flight Recorders, appendix A).
#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace schuler::io {
namespace {

constexpr std::size_t fix_length = 35;  // of a B record without additions
constexpr std::int64_t one_second = 1'000'000'000, one_day = 86'400 * one_second;

/// The digits [from, from + count) of a record; negative if there are others than digits.
std::int64_t digits(std::string_view record, std::size_t from, std::size_t count) {
    const std::string_view text = columns_of(record, from, count);
    return text.size() == count ? detail::small_integer(text).value_or(-1) : -1;
}

/// An altitude of five characters, m: "00512", "-0012".
double altitude(std::string_view record, std::size_t from) {
    const bool below = record[from] == '-';
    const std::int64_t value = below ? digits(record, from + 1, 4) : digits(record, from, 5);
    return value < 0 ? not_given : (below ? -1.0 : 1.0) * static_cast<double>(value);
}

/// Places of the additions to B records, by their three letters.
struct Additions {
    struct Place {
        std::size_t from = 0, count = 0;
    };
    std::map<std::string, Place, std::less<>> places;

    /// Of an I record: the number of additions, then for each its first and last column, counted from one, and its letters.
    void read(std::string_view record) {
        for (std::size_t at = 3; at + 7 <= record.size(); at += 7) {
            const std::int64_t first = digits(record, at, 2), last = digits(record, at + 2, 2);
            if (first <= static_cast<std::int64_t>(fix_length) || last < first) return;
            places[std::string(record.substr(at + 4, 3))] = {static_cast<std::size_t>(first - 1),
                                                             static_cast<std::size_t>(last - first + 1)};
        }
    }
    /// Negative if a record has none or it is no number.
    [[nodiscard]] std::int64_t of(std::string_view record, std::string_view letters) const {
        const auto it = places.find(letters);
        return it == places.end() ? -1 : digits(record, it->second.from, it->second.count);
    }
    /// A fraction of one with as many decimals as the addition has digits: TDS, LAD, LOD.
    [[nodiscard]] double fraction(std::string_view record, std::string_view letters) const {
        const std::int64_t value = of(record, letters);
        return value < 0 ? 0.0
                         : static_cast<double>(value) / std::pow(10.0, static_cast<double>(places.find(letters)->second.count));
    }
};

struct Fix {
    std::int64_t time_of_day = 0;  ///< ns, UTC
    double lat = 0.0, lon = 0.0;   ///< deg
    double pressure_altitude = not_given, height = not_given, std = not_given, satellites = not_given;
    bool valid = false;  ///< three-dimensional
};

/// Degrees of "4807038N" or "01131000E"; the minutes have three decimals, and further ones in an addition.
std::optional<double> angle(std::string_view record, std::size_t from, std::size_t degree_digits, std::string_view hemispheres,
                            double more) {
    const std::int64_t degrees = digits(record, from, degree_digits), minutes = digits(record, from + degree_digits, 5);
    const std::size_t hemisphere = hemispheres.find(record[from + degree_digits + 5]);
    if (degrees < 0 || minutes < 0 || minutes >= 60'000 || hemisphere == std::string_view::npos) return std::nullopt;
    const double value = static_cast<double>(degrees) + (static_cast<double>(minutes) + more) / 60'000.0;
    if (value > (degree_digits == 2 ? 90.0 : 180.0)) return std::nullopt;
    return hemisphere == 0 ? value : -value;
}

std::optional<Fix> fix_of(std::string_view record, const Additions& additions) {
    if (record.size() < fix_length || record[0] != 'B') return std::nullopt;
    const std::int64_t h = digits(record, 1, 2), min = digits(record, 3, 2), s = digits(record, 5, 2);
    const auto lat = angle(record, 7, 2, "NS", additions.fraction(record, "LAD"));
    const auto lon = angle(record, 15, 3, "EW", additions.fraction(record, "LOD"));
    const char validity = record[24];
    if (h < 0 || h > 23 || min < 0 || min > 59 || s < 0 || s > 60 || !lat || !lon || (validity != 'A' && validity != 'V'))
        return std::nullopt;
    Fix fix;
    fix.time_of_day = (h * 3600 + min * 60 + s) * one_second + std::llround(additions.fraction(record, "TDS") * one_second);
    fix.lat = *lat;
    fix.lon = *lon;
    fix.pressure_altitude = altitude(record, 25);
    fix.valid = validity == 'A';
    if (fix.valid) fix.height = altitude(record, 30);
    // the estimated error of the position in metres, two sigma; three nines where the recorder has none
    const std::int64_t error = additions.of(record, "FXA"), satellites = additions.of(record, "SIU");
    if (error > 0 && error < 999) fix.std = 0.5 * static_cast<double>(error);
    if (satellites >= 0) fix.satellites = static_cast<double>(satellites);
    return fix;
}

/// The date of "HFDTE150121" or "HFDTEDATE:150121,01" as GPS time of its UTC midnight.
std::optional<Time> midnight_of(std::string_view record) {
    if (record.size() < 5 || record[0] != 'H' || record.substr(2, 3) != "DTE") return std::nullopt;
    const std::size_t first = record.find_first_of("0123456789", 5);
    if (first == std::string_view::npos) return std::nullopt;
    const std::int64_t day = digits(record, first, 2), month = digits(record, first + 2, 2), year = digits(record, first + 4, 2);
    // the GPS week begins in 1980
    const int full = static_cast<int>(year) + (year < 80 ? 2000 : 1900);
    if (day < 0 || month < 0 || year < 0 || !detail::is_date(full, static_cast<int>(month), static_cast<int>(day)))
        return std::nullopt;
    return gps_from_utc({full, static_cast<int>(month), static_cast<int>(day), 0, 0, 0.0});
}

/// Reference of the GNSS altitudes of "HFALGALTGPS:ELL" or "HFALG:GEO"; recorders without the record differ.
std::string_view height_column(std::string_view bytes) {
    const std::size_t at = bytes.find("\nHFALG");
    const std::string_view record =
        at == std::string_view::npos ? std::string_view() : bytes.substr(at, bytes.find('\n', at + 1) - at);
    return record.find("ELL") != std::string_view::npos   ? "height_ellipsoidal_m"
           : record.find("GEO") != std::string_view::npos ? "height_msl_m"
                                                          : "height_m";
}

bool is_igc(const FileHead& head) {
    bool recorder = false, dated = false;
    for (Lines lines(head.bytes); lines.next();) {
        const std::string_view line = lines.line();
        if (line.empty()) continue;
        if (!recorder && line[0] != 'A') return false;
        recorder = true;
        dated = dated || midnight_of(line);
        if (line[0] == 'B') return dated && fix_of(line, {});
    }
    return dated && head.extension == ".igc";
}

StreamLog read_igc(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    Stream gnss("gnss", TableKind::Gnss, "B", {"lat_deg", "lon_deg", height_column(bytes).data(), "std_h_m", "satellites"});
    Stream baro("baro", TableKind::Baro, "B", {"height_m"});
    Additions additions;
    std::optional<Time> midnight;
    std::int64_t before = 0, days = 0;
    std::size_t damaged = 0, invalid = 0;
    long first_damaged = 0;
    bool has_baro = false;
    for (Lines lines(bytes); lines.next();) {
        const std::string_view line = lines.line();
        if (line.starts_with('I')) additions.read(line);
        else if (const auto date = midnight_of(line); date && !midnight) midnight = date;
        if (!line.starts_with('B')) continue;
        const auto fix = fix_of(line, additions);
        if (!fix) {
            if (damaged++ == 0) first_damaged = lines.number();
            continue;
        }
        if (!midnight)
            throw input_error("has fixes before a date", place_in(input.name(), lines.number()),
                              "the record HFDTE with day, month and year is missing: add it, such as HFDTE150121");
        if (fix->time_of_day + one_day / 2 < before) ++days;
        before = fix->time_of_day;
        const std::int64_t ns = midnight->ns + days * one_day + fix->time_of_day;
        invalid += fix->valid ? 0 : 1;
        gnss.add(ns, {fix->lat, fix->lon, fix->height, fix->std, fix->satellites});
        gnss.fix.push_back(fix->valid ? FixType::Autonomous : FixType::None);
        baro.add(ns, {fix->pressure_altitude});
        has_baro = has_baro || (std::isfinite(fix->pressure_altitude) && fix->pressure_altitude != 0.0);
    }
    if (gnss.rows() == 0) throw input_error("holds no fix", place_in(input.name(), first_damaged), "fixes are B records");
    if (damaged > 0)
        warnings.add(input.name() + " igc.damaged",
                     fmt::format("{}: damaged B records, the first in line {}: skipped", input.name(), first_damaged), damaged);
    StreamLog log;
    log.clock = Clock::Gps;
    if (invalid > 0) log.contents.push_back(fmt::format("{} fixes without height or satellites (V), not used", invalid));
    log.add(std::move(gnss));
    if (has_baro) log.add(std::move(baro));
    return log;
}

}  // namespace

extern const Format igc_format;
const Format igc_format = {.name = "igc",
                           .title = "IGC file of a flight recorder",
                           .extensions = ".igc",
                           .holds = "fixes with their estimated error and satellites, and pressure altitudes (B records)",
                           .time = "UTC, as GPS time",
                           .recognise = is_igc,
                           .read = read_igc};

}  // namespace schuler::io
