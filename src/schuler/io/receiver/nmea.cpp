#include "schuler/io/receiver/nmea.h"

#include "schuler/core/units.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/solution/receiver_text.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/detail/first_lines.h"
#include "schuler/io/text/detail/sample_rows.h"
#include "schuler/io/text/fix_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace schuler::io {
namespace {

constexpr double knot = 1852.0 / 3600.0;  // m/s
constexpr std::int64_t ns_per_day = 86'400 * detail::ns_per_second;

using Fields = std::vector<std::string_view>;

int hex_value(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
}

/// The fields of a sentence between '$' and '*' if the checksum is correct.
std::optional<Fields> checked_fields(std::string_view line) {
    const std::size_t star = line.find('*');
    if (star == std::string_view::npos || star + 2 >= line.size() || line.size() > 512) return std::nullopt;
    unsigned sum = 0;
    for (const char c : line.substr(1, star - 1)) sum ^= static_cast<unsigned char>(c);
    if (hex_value(line[star + 1]) != static_cast<int>(sum >> 4) || hex_value(line[star + 2]) != static_cast<int>(sum & 15U))
        return std::nullopt;
    Fields fields;
    for (std::string_view rest = line.substr(1, star - 1);;) {
        const std::size_t comma = rest.find(',');
        fields.push_back(trimmed(rest.substr(0, comma)));
        if (comma == std::string_view::npos) return fields;
        rest.remove_prefix(comma + 1);
    }
}

std::string_view field(const Fields& f, std::size_t i) { return i < f.size() ? f[i] : std::string_view{}; }
double number(const Fields& f, std::size_t i) { return number_from(field(f, i)); }

/// ddmm.mmmm and a hemisphere, rad.
double angle(const Fields& f, std::size_t i, double limit_deg) {
    const double value = number(f, i);
    const std::string_view side = field(f, i + 1);
    if (!(value >= 0.0) || side.size() != 1) return not_given;
    const double whole = std::floor(value / 100.0);
    const double minutes = value - 100.0 * whole;
    const double deg = whole + minutes / 60.0;
    if (minutes >= 60.0 || deg > limit_deg) return not_given;
    const char s = side.front();
    if (s != 'N' && s != 'S' && s != 'E' && s != 'W') return not_given;
    return (s == 'S' || s == 'W' ? -deg : deg) * units::deg;
}

std::optional<detail::MinuteAndRest> clock(std::string_view hhmmss) {
    if (hhmmss.size() < 6) return std::nullopt;
    return detail::time_of_day(hhmmss.substr(0, 2), hhmmss.substr(2, 2), hhmmss.substr(4));
}

std::int64_t ns_of_day(const detail::MinuteAndRest& t) {
    return (t.hour * 3600 + t.minute * 60) * detail::ns_per_second + t.rest_ns;
}

/// Midnight of a UTC date as nanoseconds since 1980-01-06 counted without leap seconds.
std::int64_t midnight(int year, int month, int day) { return gps_from_calendar({year, month, day, 0, 0, 0.0}).ns; }

/// Data of the sentences of one time of day.
struct Epoch {
    std::int64_t time_of_day = -1;
    int day = 0;                       ///< number of midnights since the start of the log
    std::optional<std::int64_t> date;  ///< midnight, if given by a sentence
    double lat = not_given, lon = not_given, msl = not_given, separation = not_given;
    double speed = not_given, course = not_given;
    Eigen::Vector3d std_position = not_given3();
    FixType fix = FixType::Unknown;
    bool invalid = false;  ///< a sentence states that there is no fix
    int satellites = -1;
};

FixType fix_from_mode(char mode) {
    switch (mode) {
        case 'A':
        case 'P': return FixType::Autonomous;
        case 'D': return FixType::Differential;
        case 'R': return FixType::RtkFixed;
        case 'F': return FixType::RtkFloat;
        case 'N':
        case 'E':
        case 'M':
        case 'S': return FixType::None;
        default: return FixType::Unknown;
    }
}

class NmeaReader {
public:
    void line(std::string_view text) {
        const std::size_t dollar = text.find('$');
        if (dollar == std::string_view::npos) return;
        const auto fields = checked_fields(trimmed(text.substr(dollar)));
        if (!fields || fields->front().size() < 5) {
            ++log.bad_sentences;
            return;
        }
        ++log.sentences;
        const std::string_view type = fields->front().substr(fields->front().size() - 3);
        bool good = true;
        if (fields->front().front() == 'P') return;  // proprietary
        if (type == "GGA") good = gga(*fields);
        else if (type == "GNS") good = gns(*fields);
        else if (type == "RMC") good = rmc(*fields);
        else if (type == "GST") good = gst(*fields);
        else if (type == "ZDA") good = zda(*fields);
        else if (type == "VTG") vtg(*fields);
        else if (type == "GSA") gsa(*fields);
        if (!good) ++log.bad_sentences;
    }

    void finish() {
        if (epoch_.time_of_day >= 0) epochs_.push_back(epoch_);
        date_epochs();
        for (const Epoch& e : epochs_) emit(e);
    }

