#include "schuler/io/solution/rtklib_pos.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/solution/receiver_text.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/detail/first_lines.h"
#include "schuler/io/text/detail/sample_rows.h"
#include "schuler/io/text/fix_codes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace schuler::io {
namespace {

/// An integer, or its notation by programs that only use doubles: 1.0000000.
std::optional<int> whole_number(std::string_view text) {
    const double x = number_from(text);
    return x >= 0.0 && x < 1e6 && x == std::floor(x) ? std::optional(static_cast<int>(x)) : std::nullopt;
}

using Eigen::Matrix3d;
using Eigen::Vector3d;

enum class Coordinates { Degrees, DegreesMinutesSeconds, EarthFixed, Baseline };

/// Positions of the fields in a row; -1: absent.
struct PosLayout {
    Coordinates coordinates = Coordinates::Degrees;
    std::string time_system = "GPST";
    char separator = ' ';
    int position = 2;
    int quality = -1, satellites = -1;
    int std_position = -1;  ///< three sigmas and three signed roots of covariances
    int velocity = -1;
    int std_velocity = -1;
    int fields = 0;  ///< required in a row
};

/// Field positions for RTKLIB's own order, with `count` fields per row.
PosLayout standard_layout(Coordinates coordinates, int count) {
    PosLayout l;
    l.coordinates = coordinates;
    int next = coordinates == Coordinates::DegreesMinutesSeconds ? 9 : 5;
    l.fields = next;
    if (count >= next + 2) {
        l.quality = next;
        l.satellites = next + 1;
        l.fields = next + 2;
    }
    next += 2;
    if (count >= next + 6) l.std_position = next;
    next += 8;  // sigmas, age and ratio
    if (count >= next + 3) l.velocity = next;
    if (count >= next + 9) l.std_velocity = next + 3;
    return l;
}

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// The line that names the columns: "%  GPST  latitude(deg) ...".
std::optional<PosLayout> layout_from_header(std::string_view line) {
    std::string system;
    for (const char* name : {"GPST", "UTC", "JST"}) {
        const std::size_t at = line.find(name);
        if (at != std::string_view::npos && line.find_first_not_of("% \t") == at) system = name;
    }
    if (system.empty() || !contains(line, "Q") || !contains(line, "ns")) return std::nullopt;
    Coordinates coordinates = Coordinates::Degrees;
    if (contains(line, "baseline")) coordinates = Coordinates::Baseline;
    else if (contains(line, "ecef")) coordinates = Coordinates::EarthFixed;
    else if (contains(line, "latitude(d'")) coordinates = Coordinates::DegreesMinutesSeconds;
    else if (!contains(line, "latitude")) return std::nullopt;
    // Names contain no blanks, so the header has one word for the two of the time and for the three of an angle.
    char separator = ' ';
    for (const char c : {',', ';', '\t'}) separator = std::count(line.begin(), line.end(), c) > 4 ? c : separator;
    int count = static_cast<int>(split_fields(line.substr(line.find(system)), separator).size()) + 1;
    count += coordinates == Coordinates::DegreesMinutesSeconds ? 4 : 0;
    PosLayout l = standard_layout(coordinates, count);
    l.time_system = system;
    l.separator = separator;
    return l;
}

/// Without a header: from the numbers of a row.
PosLayout guessed_layout(const std::vector<std::string>& fields, char separator) {
    const int count = static_cast<int>(fields.size());
    Coordinates coordinates = Coordinates::Degrees;
    if (count > 4 && std::abs(number_from(fields[2])) > 400.0) coordinates = Coordinates::EarthFixed;
    else if (count == 19 || count == 28) coordinates = Coordinates::DegreesMinutesSeconds;
    PosLayout l = standard_layout(coordinates, count);
    l.separator = separator;
    return l;
}

/// Fields of a row; the calendar date and the time of day are two of them for any separator.
std::vector<std::string> row_fields(std::string_view line, char separator) {
    std::vector<std::string> fields = split_fields(line, separator);
    if (separator == ' ' || fields.empty()) return fields;
    const std::vector<std::string> time = split_fields(fields[0], ' ');
    if (time.size() == 2) {
        fields[0] = time[1];
        fields.insert(fields.begin(), time[0]);
    }
    return fields;
}

char separator_of(std::string_view line) {
    for (const char c : {',', ';', '\t'}) {
        if (std::count(line.begin(), line.end(), c) > 4) return c;
    }
    return ' ';
}

/// RTKLIB's time systems to GPS time.
std::optional<Time> time_of(const std::string& first, const std::string& second, const std::string& system) {
    constexpr std::int64_t ns = detail::ns_per_second;
    const std::vector<std::string> date = split_fields(first, '/');
    Time minute;
    std::int64_t rest = 0;
    if (date.size() == 3) {
        const auto y = detail::small_integer(date[0]), m = detail::small_integer(date[1]), d = detail::small_integer(date[2]);
        const std::vector<std::string> clock = split_fields(second, ':');
        if (!y || !m || !d || clock.size() != 3 || !detail::is_date(*y, *m, *d)) return std::nullopt;
        const auto t = detail::time_of_day(clock[0], clock[1], clock[2]);
        if (!t) return std::nullopt;
        minute = gps_from_calendar({*y, *m, *d, t->hour, t->minute, 0.0});
        rest = t->rest_ns;
    } else {
        const auto week = detail::small_integer(first);
        std::int64_t tow = 0;
        if (!week || *week > 10'000 || !nanoseconds_from(second, TimeUnit::Seconds, tow) || std::abs(tow) > 700'000 * ns)
            return std::nullopt;
        minute = Time::from_gps(*week, 0.0);
        minute.ns += tow / (60 * ns) * (60 * ns);
        rest = tow % (60 * ns);
    }
    if (system == "GPST") return Time{minute.ns + rest};
    if (system == "JST") minute.ns -= 9 * 3600 * ns;
    const std::int64_t utc_seconds = minute.ns / ns;
    return Time{minute.ns + gps_minus_utc(utc_seconds) * ns + rest};
}

/// Sigmas north, east, down from Earth-fixed sigmas and signed roots of covariances (xy, yz, zx).
Vector3d sigmas_from_earth_fixed(const std::array<double, 6>& s, const Geodetic& position) {
    const auto square = [](double v) { return std::copysign(v * v, v); };
    Matrix3d P;
    // clang-format off
    P << square(s[0]), square(s[3]), square(s[5]), square(s[3]), square(s[1]), square(s[4]), square(s[5]), square(s[4]),
        square(s[2]);
    // clang-format on
    const Matrix3d C_en = earth::C_en(position.lat, position.lon);
    const Matrix3d P_n = C_en.transpose() * P * C_en;
    return P_n.diagonal().cwiseMax(0.0).cwiseSqrt();
}

class PosRow {
public:
    PosRow(const std::vector<std::string>& fields, const PosLayout& layout) : fields_(fields), layout_(layout) {}

