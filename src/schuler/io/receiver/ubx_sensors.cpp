// The inertial sensors inside u-blox receivers: ESF-RAW and ESF-MEAS [UBloxM8], with the time of the interspersed fixes.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/raw_table.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/receiver/detail/ubx_message.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/text/detail/calendar_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace schuler::io {
namespace {

using detail::number_at;

/// Values of one kind: x, y, z with the sensors' clock ticks, in s.
struct Axis {
    std::vector<double> time, value;
};

/// Logging instant by the sensors' clock and by GPS.
struct Mark {
    double sensor, gps;
};

class SensorReader {
public:
    void read(std::string_view bytes) {
        constexpr std::string_view sync = "\xb5\x62";
        std::size_t behind = 0;
        for (std::size_t at = bytes.find(sync); at != std::string_view::npos; at = bytes.find(sync, at)) {
            text(bytes.substr(behind, at - behind));
            detail::UbxMessage m;
            const detail::Scan found = detail::message_at(bytes.substr(at), m);
            if (found == detail::Scan::Message) {
                damage.message();
                message(m);
                at += m.size;
            } else {
                if (found == detail::Scan::Cut) damage.cut(at);
                else damage.bad(at);
                at += sync.size();
            }
            behind = at;
        }
        text(bytes.substr(std::min(behind, bytes.size())));
    }

    detail::UbxDamage damage;
    std::array<Axis, 3> raw_gyro, raw_accel, gyro, accel;
    std::vector<Mark> marks;
    Stream solution{"reference", TableKind::Reference, "NAV-ATT", {"roll_deg", "pitch_deg", "heading_deg"}};
    Stream fast{
        "hnr", TableKind::Reference, "HNR-PVT", {"ekf_lat_deg", "ekf_lon_deg", "ekf_height_m", "ekf_vel_n_m_s", "ekf_vel_e_m_s"}};

private:
    void message(const detail::UbxMessage& m) {
        const std::string_view p = m.payload;
        switch (m.kind) {
            case 0x1003: raw(p); break;
            case 0x1002: measured(p); break;
            case 0x0107: fix(p); break;
            case 0x0105: attitude(p); break;
            case 0x2800: high_rate(p); break;
            default: break;
        }
    }

    static std::optional<Time> date_time(std::string_view p) {  // of NAV-PVT and HNR-PVT
        const int year = number_at<std::uint16_t>(p, 4), month = number_at<std::uint8_t>(p, 6),
                  day = number_at<std::uint8_t>(p, 7);
        const int hour = number_at<std::uint8_t>(p, 8), minute = number_at<std::uint8_t>(p, 9),
                  second = number_at<std::uint8_t>(p, 10);
        if (!detail::is_date(year, month, day) || hour > 23 || minute > 59 || second > 60) return std::nullopt;
        return gps_from_utc({year, month, day, hour, minute, static_cast<double>(second)}) +
               Duration{number_at<std::int32_t>(p, 16)};
    }

    void fix(std::string_view p) {
        if (p.size() < 84 || (number_at<std::uint8_t>(p, 11) & 3U) != 3U) return;
        if (const auto t = date_time(p)) now(*t, number_at<std::uint32_t>(p, 0));
    }

    void now(Time t, std::uint32_t tow_ms) {
        now_ = t.seconds();
        week_start_ = t.ns - std::int64_t{tow_ms} * 1'000'000;
    }

    /// Sentences between the messages: RMC gives date and time if NAV-PVT is not logged.
    void text(std::string_view t) {
        for (std::size_t at = t.find("RMC,"); at != std::string_view::npos; at = t.find("RMC,", at + 4)) {
            std::array<std::string_view, 10> cells;
            std::string_view rest = t.substr(at + 4, 120);
            for (std::string_view& cell : cells) {
                cell = rest.substr(0, std::min(rest.find(','), rest.size()));
                rest.remove_prefix(std::min(cell.size() + 1, rest.size()));
            }
            const std::string_view clock = cells[0], date = cells[8];
            if (clock.size() < 6 || date.size() != 6) continue;
            const auto two = [](std::string_view s, std::size_t i) { return (s[i] - '0') * 10 + (s[i + 1] - '0'); };
            const int day = two(date, 0), month = two(date, 2), year = 2000 + two(date, 4), hour = two(clock, 0),
                      minute = two(clock, 2), second = two(clock, 4);
            if (!detail::is_date(year, month, day) || hour < 0 || hour > 23 || minute < 0 || minute > 59 || second < 0 ||
                second > 60)
                continue;
            now_ = gps_from_utc({year, month, day, hour, minute, static_cast<double>(second)}).seconds();
        }
    }

