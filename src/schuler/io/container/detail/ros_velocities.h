// Velocities of fixes published in separate ROS messages.
#pragma once

#include "schuler/core/log.h"
#include "schuler/io/streams.h"

#include <map>
#include <string>
#include <string_view>

namespace schuler::io::detail {

/// Name of a stream of geometry_msgs twists: columns vel_e_m_s, vel_n_m_s, vel_u_m_s, std_ve_m_s, std_vn_m_s, std_vd_m_s.
inline constexpr std::string_view ros_twist = "twist";

/// Adds to fixes, whose first columns are lat_deg and lon_deg, the velocities from that one of `streams` (by topic) which has the
/// same stamps and agrees with the track. A warning states why others with these stamps are ignored; `file` is its name there.
void join_velocities(Stream& gnss, const std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings);

/// Removes velocities that are always 0: some drivers write these for a missing vertical or complete velocity.
void leave_out_zero_velocities(Stream& gnss);

}  // namespace schuler::io::detail
