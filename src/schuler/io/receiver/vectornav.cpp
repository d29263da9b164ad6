#include "schuler/io/receiver/vectornav.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace schuler::io {
namespace {

using detail::load;
using Eigen::Vector3d;

constexpr char sync_byte = '\xfa';
constexpr std::size_t longest_message = 4096;  // bytes; a message of all fields with 64 satellites has 3900
constexpr std::size_t groups = 7;
enum Group : std::size_t { CommonGroup, TimeGroup, ImuGroup, GnssGroup, AttitudeGroup, InsGroup, Gnss2Group };

/// Bytes of each field, in the order of the bits. 0: none; beyond the first receiver's dilutions the size depends on the content.
constexpr std::array<std::array<std::uint8_t, 16>, groups> field_sizes{{{8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8},
                                                                        {8, 8, 8, 2, 8, 8, 8, 4, 4, 1},
                                                                        {2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2, 40},
                                                                        {8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28},
                                                                        {2, 12, 16, 36, 12, 12, 12, 12, 12, 12, 28, 24},
                                                                        {2, 24, 24, 12, 12, 12, 12, 12, 12, 4, 4, 68, 64},
                                                                        {8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28}}};
constexpr std::size_t satellites_field = 14, measurements_field = 15;  // of a receiver

constexpr std::size_t no_field = 0;

/// Size of a field, whose content follows; `no_field` for a bit without a field, vectornav_incomplete if its length is not there yet.
std::size_t field_size(std::size_t group, std::size_t field, std::string_view rest) {
    if (group == GnssGroup || group == Gnss2Group) {
        const auto count = [&](std::size_t at) { return static_cast<std::size_t>(static_cast<unsigned char>(rest[at])); };
        if (field == satellites_field) return rest.empty() ? vectornav_incomplete : 2 + 8 * count(0);
        if (field == measurements_field) return rest.size() < 11 ? vectornav_incomplete : 12 + 28 * count(10);
    }
    return field_sizes[group][field];
}

/// `visit(group, field, offset)` for each field. The offset behind the last one, or no_field or vectornav_incomplete.
template <class Visit>
std::size_t each_field(std::string_view bytes, Visit visit) {
    if (bytes.size() < 2) return vectornav_incomplete;
    const auto present = static_cast<unsigned char>(bytes[1]);
    if (present == 0 || present >= 0x80) return no_field;  // further groups follow in an extended header, which is not read
    std::size_t header = 2, at = 2;
    for (std::size_t g = 0; g < groups; ++g) at += (present >> g & 1U) * 2;
    if (bytes.size() < at) return vectornav_incomplete;
    bool any = false;
    for (std::size_t g = 0; g < groups; ++g) {
        if ((present >> g & 1U) == 0) continue;
        const auto fields = load<std::uint16_t>(bytes, header);
        header += 2;
        for (std::size_t f = 0; f < 16; ++f) {
            if ((fields >> f & 1U) == 0) continue;
            const std::size_t size = field_size(g, f, bytes.substr(std::min(at, bytes.size())));
            if (size == no_field || size == vectornav_incomplete) return size;
            visit(g, f, at);
            any = true;
            at += size;
            if (at > longest_message) return no_field;
        }
    }
    return any ? at : no_field;
}

/// CRC-16 of the polynomial 0x1021, initial value zero; zero over a message with its checksum.
std::uint16_t crc_of(std::string_view bytes) {
    std::uint16_t crc = 0;
    for (const char c : bytes) {
        crc = static_cast<std::uint16_t>(crc ^ static_cast<unsigned>(static_cast<unsigned char>(c)) << 8U);
        for (int bit = 0; bit < 8; ++bit)
            crc = static_cast<std::uint16_t>((crc & 0x8000U) != 0 ? crc << 1U ^ 0x1021U : crc << 1U);
    }
    return crc;
}

FixType fix_of_unit(unsigned code) {
    switch (code) {
        case 0:
        case 1: return FixType::None;  // none; time only
        case 2:
        case 3: return FixType::Autonomous;
        case 4: return FixType::Differential;  // SBAS
        case 7: return FixType::RtkFloat;
        case 8: return FixType::RtkFixed;
        default: return FixType::Unknown;
    }
}

/// The fields of one message that are used.
class Parser {
public:
    explicit Parser(std::string_view bytes) : bytes_(bytes) {}

