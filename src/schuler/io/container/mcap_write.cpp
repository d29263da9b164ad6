#include "schuler/io/container/mcap_write.h"

#include "schuler/core/units.h"
#include "schuler/io/container/detail/mcap_records.h"
#include "schuler/io/detail/dated.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/math/rotation.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace schuler::io {
namespace {

using detail::McapOp;

/// Bytes of a ROS 2 message: numbers aligned to their size.
class Cdr {
public:
    Cdr() : out_("\0\1\0\0", 4) {}
    template <class T>
    Cdr& put(T value) {
        while ((out_.size() - 4) % sizeof(T) != 0) out_.push_back('\0');
        detail::store(out_, value);
        return *this;
    }
    Cdr& text(std::string_view value) {
        put(static_cast<std::uint32_t>(value.size() + 1));
        out_.append(value).push_back('\0');
        return *this;
    }
    Cdr& header(std::int64_t ns, std::string_view frame) {
        return put(static_cast<std::int32_t>(ns / 1'000'000'000)).put(static_cast<std::uint32_t>(ns % 1'000'000'000)).text(frame);
    }
    [[nodiscard]] const std::string& bytes() const { return out_; }

private:
    std::string out_;
};

constexpr std::string_view header_definition =
    "\n================================================================================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
constexpr std::string_view fix_definition =
    "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\nfloat64[9] position_covariance\n"
    "uint8 position_covariance_type\n================================================================================\nMSG: sensor_msgs/NavSatStatus\n"
    "int8 status\nuint16 service\n";

void record(std::string& out, McapOp op, const std::string& body) {
    out.push_back(static_cast<char>(op));
    detail::store(out, static_cast<std::uint64_t>(body.size()));
    out += body;
}
void put_text(std::string& out, std::string_view value) {
    detail::store(out, static_cast<std::uint32_t>(value.size()));
    out += value;
}

void define(std::string& out, std::uint16_t id, std::string_view topic, std::string_view type, const std::string& definition) {
    std::string schema, channel;
    detail::store(schema, id);
    put_text(schema, type);
    put_text(schema, "ros2msg");
    put_text(schema, definition);
    record(out, McapOp::Schema, schema);
    detail::store(channel, id);
    detail::store(channel, id);
    put_text(channel, topic);
    put_text(channel, "cdr");
    detail::store(channel, std::uint32_t{0});
    record(out, McapOp::Channel, channel);
}

void message(std::string& out, std::uint16_t channel, std::uint32_t number, std::int64_t ns, const std::string& data) {
    std::string body;
    detail::store(body, channel);
    detail::store(body, number);
    detail::store(body, static_cast<std::uint64_t>(ns));
    detail::store(body, static_cast<std::uint64_t>(ns));
    body += data;
    record(out, McapOp::Message, body);
}

/// A channel of JSON objects without a schema.
void define_json(std::string& out, std::uint16_t id, std::string_view topic) {
    std::string channel;
    detail::store(channel, id);
    detail::store(channel, std::uint16_t{0});
    put_text(channel, topic);
    put_text(channel, "json");
    detail::store(channel, std::uint32_t{0});
    record(out, McapOp::Channel, channel);
}

}  // namespace

std::string mcap_begin() {
    std::string out(detail::mcap_magic), header;
    put_text(header, "ros2");
    put_text(header, "schuler");
    record(out, McapOp::Header, header);
    define(out, 1, "/fix", "sensor_msgs/msg/NavSatFix", std::string(fix_definition) + std::string(header_definition));
    define(
        out, 2, "/attitude", "geometry_msgs/msg/QuaternionStamped",
        "std_msgs/Header header\ngeometry_msgs/Quaternion quaternion\n================================================================================\n"
        "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" +
            std::string(header_definition));
    define(
        out, 3, "/velocity", "geometry_msgs/msg/TwistWithCovarianceStamped",
        "std_msgs/Header header\ngeometry_msgs/TwistWithCovariance twist\n================================================================================\n"
        "MSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n"
        "================================================================================\nMSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\n"
        "geometry_msgs/Vector3 angular\n================================================================================\nMSG: geometry_msgs/Vector3\n"
        "float64 x\nfloat64 y\nfloat64 z\n" +
            std::string(header_definition));
    return out;
}

std::string mcap_json_channels() {
    std::string out;
    define_json(out, static_cast<std::uint16_t>(McapTopic::Event), "/event");
    define_json(out, static_cast<std::uint16_t>(McapTopic::Health), "/health");
    define_json(out, static_cast<std::uint16_t>(McapTopic::Satellites), "/satellites");
    return out;
}

bool append_mcap(std::string& out, const SolutionRow& r, std::uint32_t number) {
    // dated times are converted to UTC from 1970, as in ROS
    const std::int64_t ns = detail::ns_since_1970(r.time);
    if (ns < 0) return false;
    Cdr fix;
    fix.header(ns, "wgs84").put(std::int8_t{0}).put(std::uint16_t{1});
    fix.put(r.position.lat / units::deg).put(r.position.lon / units::deg).put(r.position.h);
    const auto& s = r.std_position;
    for (int i = 0; i < 9; ++i) fix.put(i == 0 ? s.y() * s.y() : i == 4 ? s.x() * s.x() : i == 8 ? s.z() * s.z() : 0.0);
    fix.put(static_cast<std::uint8_t>(s.allFinite() ? 2 : 0));
    message(out, 1, number, ns, fix.bytes());
    if (r.rpy.allFinite()) {
        Eigen::Matrix3d ned_to_enu;
        ned_to_enu << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
        const Eigen::Quaterniond q(ned_to_enu * math::dcm_from_rpy(r.rpy));
        Cdr attitude;
        attitude.header(ns, "enu").put(q.x()).put(q.y()).put(q.z()).put(q.w());
        message(out, 2, number, ns, attitude.bytes());
    }
    if (r.v_eb_n.allFinite()) {
        const Eigen::Vector3d &v = r.v_eb_n, &std_v = r.std_velocity;
        const std::array<double, 3> variance{std_v.y() * std_v.y(), std_v.x() * std_v.x(), std_v.z() * std_v.z()};
        Cdr velocity;
        velocity.header(ns, "enu").put(v.y()).put(v.x()).put(-v.z()).put(0.0).put(0.0).put(0.0);
        for (std::size_t i = 0; i < 36; ++i)
            velocity.put(i % 7 == 0 && i < 21 && std::isfinite(variance[i / 7]) ? variance[i / 7] : 0.0);
        message(out, 3, number, ns, velocity.bytes());
    }
    return true;
}

bool append_mcap(std::string& out, McapTopic topic, Time time, std::string_view json, std::uint32_t number) {
    const std::int64_t ns = detail::ns_since_1970(time);
    if (ns < 0) return false;
    message(out, static_cast<std::uint16_t>(topic), number, ns, std::string(json));
    return true;
}

std::string mcap_end() {
    std::string out, end, footer;
    detail::store(end, std::uint32_t{0});
    record(out, McapOp::DataEnd, end);
    detail::store(footer, std::uint64_t{0});
    detail::store(footer, std::uint64_t{0});
    detail::store(footer, std::uint32_t{0});
    record(out, McapOp::Footer, footer);
    return out.append(detail::mcap_magic);
}

}  // namespace schuler::io
