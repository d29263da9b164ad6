// The kinds of trajectories that use an option, by the prefixes of the keys of [trajectory].
#include "schuler/settings/scenario/sections.h"

#include <array>
#include <utility>

namespace schuler::settings {
namespace {

/// The first match is used. Options of all kinds are not listed.
constexpr auto conditions = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"trajectory.attitude_deg", "trajectory.type: static, table"},
    {"trajectory.heading_deg", "trajectory.type: great_circle, takeoff, racetrack, approach, figure8, ship, survey"},
    {"trajectory.speed_m_s", "trajectory.type: great_circle, takeoff, racetrack, approach, ship, survey"},
    {"trajectory.lat_", "trajectory.type: paper_a"},
    {"trajectory.lon_", "trajectory.type: paper_a"},
    {"trajectory.height_change_m", "trajectory.type: takeoff, approach"},
    {"trajectory.height_", "trajectory.type: paper_a"},
    {"trajectory.period_s", "trajectory.type: paper_a"},
    {"trajectory.roll_per_accel", "trajectory.type: paper_a"},
    {"trajectory.moves", "trajectory.type: table"},
    {"trajectory.file", "trajectory.type: file"},
    {"trajectory.smoothing_s", "trajectory.type: file"},
    {"trajectory.length_m", "trajectory.type: figure8"},
    {"trajectory.width_m", "trajectory.type: figure8"},
    {"trajectory.loop_height_m", "trajectory.type: figure8"},
    {"trajectory.figure_s", "trajectory.type: figure8"},
    {"trajectory.waves.", "trajectory.type: ship"},
    {"trajectory.waypoints", "trajectory.type: waypoints"},
    {"trajectory.standstill_s", "trajectory.type: car, waypoints, survey"},
    {"trajectory.start_speed_m_s", "trajectory.type: waypoints"},
    {"trajectory.knot_spacing_m", "trajectory.type: car, waypoints"},
    {"trajectory.corner_radius_m", "trajectory.type: car, waypoints"},
    {"trajectory.lateral_accel_m_s2", "trajectory.type: car, waypoints"},
    {"trajectory.longitudinal_accel_m_s2", "trajectory.type: car, waypoints"},
    {"trajectory.roll_per_lateral_accel", "trajectory.type: car, waypoints"},
    {"trajectory.pitch_per_accel", "trajectory.type: car, waypoints"},
    {"trajectory.vibration.frequency_hz", "trajectory.type: car, waypoints"},
    {"trajectory.survey.", "trajectory.type: survey"},
    {"trajectory.drape.clearance_m", "trajectory.type: survey, waypoints"},
});

}  // namespace

std::string_view condition_in_scenario(std::string_view key) {
    for (const auto& [prefix, condition] : conditions)
        if (key.starts_with(prefix)) return condition;
    return {};
}

}  // namespace schuler::settings
