// Settings under which an option has an effect: for help, forms and documents. Checked for a run in solution/ignored.cpp.
#include "schuler/settings/config/sections.h"

#include <array>
#include <string_view>
#include <utility>

namespace schuler::settings {
namespace {

/// Prefixes of keys; the first match is used.
constexpr auto conditions = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"filter.aggressive_parts", "filter.loose = \"aggressive\""},
    {"filter.loose", "filter.scheme = \"loose\""},
    {"gnss.consider_errors", "filter.scheme = \"loose\""},
    {"filter.separate.", "filter.scheme = \"separate\""},
    {"filter.integrity.use", "schemes that use fixes"},
    {"filter.integrity.", "filter.integrity.use"},
    {"filter.protection.use", "schemes that use ranges"},
    {"filter.protection.", "filter.protection.use"},
    {"filter.feedback_", "filter.loop = \"mixed\""},
    {"filter.nonholonomic_std_", "the vehicle constraint is used"},
    {"filter.constraint_rate_hz", "the vehicle constraint is used"},
    {"filter.zero_velocity_std_m_s", "filter.zero_velocity"},
    {"filter.zero_rate_std_deg_s", "filter.zero_velocity"},
    {"filter.self_check", "`schuler process`"},
    {"ranges.receiver_acceleration_m_s_sqrt_s", "filter.scheme = \"intermediate\""},
    {"ranges.", "schemes that use ranges"},
    {"gravity.", "`schuler gravity`"},
    {"anomaly", "`schuler gravity`"},
    {"gauges.", "`schuler gravity`, or a log of them"},
    {"baro.file", ""},
    {"baro.", "a barometer"},
    {"mag.file", ""},
    {"mag.", "a magnetometer"},
    {"odometer.file", ""},
    {"odometer.", "an odometer"},
    {"vehicle.leeway_deg", "a ship without a heading sensor"},
    {"heading.file", ""},
    {"heading.", "a heading sensor"},
    {"log.file", ""},
    {"log.", "a log of velocity"},
    {"compass.file", ""},
    {"compass.", "a compass"},
    {"gnss.systems", "raw measurements"},
    {"gnss.elevation_mask_deg", "raw measurements"},
    {"gnss.ionosphere", "raw measurements"},
    {"gnss.troposphere", "raw measurements"},
    {"gnss.precise", "raw measurements"},
    {"gnss.antennas", "raw measurements"},
    {"gnss.antenna_type", "raw measurements"},
    {"gnss.phase_velocity", "raw measurements"},
    {"gnss.undulation_m", "heights above mean sea level"},
    {"gnss.default_std_", "logs without standard deviations"},
    {"base.observations", ""},
    {"base.", "a base station"},
    {"reference.file", ""},
    {"reference.", "a reference"},
});

}  // namespace

std::string condition_of(std::string_view key) {
    for (const auto& [beginning, condition] : conditions)
        if (key.starts_with(beginning)) return std::string(condition);
    return {};
}

}  // namespace schuler::settings