    /// Fills a fix; false if the row cannot be read.
    [[nodiscard]] bool read(GnssFix& fix) const {
        if (static_cast<int>(fields_.size()) < layout_.fields) return false;
        const auto time = time_of(fields_[0], fields_[1], layout_.time_system);
        if (!time || !read_position(fix)) return false;
        fix.time = *time;
        if (layout_.quality >= 0) {
            const auto q = whole_number(fields_[static_cast<std::size_t>(layout_.quality)]);
            if (!q) return false;
            fix.fix = fix_from_rtklib(*q);
            fix.satellites = whole_number(fields_[static_cast<std::size_t>(layout_.satellites)]).value_or(-1);
        }
        fix.std_position = sigmas(layout_.std_position, fix.position);
        read_velocity(fix);
        return true;
    }

private:
    [[nodiscard]] double number(int field) const {
        return field >= 0 && field < static_cast<int>(fields_.size()) ? number_from(fields_[static_cast<std::size_t>(field)])
                                                                      : not_given;
    }
    [[nodiscard]] Vector3d three(int field) const {
        return field < 0 ? not_given3() : Vector3d(number(field), number(field + 1), number(field + 2));
    }

    [[nodiscard]] double angle_dms(int field) const {
        const double d = number(field), m = number(field + 1), s = number(field + 2);
        const double size = std::abs(d) + m / 60.0 + s / 3600.0;
        return std::signbit(d) ? -size : size;
    }

