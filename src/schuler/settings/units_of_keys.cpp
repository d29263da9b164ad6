#include "schuler/settings/units_of_keys.h"

#include <array>

namespace schuler::settings {
namespace {

// Longer endings before their own suffixes.
constexpr auto endings = std::to_array<KeyUnit>({
    {"bias_walk_m", "m/sqrt(s)", "m/√s"},
    {"bias_walk_deg", "deg/sqrt(s)", "°/√s"},
    {"rate_walk_deg_h_sqrt_h", "deg/h/sqrt(h)", "°/h/√h"},
    {"walk_mg_sqrt_h", "mg/sqrt(h)", "mg/√h"},
    {"_mgal_km2", "mGal/km2", "mGal/km²"},
    {"per_lateral_accel", "rad/(m/s2)", "rad/(m/s²)"},
    {"per_accel", "rad/(m/s2)", "rad/(m/s²)"},
    {"clock_per_g", "1/g", "1/g"},
    {"_deg_h_k", "deg/h/K", "°/h/K"},
    {"_deg_h_g", "deg/h/g", "°/h/g"},
    {"_mg_k", "mg/K", "mg/K"},
    {"_db_hz", "dB-Hz", "dB-Hz"},
    {"_deg_s_sqrt_hz", "deg/s/sqrt(Hz)", "°/s/√Hz"},
    {"_m_s2_sqrt_hz", "m/s2/sqrt(Hz)", "m/s²/√Hz"},
    {"_ug_sqrt_hz", "ug/sqrt(Hz)", "µg/√Hz"},
    {"_deg_sqrt_h", "deg/sqrt(h)", "°/√h"},
    {"_m_s_sqrt_h", "m/s/sqrt(h)", "m/s/√h"},
    {"_m_s_sqrt_s", "m/s/sqrt(s)", "m/s/√s"},
    {"_deg_sqrt_s", "deg/sqrt(s)", "°/√s"},
    {"_sqrt_s", "sqrt(s)", "√s"},
    {"_mgal_km", "mGal/km", "mGal/km"},
    {"_rad_s", "rad/s", "rad/s"},
    {"_deg_h", "deg/h", "°/h"},
    {"_deg_s", "deg/s", "°/s"},
    {"_m_s2", "m/s2", "m/s²"},
    {"_m_s", "m/s", "m/s"},
    {"_arcsec", "arcsec", "″"},
    {"_mgal", "mGal", "mGal"},
    {"_ppm", "ppm", "ppm"},
    {"_deg", "deg", "°"},
    {"_rad", "rad", "rad"},
    {"_mhz", "MHz", "MHz"},
    {"_hz", "Hz", "Hz"},
    {"_mg", "mg", "mg"},
    {"_ug", "ug", "µg"},
    {"_pa", "Pa", "Pa"},
    {"_ut", "uT", "µT"},
    {"_ms", "ms", "ms"},
    {"_us", "us", "µs"},
    {"_ns", "ns", "ns"},
    {"_hpa", "hPa", "hPa"},
    {"_dbhz", "dB-Hz", "dB-Hz"},
    {"_cm", "cm", "cm"},
    {"_km", "km", "km"},
    {"_m", "m", "m"},
    {"_s", "s", "s"},
    {"_g", "g", "g"},
    {"_c", "deg C", "°C"},
    {"_k", "K", "K"},
});

}  // namespace

KeyUnit unit_of_key(std::string_view key) {
    for (const KeyUnit& unit : endings)
        if (key.ends_with(unit.ending)) return unit;
    return {};
}

}  // namespace schuler::settings
