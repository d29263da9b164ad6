// NovAtel OEM logs, ASCII and binary, mixed or not [NovAtelOEM7].
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace schuler::io {
namespace {

using detail::load;

constexpr std::string_view long_sync("\xaa\x44\x12", 3), short_sync("\xaa\x44\x13", 3);
constexpr std::size_t short_header = 12, crc_size = 4;

/// CRC-32 of NovAtel: reversed polynomial 0xEDB88320, from zero, without the final inversion.
std::uint32_t crc32(std::string_view bytes) {
    static const std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t c = i;
            for (int k = 0; k < 8; ++k) c = (c & 1U) != 0 ? c >> 1 ^ 0xEDB88320U : c >> 1;
            t[i] = c;
        }
        return t;
    }();
    std::uint32_t crc = 0;
    for (const char b : bytes) crc = table[(crc ^ static_cast<unsigned char>(b)) & 0xFFU] ^ crc >> 8;
    return crc;
}

/// Factors of raw IMU counts to increments in rad and m/s, by the type of the IMU (the table of RAWIMU).
struct ImuScale {
    double gyro = 0.0, accel = 0.0;
};
const ImuScale* scale_of(int type) {
    constexpr double foot = 0.3048, arcsec = units::deg / 3600.0, p33 = 0x1p-33, p27 = 0x1p-27 * foot, mg = units::g0 / 1000.0;
    static const std::map<int, ImuScale> scales = {
        {1, {p33, p27}},                                            // HG1700 AG11
        {4, {p33, 2.0 * p27}},                                      // HG1700 AG17
        {5, {p33, p27}},                                            // HG1900 CA29
        {8, {0x1p-19, 0x1p-14}},                                    // LN200
        {11, {p33, p27}},                                           // HG1700 AG58
        {12, {p33, 2.0 * p27}},                                     // HG1700 AG62
        {13, {0.1 * 0x1p-8 * arcsec, 0.05 * 0x1p-15}},              // iIMU-FSAS
        {20, {p33, p27}},                                           // HG1930 AA99
        {27, {p33, p27}},                                           // HG1900 CA50
        {28, {p33, p27}},                                           // HG1930 CA50
        {31, {720.0 * 0x1p-31 * units::deg, 200.0 * 0x1p-31}},      // ADIS16488
        {32, {0x1p-21 * units::deg, 0x1p-22}},                      // STIM300
        {41, {0.008 / 65536.0 / 125.0 * units::deg, 0.2 / 65536.0 * mg / 125.0}},       // EPSON G320
        {56, {0x1p-21 * units::deg, 0x1p-22}},                      // STIM300D
        {58, {p33, 0x1p-29}},                                       // HG4930 AN01
        {61, {0.0151515 / 65536.0 / 200.0 * units::deg, 0.4 / 65536.0 * mg / 200.0}},   // EPSON G370
    };
    const auto it = scales.find(type);
    return it == scales.end() ? nullptr : &it->second;
}

FixType fix_of_code(unsigned type) {
    if (type == 0) return FixType::None;
    if (type == 16 || type == 8 || type == 1 || type == 2 || type == 53) return FixType::Autonomous;
    if (type == 17 || type == 18 || type == 54 || (type >= 68 && type <= 70) || (type >= 77 && type <= 80)) return FixType::Differential;
    if (type == 48 || type == 49 || type == 50 || type == 51 || type == 56) return FixType::RtkFixed;
    if (type == 32 || type == 33 || type == 34 || type == 55 || type == 19 || type == 20) return FixType::RtkFloat;
    return FixType::Unknown;
}
FixType fix_of_word(std::string_view word) {
    static const std::map<std::string_view, unsigned> codes = {
        {"NONE", 0}, {"FIXEDPOS", 1}, {"FIXEDHEIGHT", 2}, {"DOPPLER_VELOCITY", 8}, {"SINGLE", 16}, {"PSRDIFF", 17}, {"WAAS", 18}, {"SBAS", 18},
        {"PROPAGATED", 19}, {"L1_FLOAT", 32}, {"IONOFREE_FLOAT", 33}, {"NARROW_FLOAT", 34}, {"L1_INT", 48}, {"WIDE_INT", 49}, {"NARROW_INT", 50},
        {"RTK_DIRECT_INS", 51}, {"INS_SBAS", 54}, {"INS_PSRSP", 53}, {"INS_PSRDIFF", 54}, {"INS_RTKFLOAT", 55}, {"INS_RTKFIXED", 56},
        {"PPP_CONVERGING", 68}, {"PPP", 69}, {"OPERATIONAL", 70}, {"INS_PPP_CONVERGING", 73}, {"INS_PPP", 74}};
    const auto it = codes.find(word);
    return it == codes.end() ? FixType::Unknown : fix_of_code(it->second);
}

