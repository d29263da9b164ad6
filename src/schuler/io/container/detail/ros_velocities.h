// Velocities of fixes that ROS messages give apart from them.
#pragma once

#include "schuler/core/log.h"
#include "schuler/io/streams.h"

#include <map>
#include <string>
#include <string_view>

namespace schuler::io::detail {

/// Name of a stream of geometry_msgs twists: columns vel_e_m_s, vel_n_m_s, vel_u_m_s, std_ve_m_s, std_vn_m_s, std_vd_m_s.
inline constexpr std::string_view ros_twist = "twist";

/// Adds to fixes, whose first columns are lat_deg and lon_deg, the velocities of that one of `streams` (by topic) which has their stamps and goes their
/// way. Of others with their stamps a warning says why they are left out; `file` is its name there.
void join_velocities(Stream& gnss, const std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings);

/// Leaves out velocities that are always 0: some drivers have no vertical one, or none at all, and write that.
void leave_out_zero_velocities(Stream& gnss);

}  // namespace schuler::io::detail