    VectorNavMessage message() {
        (void)each_field(bytes_, [this](std::size_t group, std::size_t field, std::size_t at) { take(group, field, at); });
        finish();
        return std::move(out_);
    }

private:
    [[nodiscard]] double f(std::size_t at) const { return static_cast<double>(load<float>(bytes_, at)); }
    [[nodiscard]] Vector3d floats(std::size_t at) const { return {f(at), f(at + 4), f(at + 8)}; }
    [[nodiscard]] Geodetic place(std::size_t at) const {
        return {load<double>(bytes_, at) * units::deg, load<double>(bytes_, at + 8) * units::deg, load<double>(bytes_, at + 16)};
    }
    [[nodiscard]] std::int64_t integer(std::size_t at) const {
        const auto v = load<std::uint64_t>(bytes_, at);
        return v > static_cast<std::uint64_t>(INT64_MAX) ? 0 : static_cast<std::int64_t>(v);
    }

    void take(std::size_t group, std::size_t field, std::size_t at) {
        switch (group) {
            case CommonGroup: return common(field, at);
            case TimeGroup: return time(field, at);
            case ImuGroup: return imu(field, at);
            case GnssGroup: return gnss(field, at);
            case AttitudeGroup:
                if (field == 1) ypr_ = floats(at);
                return;
            case InsGroup: return ins(field, at);
            default: return;  // the second receiver
        }
    }

    void common(std::size_t field, std::size_t at) {
        switch (field) {
            case 0: out_.startup_ns = integer(at); break;
            case 1: gps_time(integer(at)); break;
            case 3: ypr_ = floats(at); break;
            case 5: rate_ = floats(at); break;
            case 6: place_ = place(at); break;
            case 7: velocity_ = floats(at); break;
            case 8: force_ = floats(at); break;
            case 9:
                raw_force_ = floats(at);
                raw_rate_ = floats(at + 12);
                break;
            case 10:
                out_.field = 1e-4 * floats(at);  // gauss
                out_.pressure = 1000.0 * f(at + 16);
                break;
            case 11:
                interval_ = f(at);
                turned_ = units::deg * floats(at + 4);
                gained_ = floats(at + 16);
                break;
            case 12: status_ = load<std::uint16_t>(bytes_, at); break;
            default: break;
        }
    }
    void time(std::size_t field, std::size_t at) {
        switch (field) {
            case 0: out_.startup_ns = integer(at); break;
            case 1: gps_time(integer(at)); break;
            case 2: tow_ = integer(at); break;
            case 3: week_ = load<std::uint16_t>(bytes_, at); break;
            case 9: time_status_ = static_cast<unsigned char>(bytes_[at]); break;
            default: break;
        }
    }
    void imu(std::size_t field, std::size_t at) {
        switch (field) {
            case 1:
                if (!out_.field.allFinite()) out_.field = 1e-4 * floats(at);
                break;
            case 2: raw_force_ = floats(at); break;
            case 3: raw_rate_ = floats(at); break;
            case 5: out_.pressure = 1000.0 * f(at); break;
            case 6:
                interval_ = f(at);
                turned_ = units::deg * floats(at + 4);
                break;
            case 7: gained_ = floats(at); break;
            case 8: out_.field = 1e-4 * floats(at); break;
            case 9: force_ = floats(at); break;
            case 10: rate_ = floats(at); break;
            default: break;
        }
    }
    void gnss(std::size_t field, std::size_t at) {
        switch (field) {
            case 1: fix_tow_ = integer(at); break;
            case 2: fix_week_ = load<std::uint16_t>(bytes_, at); break;
            case 3: fix_.satellites = static_cast<unsigned char>(bytes_[at]); break;
            case 4: fix_.fix = fix_of_unit(static_cast<unsigned char>(bytes_[at])); break;
            case 5:
                fix_.position = place(at);
                has_fix_ = true;
                break;
            case 7: fix_.velocity_n = floats(at); break;
            case 9: fix_.std_position = floats(at); break;
            case 10: fix_.std_velocity.setConstant(f(at)); break;
            default: break;
        }
    }
    void ins(std::size_t field, std::size_t at) {
        switch (field) {
            case 0: status_ = load<std::uint16_t>(bytes_, at); break;
            case 1: place_ = place(at); break;
            case 4: velocity_ = floats(at); break;
            default: break;
        }
    }

