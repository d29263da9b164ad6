// Inertial units whose gyros and accelerometers are published apart.
#pragma once

#include "schuler/core/log.h"
#include "schuler/io/streams.h"

#include <map>
#include <string>

namespace schuler::io::detail {

/// Cameras and some drivers publish gyros and accelerometers as a topic of sensor_msgs/Imu each, in which the other values are zero or
/// marked as not measured (NaN here). Two such topics become one stream at the times of the gyros, the accelerations interpolated; of
/// several, those with the longest common beginning of their names. A topic that remains without its other half is left out, with a warning;
/// kept are zeros that are not marked, if no unit is complete. `file` is its name in warnings.
void complete_imus(std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings);

}  // namespace schuler::io::detail