    [[nodiscard]] bool read_position(GnssFix& fix) const {
        const int p = layout_.position;
        if (layout_.coordinates == Coordinates::EarthFixed) {
            const Vector3d r = three(p);
            if (!(r.norm() > 6.2e6) || !(r.norm() < 1e8)) return false;
            fix.position = earth::geodetic_from_ecef(earth::wgs84, Ecef{r});
            return true;
        }
        const bool dms = layout_.coordinates == Coordinates::DegreesMinutesSeconds;
        const double lat = dms ? angle_dms(p) : number(p), lon = dms ? angle_dms(p + 3) : number(p + 1);
        const double height = number(dms ? p + 6 : p + 2);
        if (!(std::abs(lat) <= 90.0) || !(std::abs(lon) <= 360.0) || std::isnan(height)) return false;
        fix.position = {lat * units::deg, lon * units::deg, height};
        if (std::abs(lon) > 180.0) fix.position.lon = std::remainder(fix.position.lon, 2.0 * std::numbers::pi);
        return true;
    }

    [[nodiscard]] Vector3d sigmas(int field, const Geodetic& position) const {
        if (field < 0) return not_given3();
        if (layout_.coordinates != Coordinates::EarthFixed) return three(field);
        std::array<double, 6> s{};
        for (int i = 0; i < 6; ++i) s[static_cast<std::size_t>(i)] = number(field + i);
        return sigmas_from_earth_fixed(s, position);
    }

    void read_velocity(GnssFix& fix) const {
        if (layout_.velocity < 0) return;
        const Vector3d v = three(layout_.velocity);
        if (layout_.coordinates == Coordinates::EarthFixed)
            fix.velocity_n = earth::C_en(fix.position.lat, fix.position.lon).transpose() * v;
        else fix.velocity_n = {v.x(), v.y(), -v.z()};  // RTKLIB writes north, east, up
        fix.std_velocity = sigmas(layout_.std_velocity, fix.position);
    }

    const std::vector<std::string>& fields_;
    const PosLayout& layout_;
};

/// Header lines and rows in order.
class PosReader {
public:
    PosReader(std::string file, WarningLog& log) : file_(std::move(file)), log_(log) {}

    void line(std::string_view text, long number) {
        text = trimmed(text);
        if (text.empty()) return;
        if (text.front() == '%' || text.front() == '#') return header(text, number);
        ++result.rows.read;
        if (!layout_) {
            const char separator = separator_of(text);
            layout_ = guessed_layout(row_fields(text, separator), separator);
            log_.add("gnss.pos.header",
                     fmt::format("{}: no header line names the columns: taken for RTKLIB's order, in GPS time", file_));
        }
        GnssFix fix;
        const std::vector<std::string> fields = row_fields(text, layout_->separator);
        if (!PosRow(fields, *layout_).read(fix)) {
            if (result.rows.bad++ == 0) first_bad_line_ = number;
        } else if (fix.fix == FixType::None) {
            ++result.rows.without_fix;
        } else {
            result.fixes.push_back(fix);
        }
    }