    void gps_time(std::int64_t ns) {
        constexpr std::int64_t year_2000 = 630'720'000'000'000'000;  // before the receiver has a time, the unit counts from zero
        out_.awaits_gps = ns < year_2000;
        if (ns >= year_2000) out_.gps_ns = ns;
    }
    [[nodiscard]] static std::int64_t week_time(int week, std::int64_t tow) {
        constexpr std::int64_t seconds_a_week = 604'800, ns = 1'000'000'000;
        return week <= 0 || tow < 0 || tow > seconds_a_week * ns ? 0 : week * seconds_a_week * ns + tow;
    }

    void finish() {
        if (!out_.gps_ns && tow_ >= 0) {
            const std::int64_t ns = week_time(week_, tow_);
            out_.awaits_gps = ns == 0;
            if (ns != 0) out_.gps_ns = ns;
        }
        constexpr unsigned time_ok = 1, date_ok = 2;
        if (time_status_ >= 0 && (static_cast<unsigned>(time_status_) & (time_ok | date_ok)) != (time_ok | date_ok) &&
            out_.gps_ns) {
            out_.gps_ns.reset();
            out_.awaits_gps = true;
        }
        const auto inertial = [this](VectorNavMessage::Inertial kind, const Vector3d& rate, const Vector3d& force) {
            if (out_.inertial != VectorNavMessage::Inertial::None || !rate.allFinite() || !force.allFinite()) return;
            out_.inertial = kind;
            out_.rate = rate;
            out_.force = force;
        };
        inertial(VectorNavMessage::Inertial::Uncompensated, raw_rate_, raw_force_);
        inertial(VectorNavMessage::Inertial::Compensated, rate_, force_);
        if (interval_ > 0.0) inertial(VectorNavMessage::Inertial::Increments, turned_ / interval_, gained_ / interval_);
        if (has_fix_) {
            if (fix_.position.lat == 0.0 && fix_.position.lon == 0.0) fix_.fix = FixType::None;
            fix_.time = Time{week_time(fix_week_, fix_tow_)};
            out_.fix = fix_;
        }
        constexpr unsigned mode = 3, tracking = 2;
        const bool tracks = status_ < 0 || (static_cast<unsigned>(status_) & mode) >= tracking;
        if (tracks && ypr_.allFinite() && velocity_.allFinite() && std::isfinite(place_.lat) &&
            !(place_.lat == 0.0 && place_.lon == 0.0)) {
            NavState s;
            s.position = place_;
            s.v_eb_n = velocity_;
            s.q_nb = Eigen::Quaterniond(math::dcm_from_rpy(units::deg * Vector3d(ypr_.z(), ypr_.y(), ypr_.x())));
            out_.solution = s;
        }
    }

