// The kinds of measurements and their names in files, messages and plots: the only list of them.
#pragma once

#include "schuler/core/units.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace schuler::filter {

enum class MeasurementKind : std::uint8_t {
    GnssPosition,
    GnssVelocity,
    Baro,
    Mag,
    ZeroVelocity,
    ZeroRate,
    Nonholonomic,
    Pseudorange,
    RangeRate,
    Odometer,
    Heading,
    Gauges,
    BodyVelocity
};

/// Position or velocity of a receiver's fix: two sub-vectors, each monitored separately.
[[nodiscard]] constexpr bool is_part_of_fix(MeasurementKind kind) {
    return kind == MeasurementKind::GnssPosition || kind == MeasurementKind::GnssVelocity;
}

/// Description of one kind.
struct MeasurementInfo {
    MeasurementKind kind;
    std::string_view key;                        ///< in files
    std::string_view name;                       ///< in messages and plots
    std::string_view unit;                       ///< of plots
    double per_unit;                             ///< SI units per displayed unit
    std::array<std::string_view, 3> components;  ///< empty: fewer components
};

inline constexpr std::array measurement_infos{
    MeasurementInfo{MeasurementKind::GnssPosition, "gnss_position", "GNSS position", "m", 1.0, {"north", "east", "down"}},
    MeasurementInfo{MeasurementKind::GnssVelocity, "gnss_velocity", "GNSS velocity", "m/s", 1.0, {"north", "east", "down"}},
    MeasurementInfo{MeasurementKind::Baro, "baro", "barometric height", "m", 1.0, {"down"}},
    MeasurementInfo{MeasurementKind::Mag, "mag", "magnetic heading", "deg", units::deg, {"heading"}},
    MeasurementInfo{MeasurementKind::ZeroVelocity, "zero_velocity", "zero velocity", "m/s", 1.0, {"1", "2", "3"}},
    MeasurementInfo{MeasurementKind::ZeroRate, "zero_rate", "zero rate", "deg/s", units::deg_per_s, {"x", "y", "z"}},
    MeasurementInfo{MeasurementKind::Nonholonomic, "nonholonomic", "vehicle constraint", "m/s", 1.0, {"lateral", "vertical"}},
    MeasurementInfo{MeasurementKind::Pseudorange, "pseudorange", "pseudorange", "m", 1.0, {"range"}},
    MeasurementInfo{MeasurementKind::RangeRate, "range_rate", "range rate", "m/s", 1.0, {"rate"}},
    MeasurementInfo{MeasurementKind::Odometer, "odometer", "odometer", "m/s", 1.0, {"speed"}},
    MeasurementInfo{MeasurementKind::Heading, "heading", "heading sensor", "deg", units::deg, {"heading"}},
    MeasurementInfo{MeasurementKind::Gauges, "gauges", "height gauges", "m", 1.0, {"1", "2", "3"}},
    MeasurementInfo{MeasurementKind::BodyVelocity, "body_velocity", "velocity log", "m/s", 1.0, {"forward", "right", "down"}},
};
inline constexpr std::size_t measurement_kinds = measurement_infos.size();

[[nodiscard]] constexpr const MeasurementInfo& info_of(MeasurementKind kind) {
    return measurement_infos[static_cast<std::size_t>(kind)];
}

}  // namespace schuler::filter