    NmeaLog log;

private:
    /// Moves to the epoch of a sentence's time; false if the field is empty or damaged.
    bool at_time(std::string_view hhmmss) {
        const auto t = clock(hhmmss);
        if (!t) return false;
        const std::int64_t time = ns_of_day(*t);
        if (time == epoch_.time_of_day) return true;
        Epoch next;
        next.time_of_day = time;
        if (epoch_.time_of_day >= 0) {
            next.day = epoch_.day + (time < epoch_.time_of_day - ns_per_day / 2 ? 1 : 0);
            epochs_.push_back(epoch_);
        }
        epoch_ = next;
        return true;
    }

    bool gga(const Fields& f) {
        if (!at_time(field(f, 1))) return field(f, 1).empty();
        const auto quality = detail::small_integer(field(f, 6));
        if (!quality) return false;
        epoch_.fix = fix_from_nmea(*quality);
        if (epoch_.fix == FixType::None) return true;
        epoch_.satellites = detail::small_integer(field(f, 7)).value_or(-1);
        epoch_.msl = number(f, 9);
        epoch_.separation = number(f, 11);
        return position(f, 2);
    }

    bool gns(const Fields& f) {
        if (!at_time(field(f, 1))) return field(f, 1).empty();
        FixType best = FixType::None;
        for (const char mode : field(f, 6)) {
            const FixType fix = fix_from_mode(mode);
            const auto rank = [](FixType t) {
                return t == FixType::RtkFixed       ? 4
                       : t == FixType::RtkFloat     ? 3
                       : t == FixType::Differential ? 2
                       : t == FixType::Autonomous   ? 1
                                                    : 0;
            };
            if (rank(fix) > rank(best)) best = fix;
        }
        if (epoch_.fix == FixType::Unknown) epoch_.fix = best;
        if (best == FixType::None) return true;
        if (epoch_.satellites < 0) epoch_.satellites = detail::small_integer(field(f, 7)).value_or(-1);
        if (std::isnan(epoch_.msl)) {
            epoch_.msl = number(f, 9);
            epoch_.separation = number(f, 10);
        }
        return !std::isnan(epoch_.lat) || position(f, 2);
    }

    bool rmc(const Fields& f) {
        if (!at_time(field(f, 1))) return field(f, 1).empty();
        const std::string_view date = field(f, 9);
        if (date.size() == 6) {
            const auto d = detail::small_integer(date.substr(0, 2)), m = detail::small_integer(date.substr(2, 2)),
                       y = detail::small_integer(date.substr(4, 2));
            if (!d || !m || !y || !detail::is_date(*y + (*y < 80 ? 2000 : 1900), *m, *d)) return false;
            epoch_.date = midnight(*y + (*y < 80 ? 2000 : 1900), *m, *d);
        }
        if (field(f, 2) != "A") {
            epoch_.invalid = true;
            return field(f, 2) == "V";
        }
        epoch_.speed = number(f, 7) * knot;
        epoch_.course = number(f, 8) * units::deg;
        if (epoch_.fix == FixType::Unknown && !field(f, 12).empty()) epoch_.fix = fix_from_mode(field(f, 12).front());
        return !std::isnan(epoch_.lat) || position(f, 3);
    }

    bool gst(const Fields& f) {
        if (!at_time(field(f, 1))) return field(f, 1).empty();
        epoch_.std_position = {number(f, 6), number(f, 7), number(f, 8)};
        return true;
    }

    bool zda(const Fields& f) {
        if (!at_time(field(f, 1))) return field(f, 1).empty();
        const auto d = detail::small_integer(field(f, 2)), m = detail::small_integer(field(f, 3)),
                   y = detail::small_integer(field(f, 4));
        if (!d || !m || !y || !detail::is_date(*y, *m, *d)) return false;
        epoch_.date = midnight(*y, *m, *d);
        return true;
    }

    /// Has no time: belongs to the previous epoch.
    void vtg(const Fields& f) {
        if (epoch_.time_of_day < 0 || !std::isnan(epoch_.speed)) return;
        const double km_h = number(f, 7), knots = number(f, 5);
        epoch_.speed = std::isnan(km_h) ? knots * knot : km_h / 3.6;
        epoch_.course = number(f, 1) * units::deg;
    }

    void gsa(const Fields& f) {
        if (field(f, 2) == "1") epoch_.invalid = true;
    }

    bool position(const Fields& f, std::size_t i) {
        epoch_.lat = angle(f, i, 90.0);
        epoch_.lon = angle(f, i + 2, 180.0);
        return !std::isnan(epoch_.lat) && !std::isnan(epoch_.lon);
    }

    /// Assigns a date to every epoch: its own, else counted in midnights from the last one before it (or the first after it).
    void date_epochs() {
        std::optional<std::int64_t> base;
        for (const Epoch& e : epochs_) {
            if (e.date) {
                base = *e.date - e.day * ns_per_day;
                break;
            }
        }
        log.has_date = base.has_value();
        for (Epoch& e : epochs_) {
            if (e.date) base = *e.date - e.day * ns_per_day;
            e.date = base.value_or(0) + e.day * ns_per_day;
        }
    }

