// NovAtel OEM logs, ASCII and binary, mixed or not [NovAtelOEM7].
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/receiver/detail/novatel_frames.h"
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
using detail::NovatelMessage;

/// Factors of raw IMU counts to increments in rad and m/s, by the type of the IMU (the table of RAWIMU).
struct ImuScale {
    double gyro = 0.0, accel = 0.0;
};
const ImuScale* scale_of(int type) {
    constexpr double foot = 0.3048, arcsec = units::deg / 3600.0, p33 = 0x1p-33, p27 = 0x1p-27 * foot, mg = units::g0 / 1000.0;
    static const std::map<int, ImuScale> scales = {
        {1, {p33, p27}},                                                               // HG1700 AG11
        {4, {p33, 2.0 * p27}},                                                         // HG1700 AG17
        {5, {p33, p27}},                                                               // HG1900 CA29
        {8, {0x1p-19, 0x1p-14}},                                                       // LN200
        {11, {p33, p27}},                                                              // HG1700 AG58
        {12, {p33, 2.0 * p27}},                                                        // HG1700 AG62
        {13, {0.1 * 0x1p-8 * arcsec, 0.05 * 0x1p-15}},                                 // iIMU-FSAS
        {16, {0.1 / (3600.0 * 256.0), 0.05 * 0x1p-15}},                                // KVH COTS (CPT)
        {20, {p33, p27}},                                                              // HG1930 AA99
        {26, {1e-9, 2e-8}},                                                            // ISA-100C
        {27, {p33, p27}},                                                              // HG1900 CA50
        {28, {p33, p27}},                                                              // HG1930 CA50
        {31, {720.0 * 0x1p-31 * units::deg, 200.0 * 0x1p-31}},                         // ADIS16488
        {32, {0x1p-21 * units::deg, 0x1p-22}},                                         // STIM300
        {33, {0.1 / (3600.0 * 256.0), 0.05 * 0x1p-15}},                                // KVH 1750
        {34, {1e-9, 2e-8}},                                                            // ISA-100
        {38, {1e-9, 2e-8}},                                                            // ISA-100, 400 Hz
        {39, {1e-9, 2e-8}},                                                            // ISA-100C, 400 Hz
        {41, {0.008 / 65536.0 / 125.0 * units::deg, 0.2 / 65536.0 * mg / 125.0}},      // EPSON G320
        {52, {1e-9, 2e-8}},                                                            // LITEF uIMU
        {56, {0x1p-21 * units::deg, 0x1p-22}},                                         // STIM300D
        {58, {p33, 0x1p-29}},                                                          // HG4930 AN01
        {61, {0.0151515 / 65536.0 / 200.0 * units::deg, 0.4 / 65536.0 * mg / 200.0}},  // EPSON G370
        {62, {0.008 / 65536.0 / 200.0 * units::deg, 0.2 / 65536.0 * mg / 200.0}},      // EPSON G320, 200 Hz
        {68, {p33, 0x1p-29}},                                                          // HG4930 AN04
        {69, {p33, 0x1p-29}},                                                          // HG4930 AN04, 400 Hz
    };
    const auto it = scales.find(type);
    return it == scales.end() ? nullptr : &it->second;
}

/// The type of an IMU by its name in CONNECTIMU, SETIMUTYPE and INSCONFIG; -1 if not listed above.
int type_of(std::string_view name) {
    if (name.starts_with("IMU_")) name.remove_prefix(4);
    // clang-format off
    static const std::map<std::string_view, int> types = {
        {"HG1700_AG11", 1},  {"HG1700_AG17", 4},  {"HG1900_CA29", 5}, {"LN200", 8},         {"HG1700_AG58", 11}, {"HG1700_AG62", 12},      {"IMAR_FSAS", 13},
        {"KVH_COTS", 16},    {"HG1930_AA99", 20}, {"ISA100C", 26},    {"HG1900_CA50", 27},  {"HG1930_CA50", 28}, {"ADIS16488", 31},        {"STIM300", 32},
        {"KVH_1750", 33},    {"ISA100", 34},      {"ISA100_400HZ", 38}, {"ISA100C_400HZ", 39}, {"EPSON_G320", 41}, {"LITEF_MICROIMU", 52}, {"STIM300D", 56},
        {"HG4930_AN01", 58}, {"EPSON_G370", 61},  {"EPSON_G320_200HZ", 62}, {"HG4930_AN04", 68}, {"HG4930_AN04_400HZ", 69}};
    // clang-format on
    const auto it = types.find(name);
    return it == types.end() ? -1 : it->second;
}

