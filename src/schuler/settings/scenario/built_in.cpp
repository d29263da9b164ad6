#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {
namespace {

// The same text as examples/demo.toml (compared by a test): the program runs it without its sources.
constexpr std::string_view demonstration =
    R"toml(# A town drive with a tactical-grade IMU, an RTK receiver, a barometer and two outages: what `schuler demo` runs.
#   schuler run examples/demo.toml -o out/demo
name = "demo"
seed = 1
duration_s = 600

[trajectory]
type = "car"
start = { lat_deg = 48.137, lon_deg = 11.575, height_m = 520.0 }
standstill_s = 45
vibration = { frequency_hz = 12, angle_deg = 0.02, accel_m_s2 = 0.3 }

[imu]
rate_hz = 100
grade = "tactical"

[gnss]
rate_hz = 1
receiver = "rtk"
lever_arm_m = [0.5, 0.2, -1.2]

[baro]
rate_hz = 10
white_m = 0.3
bias_m = 5.0
bias_walk_m = 0.02

[[outage]]
start_s = 240
duration_s = 30

[[outage]]
start_s = 420
duration_s = 60

[filter]
smooth = true
)toml";

}  // namespace

std::string_view built_in_scenario(std::string_view name) { return name == "demo" ? demonstration : std::string_view(); }

}  // namespace schuler::settings
