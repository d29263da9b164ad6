// Solutions in the output formats of receivers and RTKLIB: .pos and NMEA 0183.
#include "schuler/io/solution/receiver_text.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/detail/dated.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::io {
namespace {

constexpr std::int64_t second = 1'000'000'000, week = 604'800 * second;

double finite_or_zero(double x) { return std::isfinite(x) ? x : 0.0; }  // a zero sigma is "not given" in .pos

std::string with_checksum(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body) sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

/// Degrees and minutes with eight decimals: 0.02 mm.
std::string degrees_minutes(double angle, int width) {
    const double deg = std::abs(angle) / units::deg;
    double whole = std::floor(deg), minutes = (deg - whole) * 60.0;
    if (minutes >= 59.999999995) {
        whole += 1.0;
        minutes = 0.0;
    }
    return fmt::format("{:0{}.0f}{:011.8f}", whole, width, minutes);
}

}  // namespace

void write_rtklib_pos(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title) {
    std::string out = fmt::format(
        "% program   : schuler\n% inp file  : {}\n% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)\n"
        "%  GPST                latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"
        "    vn(m/s)    ve(m/s)    vu(m/s)      sdvn     sdve     sdvu    sdvne    sdveu    sdvun\n",
        title);
    for (const SolutionRow& r : rows) {
        if (!std::isfinite(r.position.lat) || !std::isfinite(r.position.lon)) continue;
        if (r.time.ns < 0)
            throw input_error("a row has a time before zero, which a .pos file cannot hold", {},
                              "give an output with another clock");
        const auto &p = r.std_position, &v = r.v_eb_n, &s = r.std_velocity;
        fmt::format_to(
            std::back_inserter(out),
            "{:4d} {:6d}.{:09d}  {:14.10f} {:14.10f} {:10.4f}   5   0 {:8.5f} {:8.5f} {:8.5f} {:8.4f} {:8.4f} {:8.4f} {:6.2f} {:6.1f} {:10.5f} {:10.5f} {:10.5f} {:9.5f} "
            "{:8.5f} {:8.5f} {:8.5f} {:8.5f} {:8.5f}\n",
            r.time.ns / week, r.time.ns % week / second, r.time.ns % second, r.position.lat / units::deg,
            r.position.lon / units::deg, finite_or_zero(r.position.h), finite_or_zero(p.x()), finite_or_zero(p.y()),
            finite_or_zero(p.z()), 0.0, 0.0, 0.0, 0.0, 0.0, finite_or_zero(v.x()), finite_or_zero(v.y()), finite_or_zero(-v.z()),
            finite_or_zero(s.x()), finite_or_zero(s.y()), finite_or_zero(s.z()), 0.0, 0.0, 0.0);
    }
    write_file(path, out);
}

void write_nmea(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    std::string out;
    for (const SolutionRow& r : rows) {
        if (!std::isfinite(r.position.lat) || !std::isfinite(r.position.lon)) continue;
        const bool has_date = detail::is_dated(r.time);
        // milliseconds, as written by receivers
        const std::int64_t ms = (r.time.ns + (r.time.ns < 0 ? -500'000 : 500'000)) / 1'000'000;
        const Time rounded{ms * 1'000'000};
        const std::int64_t of_second = ((ms % 1000) + 1000) % 1000;
        const Calendar c = has_date ? utc_from_gps(Time{rounded.ns - of_second * 1'000'000}) : Calendar{};
        const std::int64_t day = ((ms / 1000) % 86'400 + 86'400) % 86'400;
        const std::string clock =
            has_date ? fmt::format("{:02}{:02}{:02}.{:03}", c.hour, c.minute, static_cast<int>(c.second + 0.5), of_second)
                     : fmt::format("{:02}{:02}{:02}.{:03}", day / 3600, day / 60 % 60, day % 60, of_second);
        const std::string place = fmt::format("{},{},{},{}", degrees_minutes(r.position.lat, 2), r.position.lat < 0.0 ? 'S' : 'N',
                                              degrees_minutes(r.position.lon, 3), r.position.lon < 0.0 ? 'W' : 'E');
        out += with_checksum(fmt::format("GNGGA,{},{},1,08,1.0,{:.4f},M,0.0000,M,,", clock, place, finite_or_zero(r.position.h)));
        if (r.v_eb_n.head<2>().allFinite()) {
            const double speed = r.v_eb_n.head<2>().norm() * 3600.0 / 1852.0;
            double course = std::atan2(r.v_eb_n.y(), r.v_eb_n.x()) / units::deg;
            if (course < 0.0) course += 360.0;
            if (has_date)
                out += with_checksum(fmt::format("GNRMC,{},A,{},{:.5f},{:.5f},{:02}{:02}{:02},,,A", clock, place, speed, course,
                                                 c.day, c.month, c.year % 100));
            else out += with_checksum(fmt::format("GNVTG,{:.5f},T,,M,{:.5f},N,{:.5f},K,A", course, speed, speed * 1.852));
        } else if (has_date) {
            out += with_checksum(fmt::format("GNZDA,{},{:02},{:02},{:04},00,00", clock, c.day, c.month, c.year));
        }
        if (r.std_position.allFinite())
            out += with_checksum(fmt::format("GNGST,{},,,,,{:.4f},{:.4f},{:.4f}", clock, r.std_position.x(), r.std_position.y(),
                                             r.std_position.z()));
        if (std::isfinite(r.rpy.z())) out += with_checksum(fmt::format("GNHDT,{:.4f},T", r.rpy.z() / units::deg));
    }
    write_file(path, out);
}

}  // namespace schuler::io