    void finish() {
        if (result.fixes.empty() || 2 * result.rows.bad > result.rows.read) {
            const std::string hint = "is it a solution of RTKLIB? compare its header and its rows";
            if (result.rows.bad == 0) throw input_error("there is no usable row", place_in(file_), hint);
            throw input_error(fmt::format("this and {} of {} rows cannot be read", result.rows.bad - 1, result.rows.read - 1),
                              place_in(file_, first_bad_line_), hint);
        }
        if (layout_->coordinates == Coordinates::EarthFixed) result.height = HeightKind::Ellipsoidal;
        result.time_system = layout_->time_system;
        if (result.rows.bad > 0)
            log_.add("gnss.pos.bad",
                     fmt::format("{}: rows that cannot be read, the first in line {}: skipped", file_, first_bad_line_),
                     result.rows.bad);
    }

    RtklibPos result;

private:
    void header(std::string_view text, long number) {
        if (contains(text, "/geodetic")) result.height = HeightKind::Msl;
        if (contains(text, "/ellipsoidal")) result.height = HeightKind::Ellipsoidal;
        const auto layout = layout_from_header(text);
        if (!layout) return;
        if (layout->coordinates == Coordinates::Baseline) {
            throw input_error("the rows are baselines (east, north, up), not positions", place_in(file_, number),
                              "write the solution with latitude, longitude, height or x, y, z (out-solformat = llh)");
        }
        layout_ = layout;
        result.header_found = true;
    }

    std::string file_;
    WarningLog& log_;
    std::optional<PosLayout> layout_;
    long first_bad_line_ = 0;
};

}  // namespace

RtklibPos read_rtklib_pos(const TextInput& input, WarningLog& log) {
    LineBlocks blocks(input);
    PosReader reader(input.name(), log);
    while (blocks.next()) {
        long number = blocks.first_line();
        for (const char* p = blocks.begin(); p < blocks.end(); ++number) {
            const char* stop = std::find(p, blocks.end(), '\n');
            reader.line({p, static_cast<std::size_t>(stop - p)}, number);
            p = stop + 1;
        }
    }
    reader.finish();
    detail::RowAudit audit(input.name(), "gnss", log);
    audit.counts() = reader.result.rows;
    for (std::size_t i = 1; i < reader.result.fixes.size(); ++i) {
        audit.counts().out_of_order += reader.result.fixes[i].time < reader.result.fixes[i - 1].time ? 1 : 0;
    }
    audit.warn("out_of_order", "rows earlier than the one before: sorted in", audit.counts().out_of_order);
    detail::put_in_time_order(reader.result.fixes, audit, [](const GnssFix& a, const GnssFix& b) {
        return a.position.lat == b.position.lat && a.position.lon == b.position.lon && a.position.h == b.position.h;
    });
    reader.result.rows = audit.counts();
    return std::move(reader.result);
}

bool is_rtklib_pos(const TextInput& input) {
    try {
        LineBlocks blocks(input);
        for (const std::string_view whole : detail::first_lines(blocks)) {
            const std::string_view line = trimmed(whole);
            if (line.empty()) continue;
            if (line.front() == '%' && layout_from_header(line)) return true;
            if (line.front() != '%') {
                const std::vector<std::string> fields = row_fields(line, separator_of(line));
                return fields.size() >= 7 && contains(fields[0], "/") && time_of(fields[0], fields[1], "GPST").has_value();
            }
        }
    } catch (const Error&) {
        return false;
    }
    return false;
}

namespace {

StreamLog rtklib_streams(const TextInput& input, WarningLog& warnings) {
    const RtklibPos pos = read_rtklib_pos(input, warnings);
    StreamLog log;
    log.clock = Clock::Gps;
    log.add(stream_of(pos.fixes, pos.height, "solution"));
    return log;
}

}  // namespace

extern const Format rtklib_pos_format;
const Format rtklib_pos_format = {
    .name = "rtklib_pos",
    .title = "RTKLIB solution",
    .extensions = ".pos",
    .holds = "positions in degrees or Earth-fixed, velocities, standard deviations, quality Q, in GPST, UTC or JST",
    .time = "GPS time",
    .recognise = [](const FileHead& head) { return is_rtklib_pos(TextInput(head.path)); },
    .read = rtklib_streams,
    .write = write_rtklib_pos,
    .one_stream = true};

}  // namespace schuler::io
