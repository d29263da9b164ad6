// Velocities and attitudes of fixes published in separate ROS messages.
#pragma once

#include "schuler/core/log.h"
#include "schuler/io/streams.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::io::detail {

/// Name of a stream of geometry_msgs twists: columns vel_e_m_s, vel_n_m_s, vel_u_m_s, std_ve_m_s, std_vn_m_s, std_vd_m_s.
inline constexpr std::string_view ros_twist = "twist";
/// Likewise, of messages whose frame is named "enu".
inline constexpr std::string_view ros_twist_enu = "twist_enu";

/// Name of a stream of geometry_msgs/QuaternionStamped: columns quat_sensor_to_enu_w, x, y, z.
inline constexpr std::string_view ros_attitude = "attitude";

/// True for streams of these names, which are parts of fixes and not streams of a log.
[[nodiscard]] inline bool is_of_a_fix(const Stream& s) {
    return s.name == ros_twist || s.name == ros_twist_enu || s.name == ros_attitude;
}

/// Adds to fixes, whose first columns are lat_deg and lon_deg, the velocities from that one of `streams` (by topic) which has the
/// same stamps and agrees with the track, or is stated to be to the east, north and up. A warning states why others with these stamps
/// are ignored; `file` is its name there.
void join_velocities(Stream& gnss, const std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings);

/// The fixes together with the attitude from that one of `streams` which has their stamps, as in a solution that Schuler has written: a
/// reference with the name "solution". Nothing if there is none.
[[nodiscard]] std::optional<Stream> with_attitude(const Stream& gnss, const std::map<std::string, Stream>& streams);

/// Removes velocities that are always 0: some drivers write these for a missing vertical or complete velocity.
void leave_out_zero_velocities(Stream& gnss);

}  // namespace schuler::io::detail