    void emit(const Epoch& e) {
        if (std::isnan(e.lat) && !e.invalid && e.fix == FixType::Unknown) return;  // only a date or a sigma
        ++log.rows.read;
        if (e.invalid || e.fix == FixType::None || std::isnan(e.lat) || std::isnan(e.lon)) {
            ++log.rows.without_fix;
            return;
        }
        GnssFix fix;
        constexpr std::int64_t minute = 60 * detail::ns_per_second;
        fix.time.ns = *e.date + e.time_of_day;
        if (log.has_date)
            fix.time.ns +=
                gps_minus_utc((*e.date + e.time_of_day / minute * minute) / detail::ns_per_second) * detail::ns_per_second;
        fix.position = {e.lat, e.lon, e.msl + (std::isnan(e.separation) ? 0.0 : e.separation)};
        if (std::isnan(e.separation) && !std::isnan(e.msl)) log.height = HeightKind::Msl;
        if (e.speed >= 0.0) {
            // A receiver at rest leaves the course field empty.
            if (!std::isnan(e.course)) fix.velocity_n = {e.speed * std::cos(e.course), e.speed * std::sin(e.course), not_given};
            else if (e.speed < 0.5) fix.velocity_n = {0.0, 0.0, not_given};
        }
        fix.std_position = e.std_position;
        fix.fix = e.fix;
        fix.satellites = e.satellites;
        log.fixes.push_back(fix);
    }

    std::vector<Epoch> epochs_;
    Epoch epoch_;
};

}  // namespace

NmeaLog read_nmea(const TextInput& input, WarningLog& log) {
    LineBlocks blocks(input);
    NmeaReader reader;
    while (blocks.next()) {
        for (const char* p = blocks.begin(); p < blocks.end();) {
            const char* stop = std::find(p, blocks.end(), '\n');
            reader.line({p, static_cast<std::size_t>(stop - p)});
            p = stop + 1;
        }
    }
    reader.finish();
    NmeaLog result = std::move(reader.log);
    if (result.fixes.empty()) {
        const std::string why =
            result.sentences == 0
                ? fmt::format("there is no sentence with a right checksum ({} with a wrong one)", result.bad_sentences)
                : fmt::format("none of the {} epochs has a fix", result.rows.read);
        throw input_error(why, place_in(input.name()), "is it an NMEA 0183 log with GGA, GNS or RMC?");
    }
    detail::RowAudit audit(input.name(), "gnss", log);
    audit.counts() = result.rows;
    for (std::size_t i = 1; i < result.fixes.size(); ++i)
        audit.counts().out_of_order += result.fixes[i].time < result.fixes[i - 1].time ? 1 : 0;
    audit.warn("nmea.bad", "sentences with a wrong or missing checksum or damaged fields: skipped", result.bad_sentences);
    audit.warn("nmea.no_fix", "epochs without a fix: skipped", result.rows.without_fix);
    audit.warn("nmea.date", "no sentence gives the date: times count from the first midnight", result.has_date ? 0 : 1);
    audit.warn("nmea.msl", "no geoid separation: heights are above mean sea level", result.height == HeightKind::Msl ? 1 : 0);
    audit.warn("out_of_order", "epochs earlier than the one before: sorted in", audit.counts().out_of_order);
    detail::put_in_time_order(result.fixes, audit, [](const GnssFix& a, const GnssFix& b) {
        return a.position.lat == b.position.lat && a.position.lon == b.position.lon &&
               detail::same_value(a.position.h, b.position.h);
    });
    result.rows = audit.counts();
    return result;
}

bool is_nmea(const TextInput& input) {
    try {
        LineBlocks blocks(input);
        for (const std::string_view line : detail::first_lines(blocks)) {
            const std::size_t dollar = line.find('$');
            if (dollar != std::string_view::npos && checked_fields(trimmed(line.substr(dollar)))) return true;
        }
    } catch (const Error&) {
        return false;
    }
    return false;
}

namespace {

StreamLog nmea_streams(const TextInput& input, WarningLog& warnings) {
    const NmeaLog nmea = read_nmea(input, warnings);
    StreamLog log;
    log.clock = nmea.has_date ? Clock::Gps : Clock::Boot;
    log.add(stream_of(nmea.fixes, nmea.height, "GGA, RMC, GNS, GST, VTG"));
    return log;
}

}  // namespace

extern const Format nmea_format;
const Format nmea_format = {
    .name = "nmea",
    .title = "NMEA 0183",
    .extensions = ".nmea .txt .log",
    .holds = "fixes of GGA, RMC, GNS, GST, VTG, GSA and ZDA; other text between the sentences is passed over",
    .time = "GPS time where RMC or ZDA give the date, else seconds of the UTC day",
    .recognise = [](const FileHead& head) { return is_nmea(TextInput(head.path)); },
    .read = nmea_streams,
    .write = write_nmea,
    .one_stream = true};

}  // namespace schuler::io
