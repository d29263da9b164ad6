#include "schuler/io/container/ros_messages.h"

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/io/container/detail/ros_imu.h"
#include "schuler/io/container/detail/ros_velocities.h"
#include "schuler/io/detail/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace schuler::io {
namespace {

struct Short : std::runtime_error {
    Short() : std::runtime_error("message too short") {}
};

/// Reads consecutive numbers and texts.
class Reader {
public:
    Reader(std::string_view bytes, RosLayout layout) : bytes_(bytes), cdr_(layout == RosLayout::Cdr) {
        if (!cdr_) return;
        if (bytes.size() < 4) throw Short();
        swapped_ = bytes[1] == 0;  // big-endian
        start_ = at_ = 4;
    }
    template <class T>
    T number() {
        if (cdr_) at_ = start_ + (at_ - start_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        if (at_ > bytes_.size() || bytes_.size() - at_ < sizeof(T)) throw Short();
        char raw[sizeof(T)];
        std::memcpy(raw, bytes_.data() + at_, sizeof(T));
        if (swapped_) std::reverse(raw, raw + sizeof(T));
        at_ += sizeof(T);
        return detail::load<T>(raw);
    }
    std::string_view text() {
        const std::size_t size = number<std::uint32_t>();
        if (size > bytes_.size() - at_) throw Short();
        const std::string_view value = bytes_.substr(at_, size);
        at_ += size;
        return value;
    }
    /// Time of a header, ns since 1970.
    std::int64_t header() {
        if (!cdr_) (void)number<std::uint32_t>();  // ROS 1 headers start with a counter
        const auto seconds = number<std::uint32_t>(), ns = number<std::uint32_t>();
        frame_ = text();
        return std::int64_t{seconds} * 1'000'000'000 + ns;
    }
    /// True if the frame of the header is by its name that of east, north and up.
    [[nodiscard]] bool is_in_enu() const { return frame_.substr(0, frame_.find('\0')) == "enu"; }
    /// Skips a list of 32-bit numbers.
    void pass_list() {
        for (auto left = number<std::uint32_t>(); left > 0; --left) (void)number<std::int32_t>();
    }
    template <std::size_t N>
    std::array<double, N> doubles() {
        std::array<double, N> values;
        for (double& v : values) v = number<double>();
        return values;
    }

private:
    std::string_view bytes_, frame_;
    std::size_t at_ = 0, start_ = 0;
    bool cdr_, swapped_ = false;
};

enum class Type {
    None,
    Imu,
    Fix,
    Field,
    Pressure,
    Odometry,
    Pose,
    PoseWithCovariance,
    Transform,
    Quaternion,
    Twist,
    TwistWithCovariance,
    GpsFix
};

Type type_of(std::string_view name) {
    const std::size_t slash = name.find('/'), last = name.rfind('/');
    if (slash == std::string_view::npos) return Type::None;
    const std::string_view package = name.substr(0, slash), message = name.substr(last + 1);
    if (package == "sensor_msgs")
        return message == "Imu"             ? Type::Imu
               : message == "NavSatFix"     ? Type::Fix
               : message == "MagneticField" ? Type::Field
               : message == "FluidPressure" ? Type::Pressure
                                            : Type::None;
    if (package == "nav_msgs") return message == "Odometry" ? Type::Odometry : Type::None;
    if (package == "geometry_msgs")
        return message == "PoseStamped"                  ? Type::Pose
               : message == "PoseWithCovarianceStamped"  ? Type::PoseWithCovariance
               : message == "TransformStamped"           ? Type::Transform
               : message == "QuaternionStamped"          ? Type::Quaternion
               : message == "TwistStamped"               ? Type::Twist
               : message == "TwistWithCovarianceStamped" ? Type::TwistWithCovariance
                                                         : Type::None;
    if (package == "gps_common" || package == "gps_msgs") return message == "GPSFix" ? Type::GpsFix : Type::None;
    return Type::None;
}

Stream stream_for(Type type, const std::string& topic) {
    switch (type) {
        case Type::Imu:
            return {"imu",
                    TableKind::Imu,
                    topic,
                    {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"}};
        case Type::Fix:
            return {
                "gnss", TableKind::Gnss, topic, {"lat_deg", "lon_deg", "height_ellipsoidal_m", "std_n_m", "std_e_m", "std_d_m"}};
        case Type::GpsFix:
            return {"gnss",
                    TableKind::Gnss,
                    topic,
                    {"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_n_m", "std_e_m", "std_d_m",
                     "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "satellites"}};
        case Type::Field: return {"mag", TableKind::Mag, topic, {"mag_x_ut", "mag_y_ut", "mag_z_ut"}};
        case Type::Pressure: return {"baro", TableKind::Baro, topic, {"pressure_pa"}};
        case Type::Quaternion:
            return {std::string(detail::ros_attitude),
                    TableKind::Reference,
                    topic,
                    {"quat_sensor_to_enu_w", "quat_sensor_to_enu_x", "quat_sensor_to_enu_y", "quat_sensor_to_enu_z"}};
        case Type::Twist:
        case Type::TwistWithCovariance:
            return {std::string(detail::ros_twist),
                    TableKind::Gnss,
                    topic,
                    {"vel_e_m_s", "vel_n_m_s", "vel_u_m_s", "std_ve_m_s", "std_vn_m_s", "std_vd_m_s"}};
        default: {
            Stream s("trajectory", TableKind::Reference, topic,
                     {"local_x_m", "local_y_m", "local_z_m", "quat_sensor_to_enu_w", "quat_sensor_to_enu_x",
                      "quat_sensor_to_enu_y", "quat_sensor_to_enu_z"});
            s.own_frame = true;
            return s;
        }
    }
}

/// A covariance with first element -1 indicates a missing measurement [RosImu].
template <std::size_t N>
bool is_measured(const std::array<double, N>& covariance) {
    return covariance[0] != -1.0;
}

/// A row of gps_msgs/GPSFix, also called gps_common/GPSFix [RosGpsFix]: position and velocity in one.
void add_gps_fix(Stream& s, Reader& r, std::int64_t t) {
    constexpr double circle95 = 2.448, line95 = 1.960;  // in sigmas: radius and half width with 95 % probability
    (void)r.header();                                   // of the status
    const double satellites = r.number<std::uint16_t>();
    r.pass_list();
    (void)r.number<std::uint16_t>();
    for (int i = 0; i < 4; ++i) r.pass_list();
    const int status = r.number<std::int16_t>();
    for (int i = 0; i < 3; ++i) (void)r.number<std::uint16_t>();  // sources
    const auto p = r.doubles<3>();
    const auto v = r.doubles<3>();          // direction, deg from north; speed; upward
    (void)r.doubles<4 + 5>();               // orientation, time, dilutions
    const auto within95 = r.doubles<10>();  // all, horizontal, vertical, direction, speed, upward, ...
    const auto c = r.doubles<9>();          // east, north, up
    const bool known = r.number<std::uint8_t>() != 0 && c[0] > 0.0;
    const auto positive = [](double x) { return x > 0.0 ? x : not_given; };
    const auto sigma = [&](double variance, std::size_t i, double share) {
        return known && variance > 0.0 ? std::sqrt(variance) : positive(within95[i] / share);
    };
    const double north = v[1] * std::cos(v[0] * units::deg), east = v[1] * std::sin(v[0] * units::deg);
    const double speed = positive(within95[4] / line95);
    s.add(t, {p[0], p[1], p[2], north, east, -v[2], sigma(c[4], 1, circle95), sigma(c[0], 1, circle95), sigma(c[8], 2, line95),
              speed, speed, positive(within95[5] / line95), satellites > 0.0 ? satellites : not_given});
    s.fix.push_back(status < 0     ? FixType::None
                    : status == 0  ? FixType::Autonomous
                    : status == 19 ? FixType::RtkFixed
                    : status == 20 ? FixType::RtkFloat
                                   : FixType::Differential);
}

/// False if the message contains no measurement, or only a part of them: of an Imu the others are NaN.
bool add_row(Stream& s, Type type, Reader& r, std::int64_t logged) {
    const std::int64_t stamp = r.header();
    const std::int64_t t = stamp > 0 ? stamp : logged;
    if (type == Type::Imu) {
        (void)r.doubles<4 + 9>();  // orientation, its covariance
        const auto w = r.doubles<3>();
        const bool rates = is_measured(r.doubles<9>());
        const auto f = r.doubles<3>();
        const bool forces = is_measured(r.doubles<9>());
        if (!rates && !forces) return false;
        const double w1 = rates ? 1.0 : not_given, f1 = forces ? 1.0 : not_given;
        s.add(t, {w1 * w[0], w1 * w[1], w1 * w[2], f1 * f[0], f1 * f[1], f1 * f[2]});
        return rates && forces;
    } else if (type == Type::Fix) {
        const int status = r.number<std::int8_t>();
        (void)r.number<std::uint16_t>();
        const auto p = r.doubles<3>();
        const auto c = r.doubles<9>();
        const bool known = r.number<std::uint8_t>() != 0 && c[0] > 0.0;
        const auto sigma = [&](double variance) { return known && variance > 0.0 ? std::sqrt(variance) : not_given; };
        s.add(t, {p[0], p[1], p[2], sigma(c[4]), sigma(c[0]), sigma(c[8])});  // the covariance is in east, north, up
        s.fix.push_back(status < 0    ? FixType::None
                        : status == 0 ? FixType::Autonomous
                        : status == 1 ? FixType::Differential
                                      : FixType::RtkFixed);
    } else if (type == Type::Field) {
        const auto m = r.doubles<3>();  // tesla
        s.add(t, {1e6 * m[0], 1e6 * m[1], 1e6 * m[2]});
    } else if (type == Type::Pressure) {
        s.add(t, {r.number<double>()});
    } else if (type == Type::GpsFix) {
        add_gps_fix(s, r, t);
    } else if (type == Type::Quaternion) {
        const auto q = r.doubles<4>();  // x, y, z, w
        s.add(t, {q[3], q[0], q[1], q[2]});
    } else if (type == Type::Twist || type == Type::TwistWithCovariance) {
        const auto v = r.doubles<3>();
        (void)r.doubles<3>();  // angular
        std::array<double, 3> sigma{not_given, not_given, not_given};
        if (type == Type::TwistWithCovariance) {
            const auto c = r.doubles<36>();
            if (!is_measured(c)) return false;
            for (std::size_t i = 0; i < 3; ++i)
                if (c[7 * i] > 0.0) sigma[i] = std::sqrt(c[7 * i]);
        }
        if (r.is_in_enu()) s.name = detail::ros_twist_enu;
        s.add(t, {v[0], v[1], v[2], sigma[0], sigma[1], sigma[2]});
    } else {
        if (type == Type::Odometry || type == Type::Transform) (void)r.text();
        const auto p = r.doubles<3>();
        const auto q = r.doubles<4>();  // x, y, z, w
        s.add(t, {p[0], p[1], p[2], q[3], q[0], q[1], q[2]});
    }
    return true;
}

}  // namespace

bool RosMessages::is_read(std::string_view type) { return type_of(type) != Type::None; }

void RosMessages::add(const std::string& topic, const std::string& type_name, RosLayout layout, std::string_view message,
                      std::int64_t logged) {
    const Type type = type_of(type_name);
    if (type == Type::None) return;
    auto it = streams_.find(topic);
    if (it == streams_.end()) it = streams_.emplace(topic, stream_for(type, topic)).first;
    try {
        Reader reader(message, layout);
        if (!add_row(it->second, type, reader, logged)) ++not_measured_[topic];
    } catch (const Short&) {
        ++damaged;
    }
}

void RosMessages::finish(StreamLog& log, const std::string& file, WarningLog& warnings) {
    log.clock = Clock::Unix;
    detail::complete_imus(streams_, file, warnings);
    for (const auto& [topic, count] : not_measured_) {
        const auto rest = streams_.find(topic);
        if (rest == streams_.end() || rest->second.source != topic) continue;  // a half of a unit, joined or told
        warnings.add(file + " ros.not_measured " + topic,
                     fmt::format("{}: {}: messages whose covariance of -1 marks a part as not measured: skipped", file, topic),
                     count);
    }
    for (auto& [topic, stream] : streams_) {
        if (detail::is_of_a_fix(stream)) continue;
        std::optional<Stream> solution;
        if (stream.kind == TableKind::Gnss && stream.rows() > 0) {
            if (stream.find("vel_n_m_s") == nullptr) detail::join_velocities(stream, streams_, file, warnings);
            detail::leave_out_zero_velocities(stream);
            solution = detail::with_attitude(stream, streams_);
        }
        log.add(std::move(stream));
        if (solution) log.add(std::move(*solution));
    }
    // a simulation, or a log without a set clock, counts from its start
    constexpr std::int64_t year_2000 = 946'684'800'000'000'000;
    if (!log.streams.empty() && log.streams.front().time_ns.front() < year_2000) log.clock = Clock::Boot;
}

std::string RosMessages::topics() const {
    std::string text;
    for (const std::string& topic : mentioned_) text += (text.empty() ? "" : ", ") + topic;
    return text;
}

}  // namespace schuler::io
