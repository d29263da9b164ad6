// Records of an MCAP file [MCAP]: a solution as ROS 2 messages, and JSON beside it; written at once or message by message.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/time.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace schuler::io {

/// Beginning of a file: magic bytes, header, and the channels /fix (sensor_msgs NavSatFix), /attitude (QuaternionStamped, body to
/// east-north-up) and /velocity (TwistWithCovarianceStamped, east, north, up).
[[nodiscard]] std::string mcap_begin();

/// The channels of McapTopic: JSON objects without a schema.
[[nodiscard]] std::string mcap_json_channels();

/// Appends the messages of one row. False, and nothing appended, if its time is before that of 1970, which MCAP cannot hold.
[[nodiscard]] bool append_mcap(std::string& out, const SolutionRow& row, std::uint32_t number);

enum class McapTopic : std::uint16_t { Event = 4, Health = 5, Satellites = 6 };

/// Appends a JSON object. False as above.
[[nodiscard]] bool append_mcap(std::string& out, McapTopic topic, Time time, std::string_view json, std::uint32_t number);

/// Records that end a file, and the magic bytes.
[[nodiscard]] std::string mcap_end();

}  // namespace schuler::io