/// RAWIMU does not contain its IMU type: a command in the log of the configuration may.
int configured_imu(std::string_view bytes) {
    for (const std::string_view command : {std::string_view("CONNECTIMU"), std::string_view("SETIMUTYPE")}) {
        for (std::size_t at = bytes.find(command); at != std::string_view::npos; at = bytes.find(command, at + 1)) {
            std::string_view text = bytes.substr(at + command.size(), 160);
            text = text.substr(0, text.find_first_of("*\r\n"));
            while (!text.empty()) {
                const std::size_t end = text.find_first_of(" ,;");
                if (const int type = type_of(text.substr(0, end)); type >= 0) return type;
                if (end == std::string_view::npos) break;
                text.remove_prefix(end + 1);
            }
        }
    }
    return -1;
}

FixType fix_of_code(unsigned type) {
    constexpr unsigned propagated = 19;
    if (type == 0 || type == propagated) return FixType::None;  // or without measurements of its own
    if (type == 16 || type == 8 || type == 1 || type == 2 || type == 53) return FixType::Autonomous;
    if (type == 17 || type == 18 || type == 52 || type == 54 || (type >= 68 && type <= 74) || (type >= 77 && type <= 80))
        return FixType::Differential;
    if (type == 48 || type == 49 || type == 50 || type == 51 || type == 56) return FixType::RtkFixed;
    if (type == 32 || type == 33 || type == 34 || type == 55) return FixType::RtkFloat;
    return FixType::Unknown;
}
unsigned code_of(std::string_view word) {
    // clang-format off
    static const std::map<std::string_view, unsigned> codes = {
        {"NONE", 0}, {"FIXEDPOS", 1}, {"FIXEDHEIGHT", 2}, {"DOPPLER_VELOCITY", 8}, {"SINGLE", 16}, {"PSRDIFF", 17}, {"WAAS", 18}, {"SBAS", 18},
        {"PROPAGATED", 19}, {"L1_FLOAT", 32}, {"IONOFREE_FLOAT", 33}, {"NARROW_FLOAT", 34}, {"L1_INT", 48}, {"WIDE_INT", 49}, {"NARROW_INT", 50},
        {"RTK_DIRECT_INS", 51}, {"INS_SBAS", 52}, {"INS_PSRSP", 53}, {"INS_PSRDIFF", 54}, {"INS_RTKFLOAT", 55}, {"INS_RTKFIXED", 56},
        {"PPP_CONVERGING", 68}, {"PPP", 69}, {"OPERATIONAL", 70}, {"WARNING", 71}, {"OUT_OF_BOUNDS", 72}, {"INS_PPP_CONVERGING", 73}, {"INS_PPP", 74},
        {"PPP_BASIC_CONVERGING", 77}, {"PPP_BASIC", 78}, {"INS_PPP_BASIC_CONVERGING", 79}, {"INS_PPP_BASIC", 80}};
    // clang-format on
    const auto it = codes.find(word);
    constexpr unsigned unknown = 1000;
    return it == codes.end() ? unknown : it->second;
}

/// True if the receiver's solution includes its inertial unit (INS types).
bool is_blended(unsigned type) { return (type >= 51 && type <= 56) || type == 73 || type == 74 || type == 79 || type == 80; }

