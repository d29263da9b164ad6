// Waypoint IMR: raw IMU data in the format of Inertial Explorer, a header of 512 bytes and records of 32 [WaypointIMR].
#include "schuler/core/error.h"
#include "schuler/core/time.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace schuler::io {
namespace {

constexpr std::string_view imr_mark("$IMURAW\0", 8);
constexpr std::size_t imr_header_size = 512, record_size = 32;

/// A number in the byte order stated in the header.
template <class T>
T value_at(std::string_view bytes, std::size_t at, bool big) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
    if (big) std::ranges::reverse(raw);
    return detail::load<T>(raw.data());
}

struct Header {
    bool big = false, angles = false, velocities = false, utc = false;
    double rate = 0.0, gyro = 0.0, accel = 0.0, bias = 0.0;
    std::array<std::int32_t, 3> lever_mm{};
    bool has_lever = false;
    int leap_seconds = 0;
    bool dated = false;
    std::string name;
};

Header header_of(std::string_view b, const std::string& file) {
    Header h;
    h.big = b[8] != 0;
    const auto i = [&](std::size_t at) { return value_at<std::int32_t>(b, at, h.big); };
    const auto d = [&](std::size_t at) { return value_at<double>(b, at, h.big); };
    h.angles = i(17) != 0, h.velocities = i(21) != 0;
    h.rate = d(25), h.gyro = d(33), h.accel = d(41);
    h.utc = i(49) == 1;
    h.bias = d(57);
    h.name = std::string(b.substr(65, 32));
    h.name = h.name.substr(0, h.name.find('\0'));
    std::erase_if(h.name, [](char c) { return c < ' ' || c > '~'; });
    const auto s = [&](std::size_t at) { return static_cast<int>(value_at<std::int16_t>(b, at, h.big)); };
    h.dated = s(133) >= 1990 && s(133) < 2100 && detail::is_date(s(133), s(135), s(137));
    constexpr double since_2017 = 1.2e9;  // s of GPS time
    const double when = h.dated ? gps_from_utc({s(133), s(135), s(137), 12, 0, 0.0}).seconds() : since_2017;
    h.leap_seconds = gps_minus_utc(static_cast<std::int64_t>(when));
    h.has_lever = b[145] != 0;
    for (std::size_t k = 0; k < 3; ++k) h.lever_mm[k] = i(146 + 4 * k);
    const auto sane = [](double x, double most) { return std::isfinite(x) && x > 0.0 && x <= most; };
    if (!sane(h.rate, 1e5) || !sane(h.gyro, 1e3) || !sane(h.accel, 1e3))
        throw input_error(fmt::format("the header at byte 25 has a rate of {} Hz and scale factors {} and {}, which cannot be",
                                      h.rate, h.gyro, h.accel),
                          place_in(file), "convert the log with Inertial Explorer again, or give its sensors as a table");
    return h;
}

bool is_imr(const FileHead& head) { return head.starts_with(imr_mark); }

StreamLog read_imr(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    if (bytes.size() < imr_header_size + record_size)
        throw input_error(fmt::format("the file is cut: {} bytes, header and first record have {}", bytes.size(),
                                      imr_header_size + record_size),
                          place_in(input.name()), "copy the file again");
    const Header h = header_of(bytes, input.name());
    const bool increments = h.angles && h.velocities;
    const double to_rates = h.rate;
    const double gyro = h.gyro * units::deg * (h.angles && !increments ? to_rates : 1.0),
                 accel = h.accel * (h.velocities && !increments ? to_rates : 1.0);
    Stream s = increments
                   ? Stream("imu", TableKind::Imu, "IMR, increments",
                            {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"})
                   : Stream("imu", TableKind::Imu, "IMR, rates",
                            {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
    std::size_t damaged = 0, first = 0;
    const double offset = h.utc ? h.leap_seconds : 0.0;
    for (std::size_t at = imr_header_size; at + record_size <= bytes.size(); at += record_size) {
        const auto time = value_at<double>(bytes, at, h.big);
        if (!(time >= 0.0 && time < 2.0 * 604'800.0)) {
            if (damaged++ == 0) first = at;
            continue;
        }
        const auto v = [&](std::size_t k) { return static_cast<double>(value_at<std::int32_t>(bytes, at + 8 + 4 * k, h.big)); };
        s.add(Duration::from_seconds(time + offset).ns,
              {v(0) * gyro, v(1) * gyro, v(2) * gyro, v(3) * accel, v(4) * accel, v(5) * accel});
    }
    if (s.rows() == 0)
        throw input_error("no record has a time of the week", place_in(input.name()),
                          "the file is damaged from byte 512 on: convert it again");
    StreamLog log;
    log.clock = Clock::SecondsOfWeek;
    log.contents.push_back(fmt::format("IMU {}, {:g} Hz by the header", h.name.empty() ? "without a name" : h.name, h.rate));
    if (h.has_lever)
        log.contents.push_back(fmt::format("lever arm in the header, IMU axes: {:.3f}, {:.3f}, {:.3f} m", 1e-3 * h.lever_mm[0],
                                           1e-3 * h.lever_mm[1], 1e-3 * h.lever_mm[2]));
    if (damaged > 0)
        warnings.add(input.name() + " imr.damaged",
                     fmt::format("{}: records whose time is none: skipped, the first at byte {}", input.name(), first), damaged);
    if (const std::size_t rest = (bytes.size() - imr_header_size) % record_size; rest != 0)
        warnings.add(input.name() + " imr.cut",
                     fmt::format("{}: cut at byte {}: {} bytes of the last record", input.name(), bytes.size() - rest, rest));
    if (h.utc)
        warnings.add(input.name() + " imr.utc", fmt::format("{}: its times are UTC: {} leap seconds added{}", input.name(),
                                                            h.leap_seconds, h.dated ? "" : " (it has no date)"));
    if (std::isfinite(h.bias) && h.bias != 0.0)
        warnings.add(
            input.name() + " imr.bias",
            fmt::format("{}: the header's time tag bias of {:g} s is not applied ([imu] time_offset_s)", input.name(), h.bias));
    log.add(std::move(s));
    return log;
}

}  // namespace

extern const Format imr_format;
const Format imr_format = {
    .name = "imr",
    .title = "Waypoint IMR",
    .extensions = ".imr",
    .holds =
        "angular and velocity increments, or rates, with the header's scale factors, least or most significant byte first; axes found from the data",
    .time = "seconds of the GPS week; UTC ones with the leap seconds added",
    .recognise = is_imr,
    .read = read_imr};

}  // namespace schuler::io
