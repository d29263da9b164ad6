#include "schuler/live/message.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace schuler::live {
namespace {

using filter::NavigatorEvent;

void pair(std::string& text, std::string_view key, double x, int decimals) {
    if (std::isfinite(x)) fmt::format_to(std::back_inserter(text), ",\"{}\":{:.{}f}", key, x, decimals);
    else fmt::format_to(std::back_inserter(text), ",\"{}\":null", key);
}

std::string_view name_of_kind(NavigatorEvent::Kind kind) {
    constexpr std::array<std::string_view, 9> names{"phase", "refused",      "hole",     "hang",     "aid",
                                                    "alert", "reconsidered", "diverged", "restarted"};
    return names[static_cast<std::size_t>(kind)];
}
std::string_view name_of_status(filter::MeasurementStatus status) {
    constexpr std::array<std::string_view, 4> names{"accepted", "rejected", "withheld", "excluded"};
    return names[static_cast<std::size_t>(status)];
}

std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body) sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum & 0xffU);
}

/// "ddmm.mmmmmm,N"
std::string angle(double rad, int digits, char positive, char negative) {
    const double minutes = std::round(std::abs(rad) / units::deg * 60.0 * 1e7) / 1e7;
    const int degrees = static_cast<int>(minutes / 60.0);
    return fmt::format("{:0{}d}{:010.7f},{}", degrees, digits, minutes - 60.0 * degrees, rad < 0.0 ? negative : positive);
}

}  // namespace

std::string_view name_of(filter::Phase phase) {
    constexpr std::array<std::string_view, 7> names{"waiting_for_imu", "waiting_for_start", "waiting_for_position",
                                                    "levelling",       "gyrocompassing",    "finding_heading",
                                                    "navigating"};
    return names[static_cast<std::size_t>(phase)];
}
std::string_view name_of(filter::Source source) {
    constexpr std::array<std::string_view, filter::source_count> names{"imu",     "gnss",   "baro", "mag",   "odometer",
                                                                       "heading", "gauges", "log",  "ranges"};
    return names[static_cast<std::size_t>(source)];
}
std::string_view name_of(filter::FeedStatus status) {
    constexpr std::array<std::string_view, filter::feed_status_count> names{"taken",         "late", "duplicate", "bad_value",
                                                                            "too_far_ahead", "full", "not_used"};
    return names[static_cast<std::size_t>(status)];
}

SolutionRow row_of(const filter::NavigatorState& s) {
    const Eigen::Matrix<double, 9, 1> sigma = s.covariance.diagonal().cwiseSqrt();
    Eigen::Vector3d rpy = math::rpy_from_quaternion(s.nav.q_nb);
    if (rpy[2] < 0.0) rpy[2] += 2.0 * std::numbers::pi;
    return {s.nav.time, s.nav.position, s.nav.v_eb_n, rpy, sigma.head<3>(), sigma.segment<3>(3), sigma.tail<3>()};
}

std::string state_json(const SolutionRow& row, bool lagged) {
    std::string text = fmt::format("{{\"type\":\"state\",\"at\":\"{}\",\"time_ns\":{},\"time_s\":{:.9f}", lagged ? "lag" : "now",
                                   row.time.ns, row.time.seconds());
    pair(text, "lat_deg", row.position.lat / units::deg, 10);
    pair(text, "lon_deg", row.position.lon / units::deg, 10);
    pair(text, "height_m", row.position.h, 4);
    const auto three = [&text](const std::array<const char*, 3>& keys, const Eigen::Vector3d& v, double unit, int decimals) {
        for (std::size_t i = 0; i < 3; ++i) pair(text, keys[i], v[static_cast<Eigen::Index>(i)] / unit, decimals);
    };
    three({"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"}, row.v_eb_n, 1.0, 5);
    three({"roll_deg", "pitch_deg", "heading_deg"}, row.rpy, units::deg, 6);
    three({"std_n_m", "std_e_m", "std_d_m"}, row.std_position, 1.0, 4);
    three({"std_vn_m_s", "std_ve_m_s", "std_vd_m_s"}, row.std_velocity, 1.0, 5);
    three({"std_roll_deg", "std_pitch_deg", "std_heading_deg"}, row.std_rpy, units::deg, 6);
    return text + "}\n";
}

std::string state_nmea(const SolutionRow& row) {
    const Time hundredths{(row.time.ns + 5'000'000) / 10'000'000 * 10'000'000};
    const Calendar c = utc_from_gps(hundredths);
    const std::string time = fmt::format("{:02}{:02}{:05.2f}", c.hour, c.minute, c.second);
    const std::string place = angle(row.position.lat, 2, 'N', 'S') + "," + angle(row.position.lon, 3, 'E', 'W');
    const std::string date = c.year < 2000 ? "" : fmt::format("{:02}{:02}{:02}", c.day, c.month, c.year % 100);
    const double speed = std::hypot(row.v_eb_n[0], row.v_eb_n[1]), course = std::atan2(row.v_eb_n[1], row.v_eb_n[0]) / units::deg;
    constexpr double knot = 1852.0 / 3600.0;
    // the height is above the ellipsoid; quality 6: estimated, by dead reckoning
    return sentence(fmt::format("INGGA,{},{},6,00,,{:.3f},M,0.0,M,,", time, place, row.position.h)) +
           sentence(fmt::format("INRMC,{},A,{},{:.3f},{:.2f},{},,,E", time, place, speed / knot,
                                course < 0.0 ? course + 360.0 : course, date)) +
           sentence(fmt::format("INHDT,{:.2f},T", row.rpy[2] / units::deg));
}