class NovatelReader {
public:
    std::set<std::string> others;
    std::optional<int> unknown_imu;
    detail::NovatelScan scan;
    std::size_t corrected = 0;   ///< logs of IMU data with gravity removed
    std::size_t blended = 0;     ///< fixes of the first kind that include the receiver's own integration
    std::size_t compressed = 0;  ///< raw measurements in an unsupported form
    bool encrypted = false;

    void read(std::string_view bytes) {
        imu_type_ = configured_imu(bytes);
        scan = detail::scan_novatel(bytes, [this](const NovatelMessage& m) {
            if (m.secondary) return true;  // from the second antenna
            if (detail::is_compressed(m)) ++compressed;
            else if (m.name.empty()) message(m.id, m.ns, m.payload);
            else sentence(m.name, m.ns, m.cells);
            return true;
        });
    }

    void finish(StreamLog& log) {
        log.clock = Clock::Gps;
        if (!waiting_.empty()) unknown_imu = -1;
        for (const char* readable : {"43", "RANGE", "140", "RANGECMP"})
            if (others.contains(readable)) compressed = 0;  // the same data
        log.add(std::move(imu_));
        // solutions without the receiver's own integration first
        static constexpr std::array<const char*, 3> sources = {"BESTGNSSPOS, BESTGNSSVEL", "BESTPOS, BESTVEL", "PSRPOS, PSRVEL"};
        for (std::size_t k = 0; k < sources.size(); ++k) {
            Stream fixes("gnss", TableKind::Gnss, sources[k],
                         {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "vel_time_valid_s",
                          "std_n_m", "std_e_m", "std_d_m", "satellites"});
            for (const auto& [ns, f] : fixes_[k]) {
                if (!std::isfinite(f.position.lat)) continue;
                fixes.add(ns, {f.position.lat, f.position.lon, f.position.h, f.velocity_n.x(), f.velocity_n.y(), f.velocity_n.z(),
                               f.velocity_age > 0.0 ? (Time{ns} - Duration::from_seconds(f.velocity_age)).seconds() : not_given,
                               f.std_position.x(), f.std_position.y(), f.std_position.z(), static_cast<double>(f.satellites)});
                fixes.fix.push_back(f.fix);
            }
            if (log.find("gnss") == nullptr && fixes.rows() > 0) blended = blended_[k];
            log.add(std::move(fixes));
        }
        log.add(std::move(solution_));
    }

private:
    /// Numbers of a binary log by position; a log of another length is ignored.
    void message(int id, std::int64_t ns, std::string_view p) {
        const auto d = [&](std::size_t at) { return load<double>(p, at); };
        const auto f = [&](std::size_t at) { return static_cast<double>(load<float>(p, at)); };
        const auto i = [&](std::size_t at) { return static_cast<double>(load<std::int32_t>(p, at)); };
        switch (id) {
            case 42:
            case 47:
            case 1429:  // BESTPOS, PSRPOS, BESTGNSSPOS: undulation is of the geoid
                if (p.size() >= 72)
                    position(id == 1429 ? 0
                             : id == 42 ? 1
                                        : 2,
                             ns, load<std::uint32_t>(p, 0) == 0, load<std::uint32_t>(p, 4), {d(8), d(16), d(24) + f(32)},
                             {f(40), f(44), f(48)}, static_cast<unsigned char>(p[65]));
                break;
            case 99:
            case 100:
            case 1430:  // BESTVEL, PSRVEL, BESTGNSSVEL
                if (p.size() >= 44)
                    velocity(id == 1430 ? 0 : id == 99 ? 1 : 2, ns, load<std::uint32_t>(p, 0) == 0, f(8), d(16), d(24), d(32));
                break;
            case 507:
            case 508:  // INSPVA, INSPVAS
                if (p.size() >= 88)
                    solution(week_time(load<std::uint32_t>(p, 0), d(4)),
                             {d(12), d(20), d(28), d(36), d(44), d(52), d(60), d(68), d(76)}, load<std::uint32_t>(p, 84));
                break;
            case 1465:  // INSPVAX
                if (p.size() >= 88)
                    solution(ns, {d(8), d(16), d(24) + f(32), d(36), d(44), d(52), d(60), d(68), d(76)},
                             load<std::uint32_t>(p, 0));
                break;
            case 268:
            case 325:  // RAWIMU, RAWIMUS
                if (p.size() >= 40)
                    raw_imu(week_time(load<std::uint32_t>(p, 0), d(4)), imu_type_, i(16), i(20), i(24), i(28), i(32), i(36));
                break;
            case 1461:
            case 1462:  // RAWIMUX, RAWIMUSX
                if (p.size() >= 40)
                    raw_imu(week_time(load<std::uint16_t>(p, 2), d(4)),
                            type_in(static_cast<unsigned char>(p[0]), static_cast<unsigned char>(p[1])), i(16), i(20), i(24),
                            i(28), i(32), i(36));
                break;
            case 812:
            case 813:
            case 1362:
            case 2264: ++corrected; break;  // CORRIMUDATA(S), IMURATECORRIMUS, CORRIMUS: gravity is removed
            case 1945:
                if (const auto type = p.size() >= 4 ? load<std::int32_t>(p, 0) : 0; imu_type_ < 0 && type > 0) name_imu(type);
                break;  // INSCONFIG
            default: others.insert(std::to_string(id)); break;
        }
    }

