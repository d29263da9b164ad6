// Messages of ROS 1 and ROS 2 as instruments, from any container.
#pragma once

#include "schuler/core/log.h"
#include "schuler/io/streams.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace schuler::io {

/// Memory layout of a message.
enum class RosLayout { Packed, Cdr };  ///< ROS 1; ROS 2, each number aligned to its size, after four bytes

/// Collects messages of topics into streams: sensor_msgs Imu, NavSatFix, MagneticField and FluidPressure, nav_msgs Odometry,
/// geometry_msgs PoseStamped, PoseWithCovarianceStamped and TransformStamped; TwistStamped and TwistWithCovarianceStamped as the velocities of the
/// fixes that have the same stamps; gps_msgs (or gps_common) GPSFix. Times are those of the headers.
class RosMessages {
public:
    /// True if messages of a type are read ("sensor_msgs/Imu", "sensor_msgs/msg/Imu").
    [[nodiscard]] static bool is_read(std::string_view type);

    /// One message; damaged ones are counted. @param logged ns since 1970, for messages without time in the header
    void add(const std::string& topic, const std::string& type, RosLayout layout, std::string_view message, std::int64_t logged);
    /// Streams in the order of the topic names; `file` is its name in warnings about ignored data.
    void finish(StreamLog& log, const std::string& file, WarningLog& warnings);

    /// A topic in the log, whether or not it is read: reported if nothing can be used.
    void mention(const std::string& topic, const std::string& type) { mentioned_.insert(topic + " (" + type + ")"); }
    [[nodiscard]] std::string topics() const;

    std::size_t damaged = 0;

private:
    std::map<std::string, Stream> streams_;  ///< by topic
    std::map<std::string, std::size_t> not_measured_;
    std::set<std::string> mentioned_;
};

}  // namespace schuler::io
