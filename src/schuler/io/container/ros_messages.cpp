#include "schuler/io/container/ros_messages.h"

#include "schuler/core/samples.h"
#include "schuler/io/detail/little_endian.h"

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

/// Reads numbers and texts one behind the other.
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
    /// Time of a header, ns since 1970; its frame is passed over.
    std::int64_t header() {
        if (!cdr_) (void)number<std::uint32_t>();  // ROS 1 has a counter first
        const auto seconds = number<std::uint32_t>(), ns = number<std::uint32_t>();
        (void)text();
        return std::int64_t{seconds} * 1'000'000'000 + ns;
    }
    template <std::size_t N>
    std::array<double, N> doubles() {
        std::array<double, N> values;
        for (double& v : values) v = number<double>();
        return values;
    }

private:
    std::string_view bytes_;
    std::size_t at_ = 0, start_ = 0;
    bool cdr_, swapped_ = false;
};

enum class Type { None, Imu, Fix, Field, Pressure, Odometry, Pose, PoseWithCovariance, Transform };

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
        return message == "PoseStamped"                 ? Type::Pose
               : message == "PoseWithCovarianceStamped" ? Type::PoseWithCovariance
               : message == "TransformStamped"          ? Type::Transform
                                                        : Type::None;
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
        case Type::Field: return {"mag", TableKind::Mag, topic, {"mag_x_ut", "mag_y_ut", "mag_z_ut"}};
        case Type::Pressure: return {"baro", TableKind::Baro, topic, {"pressure_pa"}};
        default: {
            Stream s("trajectory", TableKind::Reference, topic,
                     {"local_x_m", "local_y_m", "local_z_m", "quat_sensor_to_enu_w", "quat_sensor_to_enu_x",
                      "quat_sensor_to_enu_y", "quat_sensor_to_enu_z"});
            s.own_frame = true;
            return s;
        }
    }
}

void add_row(Stream& s, Type type, Reader& r, std::int64_t logged) {
    const std::int64_t stamp = r.header();
    const std::int64_t t = stamp > 0 ? stamp : logged;
    if (type == Type::Imu) {
        (void)r.doubles<4 + 9>();  // orientation, its covariance
        const auto w = r.doubles<3>();
        (void)r.doubles<9>();
        const auto f = r.doubles<3>();
        s.add(t, {w[0], w[1], w[2], f[0], f[1], f[2]});
    } else if (type == Type::Fix) {
        const int status = r.number<std::int8_t>();
        (void)r.number<std::uint16_t>();
        const auto p = r.doubles<3>();
        const auto c = r.doubles<9>();
        const bool known = r.number<std::uint8_t>() != 0 && c[0] > 0.0;
        const auto sigma = [&](double variance) { return known && variance > 0.0 ? std::sqrt(variance) : not_given; };
        s.add(t, {p[0], p[1], p[2], sigma(c[4]), sigma(c[0]), sigma(c[8])});  // the covariance is of east, north, up
        s.fix.push_back(status < 0    ? FixType::None
                        : status == 0 ? FixType::Autonomous
                        : status == 1 ? FixType::Differential
                                      : FixType::RtkFixed);
    } else if (type == Type::Field) {
        const auto m = r.doubles<3>();  // tesla
        s.add(t, {1e6 * m[0], 1e6 * m[1], 1e6 * m[2]});
    } else if (type == Type::Pressure) {
        s.add(t, {r.number<double>()});
    } else {
        if (type == Type::Odometry || type == Type::Transform) (void)r.text();
        const auto p = r.doubles<3>();
        const auto q = r.doubles<4>();  // x, y, z, w
        s.add(t, {p[0], p[1], p[2], q[3], q[0], q[1], q[2]});
    }
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
        add_row(it->second, type, reader, logged);
    } catch (const Short&) {
        ++damaged;
    }
}

void RosMessages::finish(StreamLog& log) {
    log.clock = Clock::Unix;
    for (auto& [topic, stream] : streams_) log.add(std::move(stream));
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