    /// Bit 1 of a raw log's first byte: encrypted.
    int type_in(int information, int type) {
        encrypted = encrypted || (information & 2) != 0;
        if (imu_type_ != type) name_imu(type);
        return (information & 2) != 0 ? -2 : type < 0 ? -3 : type;  // encrypted; an unknown name
    }

    static std::int64_t week_time(std::uint32_t week, double seconds) { return detail::novatel_time(week, seconds); }

    static double number(const std::vector<std::string_view>& cells, std::size_t i) {
        return i < cells.size() ? number_from(cells[i]) : not_given;
    }

    void sentence(std::string_view name, std::int64_t ns, const std::vector<std::string_view>& c) {
        const auto n = [&](std::size_t i) { return number(c, i); };
        const auto time = [&] { return detail::novatel_time(n(0), n(1)); };
        if ((name == "BESTPOS" || name == "BESTGNSSPOS" || name == "PSRPOS") && c.size() >= 15) {
            position(name == "BESTGNSSPOS" ? 0
                     : name == "BESTPOS"   ? 1
                                           : 2,
                     ns, c[0] == "SOL_COMPUTED", code_of(c[1]), {n(2), n(3), n(4) + n(5)}, {n(7), n(8), n(9)}, n(14));
        } else if ((name == "BESTVEL" || name == "BESTGNSSVEL" || name == "PSRVEL") && c.size() >= 7) {
            velocity(name == "BESTGNSSVEL" ? 0 : name == "BESTVEL" ? 1 : 2, ns, c[0] == "SOL_COMPUTED", n(2), n(4), n(5), n(6));
        } else if ((name == "INSPVA" || name == "INSPVAS") && c.size() >= 12) {
            solution(time(), {n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10)}, status_of(c[11]));
        } else if (name == "INSPVAX" && c.size() >= 12) {
            solution(ns, {n(2), n(3), n(4) + n(5), n(6), n(7), n(8), n(9), n(10), n(11)}, status_of(c[0]));
        } else if ((name == "RAWIMU" || name == "RAWIMUS") && c.size() >= 9) {
            raw_imu(time(), imu_type_, n(3), n(4), n(5), n(6), n(7), n(8));
        } else if ((name == "RAWIMUX" || name == "RAWIMUSX") && c.size() >= 11) {
            const int information = c[0].empty() || c[0].back() < '0' || c[0].back() > '3' ? 0 : c[0].back() - '0';
            const int type = n(1) >= 0.0 && n(1) < 1000.0 ? static_cast<int>(n(1)) : type_of(c[1]);
            raw_imu(detail::novatel_time(n(2), n(3)), type_in(information, type), n(5), n(6), n(7), n(8), n(9), n(10));
        } else if (name == "CORRIMUDATA" || name == "CORRIMUDATAS" || name == "IMURATECORRIMUS" || name == "CORRIMUS") {
            ++corrected;
        } else if (name == "INSCONFIG") {
            if (imu_type_ < 0 && !c.empty()) name_imu(type_of(c[0]));
        } else {
            others.insert(std::string(name));
        }
    }

    static std::uint32_t status_of(std::string_view word) {
        return word == "INS_SOLUTION_GOOD"                                                                         ? 3
               : word == "INS_HIGH_VARIANCE" || word == "INS_BAD_GPS_AGREEMENT" || word == "INS_SOLUTION_NOT_GOOD" ? 2
               : word == "INS_SOLUTION_FREE"                                                                       ? 6
               : word == "INS_ALIGNMENT_COMPLETE"                                                                  ? 7
                                                                                                                   : 0;
    }

    void position(std::size_t source, std::int64_t ns, bool computed, unsigned type, const std::array<double, 3>& p,
                  const std::array<double, 3>& sigma, double satellites) {
        if (ns == 0) return;
        GnssFix& f = fixes_[source][ns];
        if (computed && is_blended(type)) ++blended_[source];
        f.position = {p[0], p[1], p[2]};  // degrees, as in the stream
        f.std_position = {sigma[0], sigma[1], sigma[2]};
        f.satellites = satellites >= 0.0 && satellites < 1000.0 ? static_cast<int>(satellites) : -1;
        f.fix = computed ? fix_of_code(type) : FixType::None;
    }
    /// `latency`: s, age of the velocity relative to its log.
    void velocity(std::size_t source, std::int64_t ns, bool computed, double latency, double speed, double course_deg,
                  double up) {
        constexpr double longest = 10.0;  // s
        if (!computed || ns == 0) return;
        auto [it, is_new] = fixes_[source].try_emplace(ns);
        if (is_new) it->second.position = {not_given, not_given, not_given};
        it->second.velocity_n = {speed * std::cos(course_deg * units::deg), speed * std::sin(course_deg * units::deg), -up};
        it->second.velocity_age = latency > 0.0 && latency < longest ? latency : 0.0;
    }
    /// lat, lon, height, north, east, up, roll, pitch, azimuth
    void solution(std::int64_t ns, const std::array<double, 9>& s, std::uint32_t status) {
        if (ns == 0 || (status != 2 && status != 3 && status != 6 && status != 7))
            return;  // no attitude, or alignment not complete
        solution_.add(ns, {s[0], s[1], s[2], s[3], s[4], -s[5], s[6], s[7], s[8]});
    }
    struct Increments {
        std::int64_t ns;
        double az, minus_ay, ax, gz, minus_gy, gx;
    };

    /// The log has identified the IMU of RAWIMU: this also applies to earlier data.
    void name_imu(int type) {
        imu_type_ = type;
        if (type < 0) return;
        for (const Increments& i : waiting_) scaled(i, type);
        waiting_.clear();
    }
    void raw_imu(std::int64_t ns, int type, double az, double minus_ay, double ax, double gz, double minus_gy, double gx) {
        if (ns == 0) return;
        const Increments one{ns, az, minus_ay, ax, gz, minus_gy, gx};
        if (type == -1) waiting_.push_back(one);
        else scaled(one, type);
    }
    void scaled(const Increments& i, int type) {
        const ImuScale* scale = scale_of(type);
        if (scale == nullptr) {
            unknown_imu = type;
            return;
        }
        // x right, y forward, z up to forward, right, down
        const double wx = i.gx * scale->gyro, wy = -i.minus_gy * scale->gyro, wz = i.gz * scale->gyro;
        const double vx = i.ax * scale->accel, vy = -i.minus_ay * scale->accel, vz = i.az * scale->accel;
        imu_.add(i.ns, {wy, wx, -wz, vy, vx, -vz});
    }

    Stream imu_{
        "imu", TableKind::Imu, "RAWIMU", {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"}};
    Stream solution_{
        "reference",
        TableKind::Reference,
        "INSPVA",
        {"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg"}};
    std::array<std::map<std::int64_t, GnssFix>, 3> fixes_;
    std::array<std::size_t, 3> blended_{};
    std::vector<Increments> waiting_;  ///< from RAWIMU, before the log identifies the IMU
    int imu_type_ = -1;
};

StreamLog read_novatel(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    NovatelReader reader;
    reader.read(bytes);
    StreamLog log;
    reader.finish(log);
    if (reader.scan.damaged > 0)
        warnings.add(input.name() + " novatel.damaged",
                     fmt::format("{}: damaged logs, the first at byte {}: skipped", input.name(), reader.scan.first_damaged),
                     reader.scan.damaged);
    if (reader.unknown_imu)
        warnings.add(
            input.name() + " novatel.imu",
            reader.encrypted ? fmt::format("{}: the raw IMU logs are encrypted: not used", input.name())
            : *reader.unknown_imu < 0
                ? fmt::format(
                      "{}: the raw IMU logs are not used: RAWIMU does not state the type of its IMU (log RAWIMUX, or INSCONFIG once)",
                      input.name())
                : fmt::format("{}: the raw IMU logs are not used: the scale of IMU type {} is not known", input.name(),
                              *reader.unknown_imu));
    if (reader.corrected > 0)
        warnings.add(input.name() + " novatel.corrected",
                     fmt::format("{}: CORRIMUDATA is without gravity and the Earth's rotation: not used as an IMU (log RAWIMUX)",
                                 input.name()),
                     reader.corrected);
    if (reader.blended > 0)
        warnings.add(
            input.name() + " novatel.blended",
            fmt::format(
                "{}: fixes of the receiver's own integration with its inertial unit (INS types of BESTPOS): their errors are not "
                "independent of that unit's, sigmas of a solution with both are too small (log BESTGNSSPOS)",
                input.name()),
            reader.blended);
    if (reader.compressed > 0) detail::tell_compressed(input.name(), reader.compressed, warnings);
    if (!log.streams.empty()) return log;
    std::string names;
    for (const std::string& name : reader.others) names += (names.empty() ? "" : ", ") + name;
    throw input_error("holds no position and no inertial data that are used", place_in(input.name()),
                      fmt::format("log BESTPOS, BESTVEL, RAWIMUX, INSPVA{}", names.empty() ? "" : "; it has " + names));
}

bool is_novatel(const FileHead& head) {
    bool found = false;
    (void)detail::scan_novatel(head.bytes, [&](const NovatelMessage&) {
        found = true;
        return false;
    });
    return found;
}

}  // namespace

extern const Format novatel_format;
const Format novatel_format = {
    .name = "novatel",
    .title = "NovAtel OEM",
    .extensions = ".gps .novatel .asc",
    .holds =
        "BESTGNSSPOS and BESTGNSSVEL, else BESTPOS and BESTVEL, else PSRPOS and PSRVEL as fixes; RAWIMUX, RAWIMUSX and, where the log tells the IMU, RAWIMU(S) as "
        "increments (of IMUs whose scale is known; CORRIMUDATA is without gravity and no IMU); INSPVA(S) and INSPVAX as reference; raw measurements (RANGE, RANGECMP) and "
        "ephemerides (GPSEPHEM, RAWEPHEM, GLOEPHEMERIS, GALEPHEMERIS, BDSEPHEMERIS, IONUTC); ASCII and binary, mixed; axes forward-right-down; of two antennas the first",
    .time = "GPS time",
    .recognise = is_novatel,
    .read = read_novatel};

}  // namespace schuler::io