    static double signed24(std::uint32_t word) {
        return static_cast<double>(static_cast<std::int32_t>(word << 8) >> 8);  // sign extension from 24 bits
    }

    void value(std::uint32_t word, double time, std::array<Axis, 3>& w, std::array<Axis, 3>& f) {
        constexpr double rate = units::deg / 4096.0, force = 1.0 / 1024.0;
        const double x = signed24(word);
        const auto put = [&](Axis& axis, double v) {
            axis.time.push_back(time);
            axis.value.push_back(v);
        };
        switch (word >> 24 & 0x3FU) {
            case 14: put(w[0], x * rate); break;
            case 13: put(w[1], x * rate); break;
            case 5: put(w[2], x * rate); break;
            case 16: put(f[0], x * force); break;
            case 17: put(f[1], x * force); break;
            case 18: put(f[2], x * force); break;
            default: break;
        }
    }

    /// Continues a 32-bit counter that wraps.
    static double carried(std::uint32_t ticks, std::optional<std::int64_t>& last) {
        std::int64_t t = ticks;
        if (last) t = *last + static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(*last));
        last = t;
        return static_cast<double>(t);
    }

    void raw(std::string_view p) {
        constexpr double tick = 1.0 / 25'600.0;  // s, of the sensors' clock
        double latest = 0.0;
        bool any = false;
        for (std::size_t at = 4; at + 8 <= p.size(); at += 8) {
            latest = carried(number_at<std::uint32_t>(p, at + 4), raw_ticks_) * tick;
            any = true;
            value(number_at<std::uint32_t>(p, at), latest, raw_gyro, raw_accel);
        }
        if (any && now_ > 0.0) marks.push_back({latest, now_});
    }

    void measured(std::string_view p) {
        if (p.size() < 8) return;
        const double time = 1e-3 * carried(number_at<std::uint32_t>(p, 0), ticks_);
        for (std::size_t at = 8, n = number_at<std::uint16_t>(p, 4) >> 11; n > 0 && at + 4 <= p.size(); --n, at += 4)
            value(number_at<std::uint32_t>(p, at), time, gyro, accel);
        if (now_ > 0.0) measured_marks.push_back({time, now_});
    }

    void attitude(std::string_view p) {
        if (p.size() < 20 || week_start_ == 0) return;
        const auto angle = [&](std::size_t at) { return 1e-5 * number_at<std::int32_t>(p, at); };
        solution.add(week_start_ + std::int64_t{number_at<std::uint32_t>(p, 0)} * 1'000'000, {angle(8), angle(12), angle(16)});
    }

    void high_rate(std::string_view p) {
        if (p.size() < 72 || number_at<std::uint8_t>(p, 16) < 2) return;
        const int year = number_at<std::uint16_t>(p, 4), month = number_at<std::uint8_t>(p, 6),
                  day = number_at<std::uint8_t>(p, 7);
        const int hour = number_at<std::uint8_t>(p, 8), minute = number_at<std::uint8_t>(p, 9),
                  second = number_at<std::uint8_t>(p, 10);
        if (!detail::is_date(year, month, day) || hour > 23 || minute > 59 || second > 60) return;
        const Time t = gps_from_utc({year, month, day, hour, minute, static_cast<double>(second)}) +
                       Duration{number_at<std::int32_t>(p, 12)};
        const double speed = 1e-3 * number_at<std::int32_t>(p, 36), course = 1e-5 * units::deg * number_at<std::int32_t>(p, 48);
        fast.add(t.ns, {1e-7 * number_at<std::int32_t>(p, 24), 1e-7 * number_at<std::int32_t>(p, 20),
                        1e-3 * number_at<std::int32_t>(p, 28), speed * std::cos(course), speed * std::sin(course)});
        now(t, number_at<std::uint32_t>(p, 0));
    }

    std::optional<std::int64_t> raw_ticks_, ticks_;
    double now_ = 0.0;
    std::int64_t week_start_ = 0;

public:
    std::vector<Mark> measured_marks;
};