class NovatelReader {
public:
    std::size_t read_logs = 0, damaged = 0, first_damaged = 0;
    std::set<std::string> others;
    std::optional<int> unknown_imu;

    void read(std::string_view bytes) {
        std::size_t at = 0;
        while (at < bytes.size()) {
            at = std::min(bytes.find('\xaa', at), bytes.find_first_of("#%", at));
            if (at == std::string_view::npos) return;
            const std::string_view rest = bytes.substr(at);
            std::size_t used = 0;
            if (rest.starts_with(long_sync) || rest.starts_with(short_sync))
                used = binary(rest);
            else if (rest[0] != '\xaa' && rest.size() > 2 && rest[1] >= 'A' && rest[1] <= 'Z' && rest[2] >= 'A')
                used = ascii(rest);
            else {
                ++at;
                continue;
            }
            if (used == 0) {
                if (damaged++ == 0) first_damaged = at;
                used = 1;
            }
            at += used;
        }
    }

    void finish(StreamLog& log) {
        log.clock = Clock::Gps;
        log.add(std::move(imu_));
        log.add(std::move(corrected_));
        Stream fixes("gnss", TableKind::Gnss, "BESTPOS, BESTVEL",
                     {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_n_m", "std_e_m", "std_d_m", "satellites"});
        for (const auto& [ns, f] : fixes_) {
            if (!std::isfinite(f.position.lat)) continue;
            fixes.add(ns, {f.position.lat, f.position.lon, f.position.h, f.velocity_n.x(), f.velocity_n.y(), f.velocity_n.z(), f.std_position.x(),
                           f.std_position.y(), f.std_position.z(), static_cast<double>(f.satellites)});
            fixes.fix.push_back(f.fix);
        }
        log.add(std::move(fixes));
        log.add(std::move(solution_));
    }

private:
    std::size_t binary(std::string_view b) {
        const bool is_short = b.starts_with(short_sync);
        if (b.size() < short_header + crc_size) return 0;
        const std::size_t header = is_short ? short_header : static_cast<unsigned char>(b[3]);
        const std::size_t body = is_short ? static_cast<unsigned char>(b[3]) : load<std::uint16_t>(b, 8);
        if (header < short_header || b.size() < header + body + crc_size || (!is_short && header < 28)) return 0;
        if (crc32(b.substr(0, header + body)) != load<std::uint32_t>(b, header + body)) return 0;
        const int id = load<std::uint16_t>(b, 4);
        const int week = is_short ? load<std::uint16_t>(b, 6) : load<std::uint16_t>(b, 14);
        const std::uint32_t ms = is_short ? load<std::uint32_t>(b, 8) : load<std::uint32_t>(b, 16);
        message(id, Time::from_gps(week, 0.0).ns + std::int64_t{ms} * 1'000'000, b.substr(header, body));
        return header + body + crc_size;
    }

    /// Numbers of a binary log, each at its place; a log of another length is passed over.
    void message(int id, std::int64_t ns, std::string_view p) {
        const auto d = [&](std::size_t at) { return load<double>(p, at); };
        const auto f = [&](std::size_t at) { return static_cast<double>(load<float>(p, at)); };
        const auto i = [&](std::size_t at) { return static_cast<double>(load<std::int32_t>(p, at)); };
        ++read_logs;
        switch (id) {
            case 42:   // BESTPOS: undulation is of the geoid
                if (p.size() >= 72)
                    position(ns, load<std::uint32_t>(p, 0) == 0, fix_of_code(load<std::uint32_t>(p, 4)), {d(8), d(16), d(24) + f(32)}, {f(40), f(44), f(48)},
                             static_cast<unsigned char>(p[65]));
                break;
            case 99:   // BESTVEL
                if (p.size() >= 44) velocity(ns, load<std::uint32_t>(p, 0) == 0, d(16), d(24), d(32));
                break;
            case 507: case 508:   // INSPVA, INSPVAS
                if (p.size() >= 88)
                    solution(week_time(load<std::uint32_t>(p, 0), d(4)), {d(12), d(20), d(28), d(36), d(44), d(52), d(60), d(68), d(76)},
                             load<std::uint32_t>(p, 84));
                break;
            case 1465:   // INSPVAX
                if (p.size() >= 88) solution(ns, {d(8), d(16), d(24) + f(32), d(36), d(44), d(52), d(60), d(68), d(76)}, load<std::uint32_t>(p, 0));
                break;
            case 268: case 325:   // RAWIMU, RAWIMUS
                if (p.size() >= 40) raw_imu(week_time(load<std::uint32_t>(p, 0), d(4)), imu_type_, i(16), i(20), i(24), i(28), i(32), i(36));
                break;
            case 1461: case 1462:   // RAWIMUX, RAWIMUSX
                if (p.size() >= 40) raw_imu(week_time(load<std::uint16_t>(p, 2), d(4)), static_cast<unsigned char>(p[1]), i(16), i(20), i(24), i(28), i(32), i(36));
                break;
            case 812: case 813:   // CORRIMUDATA(S): increments, right-forward-up
                if (p.size() >= 60) corrected(week_time(load<std::uint32_t>(p, 0), d(4)), {d(12), d(20), d(28), d(36), d(44), d(52)});
                break;
            default: --read_logs; others.insert(std::to_string(id)); break;
        }
    }

    static std::int64_t week_time(std::uint32_t week, double seconds) {
        return seconds >= 0.0 && seconds < 1e6 ? Time::from_gps(static_cast<int>(std::min(week, 10'000U)), seconds).ns : 0;
    }

    std::size_t ascii(std::string_view text) {
        const std::size_t star = text.find('*'), end = text.find('\n');
        if (star == std::string_view::npos || star > 4096 || (end != std::string_view::npos && end < star) || text.size() < star + 9) return 0;
        const std::string_view content = text.substr(1, star - 1);
        std::uint32_t crc = 0;
        for (const char c : text.substr(star + 1, 8)) {
            const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
            if (digit < 0) return 0;
            crc = crc << 4 | static_cast<unsigned>(digit);
        }
        if (crc32(content) != crc) return 0;
        const std::size_t semicolon = content.find(';');
        if (semicolon == std::string_view::npos) return star + 9;
        const std::vector<std::string_view> h = split(content.substr(0, semicolon)), c = split(content.substr(semicolon + 1));
        const bool is_short = text[0] == '%';
        const std::size_t week_at = is_short ? 1 : 5;
        if (h.size() < week_at + 2) return star + 9;
        sentence(h[0], week_time(static_cast<std::uint32_t>(number(h, week_at)), number(h, week_at + 1)), c);
        return star + 9;
    }

    static std::vector<std::string_view> split(std::string_view text) {
        std::vector<std::string_view> cells;
        while (true) {
            const std::size_t end = text.find(',');
            cells.push_back(text.substr(0, end));
            if (end == std::string_view::npos) return cells;
            text.remove_prefix(end + 1);
        }
    }
    static double number(const std::vector<std::string_view>& cells, std::size_t i) { return i < cells.size() ? number_from(cells[i]) : not_given; }

    void sentence(std::string_view name, std::int64_t ns, const std::vector<std::string_view>& c) {
        const auto n = [&](std::size_t i) { return number(c, i); };
        const auto time = [&] { return week_time(static_cast<std::uint32_t>(n(0)), n(1)); };
        ++read_logs;
        if (name == "BESTPOSA" && c.size() >= 15) {
            position(ns, c[0] == "SOL_COMPUTED", fix_of_word(c[1]), {n(2), n(3), n(4) + n(5)}, {n(7), n(8), n(9)}, n(14));
        } else if (name == "BESTVELA" && c.size() >= 7) {
            velocity(ns, c[0] == "SOL_COMPUTED", n(4), n(5), n(6));
        } else if ((name == "INSPVAA" || name == "INSPVASA") && c.size() >= 12) {
            solution(time(), {n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10)}, c[11] == "INS_INACTIVE" ? 0 : 3);
        } else if (name == "INSPVAXA" && c.size() >= 12) {
            solution(ns, {n(2), n(3), n(4) + n(5), n(6), n(7), n(8), n(9), n(10), n(11)}, c[0] == "INS_INACTIVE" ? 0 : 3);
        } else if ((name == "RAWIMUA" || name == "RAWIMUSA") && c.size() >= 9) {
            raw_imu(time(), imu_type_, n(3), n(4), n(5), n(6), n(7), n(8));
        } else if ((name == "RAWIMUXA" || name == "RAWIMUSXA") && c.size() >= 11) {
            raw_imu(week_time(static_cast<std::uint32_t>(n(2)), n(3)), static_cast<int>(n(1)), n(5), n(6), n(7), n(8), n(9), n(10));
        } else if ((name == "CORRIMUDATAA" || name == "CORRIMUDATASA") && c.size() >= 8) {
            corrected(time(), {n(2), n(3), n(4), n(5), n(6), n(7)});
        } else {
            --read_logs;
            others.insert(std::string(name));
        }
    }

    void position(std::int64_t ns, bool computed, FixType fix, const std::array<double, 3>& p, const std::array<double, 3>& sigma, double satellites) {
        GnssFix& f = fixes_[ns];
        if (!computed) fix = FixType::None;
        f.position = {p[0], p[1], p[2]};   // degrees, as the stream has them
        f.std_position = {sigma[0], sigma[1], sigma[2]};
        f.satellites = satellites >= 0.0 && satellites < 1000.0 ? static_cast<int>(satellites) : -1;
        f.fix = fix;
    }
    void velocity(std::int64_t ns, bool computed, double speed, double course_deg, double up) {
        if (!computed) return;
        auto [it, is_new] = fixes_.try_emplace(ns);
        if (is_new) it->second.position = {not_given, not_given, not_given};
        it->second.velocity_n = {speed * std::cos(course_deg * units::deg), speed * std::sin(course_deg * units::deg), -up};
    }
    /// lat, lon, height, north, east, up, roll, pitch, azimuth
    void solution(std::int64_t ns, const std::array<double, 9>& s, std::uint32_t status) {
        if (status == 0 || ns == 0) return;
        solution_.add(ns, {s[0], s[1], s[2], s[3], s[4], -s[5], s[6], s[7], s[8]});
    }
    void raw_imu(std::int64_t ns, int type, double az, double minus_ay, double ax, double gz, double minus_gy, double gx) {
        const ImuScale* scale = scale_of(type);
        if (ns == 0) return;
        if (scale == nullptr) {
            unknown_imu = type;
            return;
        }
        // x right, y forward, z up to forward, right, down
        const double wx = gx * scale->gyro, wy = -minus_gy * scale->gyro, wz = gz * scale->gyro;
        const double vx = ax * scale->accel, vy = -minus_ay * scale->accel, vz = az * scale->accel;
        imu_.add(ns, {wy, wx, -wz, vy, vx, -vz});
    }
    /// pitch, roll, yaw increments about right, forward, up; lateral, longitudinal, vertical velocity
    void corrected(std::int64_t ns, const std::array<double, 6>& v) {
        if (ns == 0) return;
        corrected_.add(ns, {v[1], v[0], -v[2], v[4], v[3], -v[5]});
    }

    Stream imu_{"imu", TableKind::Imu, "RAWIMU", {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"}};
    Stream corrected_{"imu_corrected", TableKind::Imu, "CORRIMUDATA", {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"}};
    Stream solution_{"reference", TableKind::Reference, "INSPVA",
                     {"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg"}};
    std::map<std::int64_t, GnssFix> fixes_;
    int imu_type_ = -1;
};

StreamLog read_novatel(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    NovatelReader reader;
    reader.read(bytes);
    StreamLog log;
    reader.finish(log);
    if (reader.damaged > 0)
        warnings.add(input.name() + " novatel.damaged", fmt::format("{}: damaged logs, the first at byte {}: skipped", input.name(), reader.first_damaged), reader.damaged);
    if (reader.unknown_imu)
        warnings.add(input.name() + " novatel.imu",
                     fmt::format("{}: the raw IMU logs are not used: the scale of IMU type {} is not known (log RAWIMUSX, or CORRIMUDATA)", input.name(), *reader.unknown_imu));
    if (!log.streams.empty()) return log;
    std::string names;
    for (const std::string& name : reader.others) names += (names.empty() ? "" : ", ") + name;
    throw input_error("holds no position and no inertial data that are used", place_in(input.name()),
                      fmt::format("log BESTPOS, BESTVEL, RAWIMUSX or CORRIMUDATAS, INSPVA{}", names.empty() ? "" : "; it has " + names));
}

bool is_novatel(const FileHead& head) {
    const std::string_view bytes = head.bytes;
    for (std::size_t at = bytes.find("\xaa\x44"); at != std::string_view::npos && at + 16 < bytes.size(); at = bytes.find("\xaa\x44", at + 2)) {
        const bool is_short = bytes[at + 2] == '\x13';
        if (!is_short && bytes[at + 2] != '\x12') continue;
        const std::size_t header = is_short ? short_header : static_cast<unsigned char>(bytes[at + 3]);
        const std::size_t body = is_short ? static_cast<unsigned char>(bytes[at + 3]) : load<std::uint16_t>(bytes, at + 8);
        const std::string_view rest = bytes.substr(at);
        if (header >= short_header && rest.size() >= header + body + crc_size && crc32(rest.substr(0, header + body)) == load<std::uint32_t>(rest, header + body)) return true;
    }
    for (Lines lines(bytes.substr(0, 20'000)); lines.next();) {
        const std::string_view line = lines.line();
        const std::size_t star = line.find('*');
        if ((line.starts_with('#') || line.starts_with('%')) && star != std::string_view::npos && line.find(';') < star && line.size() >= star + 9 &&
            fmt::format("{:08x}", crc32(line.substr(1, star - 1))) == line.substr(star + 1, 8))
            return true;
    }
    return false;
}

}  // namespace

extern const Format novatel_format;
const Format novatel_format = {
    .name = "novatel",
    .title = "NovAtel OEM",
    .extensions = ".gps .novatel .asc",
    .holds = "BESTPOS and BESTVEL as fixes, RAWIMUX, RAWIMUSX, CORRIMUDATA(S) as increments (of IMUs whose scale is known), INSPVA(S) and INSPVAX as reference; "
             "ASCII and binary, mixed; axes forward-right-down",
    .time = "GPS time",
    .recognise = is_novatel,
    .read = read_novatel};

}  // namespace schuler::io