    std::string_view bytes_;
    VectorNavMessage out_;
    Vector3d rate_ = not_given3(), force_ = not_given3(), raw_rate_ = not_given3(), raw_force_ = not_given3();
    double interval_ = 0.0;  // s
    Vector3d turned_ = not_given3(), gained_ = not_given3();
    Vector3d ypr_ = not_given3(), velocity_ = not_given3();  // deg; m/s
    Geodetic place_{not_given, not_given, not_given};
    GnssFix fix_{.time = {}, .position = {not_given, not_given, not_given}};
    bool has_fix_ = false;
    std::int64_t tow_ = -1, fix_tow_ = -1;
    int week_ = 0, fix_week_ = 0, status_ = -1, time_status_ = -1;
};

/// Passes every message with a right checksum to `take(bytes)` until that returns false; the number of damaged ones.
template <class Take>
std::pair<std::size_t, std::size_t> scan(std::string_view bytes, Take take) {
    std::size_t damaged = 0, first = 0, end = 0;  // end of the last message
    for (std::size_t at = bytes.find(sync_byte); at != std::string_view::npos; at = bytes.find(sync_byte, at)) {
        const std::size_t size = vectornav_size(bytes.substr(at));
        if (size == 0 || size == vectornav_incomplete) {
            // only where a message is due; elsewhere the byte belongs to the damaged one, or to other content
            if (at == end && end > 0 && size == 0 && damaged++ == 0) first = at;
            ++at;
            continue;
        }
        if (!take(bytes.substr(at, size))) break;
        at += size;
        end = at;
    }
    return {damaged, first};
}

/// Time axis: GPS time if the unit ever had it, with the messages before by their time since power-on; else that alone. Without any time
/// of the unit's own the fixes have that of the receiver.
class MessageTimes {
public:
    explicit MessageTimes(const std::vector<VectorNavMessage>& messages) {
        for (const VectorNavMessage& m : messages) {
            gps_ = gps_ || m.gps_ns;
            power_on_ = power_on_ || m.startup_ns;
            if (m.gps_ns && m.startup_ns && !offset_) offset_ = *m.gps_ns - *m.startup_ns;
        }
    }
    [[nodiscard]] bool gps() const { return gps_ || !power_on_; }
    [[nodiscard]] std::optional<std::int64_t> time_of(const VectorNavMessage& m) const {
        if (!gps()) return m.startup_ns;
        if (m.gps_ns) return m.gps_ns;
        if (m.startup_ns && offset_) return *m.startup_ns + *offset_;
        return std::nullopt;
    }

private:
    bool gps_ = false, power_on_ = false;
    std::optional<std::int64_t> offset_;
};

StreamLog read_vectornav(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    std::vector<VectorNavMessage> messages;
    const auto [damaged, first_damaged] = scan(bytes, [&](std::string_view m) {
        messages.push_back(parse_vectornav(m));
        return true;
    });
    const MessageTimes axis(messages);
    auto source = VectorNavMessage::Inertial::None;
    for (const VectorNavMessage& m : messages) source = std::min(source, m.inertial);
    static constexpr std::array sources{"ImuGroup, uncompensated", "Accel, AngularRate", "DeltaTheta, DeltaVel", ""};
    Stream imu("imu", TableKind::Imu, sources[static_cast<std::size_t>(source)],
               {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
    Stream mag("mag", TableKind::Mag, "Mag", {"mag_x_ut", "mag_y_ut", "mag_z_ut"});
    Stream baro("baro", TableKind::Baro, "Pres", {"pressure_pa"});
    Stream solution(
        "reference", TableKind::Reference, "INS",
        {"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg"});
    std::vector<GnssFix> fixes;
    std::optional<GnssFix> last;
    std::size_t undated = 0;
    for (const VectorNavMessage& m : messages) {
        const std::optional<std::int64_t> ns = axis.time_of(m);
        if (m.fix) {
            GnssFix fix = *m.fix;
            const bool same = last && repeats(fix, *last);
            last = fix;
            if (!axis.gps() || fix.time.ns == 0) fix.time = Time{ns.value_or(0)};
            if (!same && fix.time.ns != 0 && (fixes.empty() || fix.time > fixes.back().time)) fixes.push_back(fix);
        }
        if (!ns) {
            undated += m.inertial != VectorNavMessage::Inertial::None ? 1 : 0;
            continue;
        }
        const auto add = [](Stream& s, std::int64_t at, const Vector3d& v, double scale) {
            s.add(at, {scale * v.x(), scale * v.y(), scale * v.z()});
        };
        if (source != VectorNavMessage::Inertial::None && m.inertial == source)
            imu.add(*ns, {m.rate.x(), m.rate.y(), m.rate.z(), m.force.x(), m.force.y(), m.force.z()});
        if (m.field.allFinite()) add(mag, *ns, m.field, 1e6);
        if (std::isfinite(m.pressure)) baro.add(*ns, {m.pressure});
        if (m.solution) {
            const NavState& s = *m.solution;
            const Vector3d rpy = math::rpy_from_quaternion(s.q_nb);
            solution.add(*ns, {s.position.lat / units::deg, s.position.lon / units::deg, s.position.h, s.v_eb_n.x(), s.v_eb_n.y(),
                               s.v_eb_n.z(), rpy.x() / units::deg, rpy.y() / units::deg, rpy.z() / units::deg});
        }
    }
    StreamLog log;
    log.clock = axis.gps() ? Clock::Gps : Clock::Boot;
    log.add(std::move(imu));
    if (!fixes.empty()) {
        Stream gnss = stream_of(fixes, HeightKind::Ellipsoidal, "GpsGroup");
        gnss.by_arrival = !axis.gps();
        log.add(std::move(gnss));
    }
    log.add(std::move(mag));
    log.add(std::move(baro));
    log.add(std::move(solution));
    if (damaged > 0)
        warnings.add(input.name() + " vectornav.damaged",
                     fmt::format("{}: damaged messages, the first at byte {}: skipped", input.name(), first_damaged), damaged);
    if (undated > 0)
        warnings.add(input.name() + " vectornav.undated",
                     fmt::format("{}: inertial messages without a time (output TimeGps or TimeStartup): not used", input.name()),
                     undated);
    if (log.streams.empty())
        throw input_error("holds no inertial data and no position with a time", place_in(input.name()),
                          "output TimeGps or TimeStartup with UncompAccel and UncompGyro, and the GpsGroup");
    return log;
}

bool is_vectornav(const FileHead& head) {
    int found = 0;
    (void)scan(head.bytes, [&](std::string_view) { return ++found < 2; });
    return found >= 2;
}

}  // namespace

std::size_t vectornav_size(std::string_view bytes) {
    if (bytes.empty() || bytes[0] != sync_byte) return 0;
    const std::size_t payload = each_field(bytes, [](std::size_t, std::size_t, std::size_t) {});
    if (payload == no_field || payload == vectornav_incomplete) return payload;
    const std::size_t size = payload + 2;
    if (bytes.size() < size) return vectornav_incomplete;
    return crc_of(bytes.substr(1, size - 1)) == 0 ? size : 0;
}

VectorNavMessage parse_vectornav(std::string_view message) { return Parser(message).message(); }

bool repeats(const GnssFix& fix, const GnssFix& previous) {
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    bool all = fix.time == previous.time && same(fix.position.lat, previous.position.lat) &&
               same(fix.position.lon, previous.position.lon) && same(fix.position.h, previous.position.h);
    for (Eigen::Index i = 0; i < 3; ++i) all = all && same(fix.velocity_n[i], previous.velocity_n[i]);
    return all;
}

extern const Format vectornav_format;
const Format vectornav_format = {
    .name = "vectornav",
    .title = "VectorNav binary",
    .extensions = ".vn .vnb",
    .holds =
        "UncompAccel and UncompGyro, else Accel and AngularRate, else DeltaTheta and DeltaVel as inertial data; the first receiver's PosLla, VelNed and their "
        "uncertainties as fixes; magnetic field, pressure; YawPitchRoll with position and velocity of the unit's own filter as reference; other fields are skipped, "
        "ASCII messages between them ignored; axes forward-right-down unless the unit has another reference frame",
    .time = "GPS time from TimeGps (and GpsTow of the fixes), else TimeStartup",
    .recognise = is_vectornav,
    .read = read_vectornav};

}  // namespace schuler::io