/// The linear relation between the sensors' clock and GPS time. A message is logged after the preceding epoch: the largest
/// differences are those of messages immediately after their epoch.
struct ClockLine {
    double offset = 0.0, drift = 0.0, from = 0.0;
    /// The offset is added separately: a floating sum would be rounded to 0.2 us.
    [[nodiscard]] std::int64_t ns(double sensor) const {
        return Time::from_seconds(offset).ns + Duration::from_seconds(sensor + drift * (sensor - from)).ns;
    }
};
ClockLine line_of(const std::vector<Mark>& marks) {
    if (marks.empty()) return {};
    const double first = marks.front().sensor, last = marks.back().sensor, third = (last - first) / 3.0;
    const auto largest = [&](double from, double to) {
        double best = -1e300;
        for (const Mark& m : marks)
            if (m.sensor >= from && m.sensor <= to) best = std::max(best, m.gps - m.sensor);
        return best;
    };
    const double early = largest(first, first + third), late = largest(last - third, last);
    constexpr double long_enough = 180.0, much = 500e-6;  // s; above the drift of any oscillator
    const double drift = last - first > long_enough ? (late - early) / (2.0 * third) : 0.0;
    if (drift == 0.0 || std::abs(drift) > much) return {largest(first, last), 0.0, first};
    return {early, drift, first + 0.5 * third};
}

Stream imu_stream(const std::array<Axis, 3>& w, const std::array<Axis, 3>& f, const ClockLine& clock, std::string source) {
    Stream s("imu", TableKind::Imu, std::move(source),
             {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
    s.by_arrival = true;
    const std::vector<double>& time = w[0].time;
    std::array<std::vector<double>, 6> v;
    const auto at_these = [&](const Axis& a) { return a.time == time ? a.value : interpolated(time, a.time, a.value, 0.2); };
    for (std::size_t k = 0; k < 3; ++k) {
        v[k] = at_these(w[k]);
        v[k + 3] = at_these(f[k]);
    }
    for (std::size_t i = 0; i < time.size(); ++i)
        s.add(clock.ns(time[i]), {v[0][i], v[1][i], v[2][i], v[3][i], v[4][i], v[5][i]});
    return s;
}

StreamLog ubx_streams(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    StreamLog log;
    SensorReader sensors;
    sensors.read(bytes);
    const TextInput content = TextInput::memory(bytes, input.name());
    std::vector<GnssFix> fixes;
    HeightKind height = HeightKind::Ellipsoidal;
    std::string source = "NAV-PVT";
    try {
        fixes = read_ubx(content, warnings, UbxContent::Fixes).fixes;
    } catch (const Error&) {
        // a log of the sensors alone has no other content
        sensors.damage.tell(input.name(), warnings);
    }
    if (fixes.empty()) {
        try {
            NmeaLog nmea = read_nmea(content, warnings);
            if (nmea.has_date) fixes = std::move(nmea.fixes);
            height = nmea.height;
            source = "NMEA between the messages";
        } catch (const Error&) {}
    }
    const bool raw = !sensors.raw_gyro[0].time.empty();
    const std::vector<Mark>& marks = raw ? sensors.marks : sensors.measured_marks;
    const bool dated = !marks.empty() || !fixes.empty() || sensors.fast.rows() > 0;
    log.clock = dated ? Clock::Gps : Clock::Boot;
    if (!dated || !marks.empty()) {
        if (raw) log.add(imu_stream(sensors.raw_gyro, sensors.raw_accel, line_of(marks), "ESF-RAW"));
        else if (!sensors.gyro[0].time.empty()) log.add(imu_stream(sensors.gyro, sensors.accel, line_of(marks), "ESF-MEAS"));
    }
    if (!fixes.empty()) log.add(stream_of(fixes, height, source));
    log.add(std::move(sensors.solution));
    log.add(std::move(sensors.fast));
    if (log.streams.empty())
        throw input_error("has no fix of the receiver itself (NAV-PVT) and no inertial sensor (ESF-RAW, ESF-MEAS)",
                          place_in(input.name()), "its raw measurements, if any, are used as [gnss] observations");
    return log;
}

}  // namespace

extern const Format ubx_format;
const Format ubx_format = {
    .name = "ubx",
    .title = "u-blox UBX",
    .extensions = ".ubx .log",
    .holds =
        "raw measurements (RXM-RAWX), satellites' messages (RXM-SFRBX), fixes (NAV-PVT, or NMEA between the messages), the receiver's inertial sensors "
        "(ESF-RAW, else ESF-MEAS) on the time of the fixes, its attitude (NAV-ATT) and fast solution (HNR-PVT) as reference",
    .time = "GPS time; the sensors' own clock where nothing gives the time",
    .recognise = [](const FileHead& head) { return is_ubx(TextInput(head.path)); },
    .read = ubx_streams};

}  // namespace schuler::io