std::string event_json(const NavigatorEvent& e) {
    std::string text =
        fmt::format("{{\"type\":\"event\",\"time_s\":{:.9f},\"kind\":\"{}\"", e.time.seconds(), name_of_kind(e.kind));
    const auto add = [&text](const char* key, std::string_view value) {
        fmt::format_to(std::back_inserter(text), ",\"{}\":\"{}\"", key, value);
    };
    if (e.kind == NavigatorEvent::Kind::Phase) add("phase", name_of(e.phase));
    if (e.kind == NavigatorEvent::Kind::Refused) {
        add("source", name_of(e.source));
        add("status", name_of(e.status));
    }
    if (e.kind == NavigatorEvent::Kind::Measurement || e.kind == NavigatorEvent::Kind::Alert)
        add("aid", filter::info_of(e.measurement).key);
    if (e.kind == NavigatorEvent::Kind::Measurement) add("status", name_of_status(e.measurement_status));
    if (e.kind == NavigatorEvent::Kind::Hole) pair(text, "seconds", e.seconds, 3);
    return text + "}\n";
}

std::string satellites_json(double time, const std::vector<SatelliteSeen>& satellites) {
    std::string text = "{\"type\":\"satellites\"";
    pair(text, "time_s", time, 3);
    text += ",\"satellites\":[";
    for (const SatelliteSeen& s : satellites) {
        fmt::format_to(std::back_inserter(text), "{}{{\"name\":\"{}\"", text.back() == '[' ? "" : ",", gnss::name_of(s.id));
        pair(text, "elevation_deg", s.elevation / units::deg, 0);
        pair(text, "azimuth_deg", s.azimuth / units::deg, 0);
        pair(text, "cn0_db_hz", s.cn0, 0);
        text += s.used ? ",\"used\":true}" : ",\"used\":false}";
    }
    return text + "]}\n";
}

std::string event_text(const NavigatorEvent& e) {
    switch (e.kind) {
        case NavigatorEvent::Kind::Phase: return fmt::format("{:.3f} s: {}", e.time.seconds(), name_of(e.phase));
        case NavigatorEvent::Kind::Refused:
            return fmt::format("{:.3f} s: a sample of {} was refused: {}", e.time.seconds(), name_of(e.source),
                               name_of(e.status));
        case NavigatorEvent::Kind::Hole:
            return fmt::format("{:.3f} s: a hole of the IMU of {:.3f} s was bridged", e.time.seconds(), e.seconds);
        case NavigatorEvent::Kind::Hang: return fmt::format("{:.3f} s: the IMU repeats itself", e.time.seconds());
        case NavigatorEvent::Kind::Measurement:
            return fmt::format("{:.3f} s: a measurement of {} was {}", e.time.seconds(), filter::info_of(e.measurement).name,
                               name_of_status(e.measurement_status));
        case NavigatorEvent::Kind::Alert:
            return fmt::format("{:.3f} s: alert of {}", e.time.seconds(), filter::info_of(e.measurement).name);
        case NavigatorEvent::Kind::Reconsidered:
            return fmt::format("{:.3f} s: the other hypothesis about rejected fixes is accepted now", e.time.seconds());
        case NavigatorEvent::Kind::Diverged:
            return fmt::format("{:.3f} s: the computation diverged; alignment restarts", e.time.seconds());
        default: return fmt::format("{:.3f} s: the time of the IMU jumped; alignment restarts", e.time.seconds());
    }
}

std::string health_json(const Health& h) {
    std::string text = "{\"type\":\"health\"";
    pair(text, "time_s", h.time, 3);
    fmt::format_to(std::back_inserter(text), ",\"phase\":\"{}\"", name_of(h.phase));
    pair(text, "imu_hz", h.imu_rate, 1);
    if (h.fed != nullptr) {
        text += ",\"samples\":{";
        bool first = true;
        for (std::size_t s = 0; s < filter::source_count; ++s) {
            std::size_t all = 0;
            for (const std::size_t n : h.fed->by_status[s]) all += n;
            if (all == 0) continue;
            fmt::format_to(std::back_inserter(text), "{}\"{}\":{{", first ? "" : ",", name_of(static_cast<filter::Source>(s)));
            first = false;
            for (std::size_t k = 0; k < filter::feed_status_count; ++k)
                fmt::format_to(std::back_inserter(text), "{}\"{}\":{}", k == 0 ? "" : ",",
                               name_of(static_cast<filter::FeedStatus>(k)), h.fed->by_status[s][k]);
            text += "}";
        }
        fmt::format_to(std::back_inserter(text), "}},\"holes\":{},\"restarts\":{}", h.fed->holes, h.fed->restarts);
    }
    fmt::format_to(std::back_inserter(text), ",\"garbage\":{},\"foreign\":{},\"reconnections\":{},\"dropped\":{},\"readers\":{}",
                   h.garbage, h.foreign, h.reconnections, h.dropped, h.readers);
    pair(text, "latency_median_ms", 1e3 * h.latency_median, 3);
    pair(text, "latency_largest_ms", 1e3 * h.latency_largest, 3);
    return text + "}\n";
}

}  // namespace schuler::live
