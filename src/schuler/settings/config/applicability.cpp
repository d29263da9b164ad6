// Applicability of the options, by the prefixes of their keys.
#include "schuler/settings/config/applicability.h"

#include "schuler/settings/config/config.h"

#include <array>

namespace schuler::settings {
namespace {

constexpr std::string_view unless(bool effect, std::string_view reason) { return effect ? std::string_view() : reason; }

std::string_view not_loose(const Config& c) { return unless(c.scheme == Scheme::Loose, "the scheme is not \"loose\""); }
std::string_view not_separate(const Config& c) { return unless(c.scheme == Scheme::Separate, "the scheme is not \"separate\""); }
std::string_view not_intermediate(const Config& c) {
    return unless(c.scheme == Scheme::Intermediate, "the scheme is not \"intermediate\"");
}
std::string_view not_aggressive(const Config& c) {
    return unless(c.filter.loose_kind == fusion::LooseKind::Aggressive, "filter.loose is not \"aggressive\"");
}
std::string_view ranges_without_fixes(const Config& c) {
    return unless(!fusion::uses_ranges(c.filter.coupling),
                  "it watches a receiver's fixes; ranges are watched by filter.protection");
}
std::string_view no_integrity(const Config& c) {
    const std::string_view other = ranges_without_fixes(c);
    return other.empty() ? unless(c.filter.integrity.use, "filter.integrity.use is not on") : other;
}
std::string_view no_protection(const Config& c) {
    return unless(fusion::uses_ranges(c.filter.coupling) && c.filter.ranging.protection.use,
                  "it belongs to tight coupling with filter.protection.use");
}
std::string_view not_mixed(const Config& c) {
    return unless(c.filter.loop == fusion::Loop::Mixed, "filter.loop is not \"mixed\"");
}
std::string_view no_vehicle_constraint(const Config& c) {
    const fusion::ConstraintSettings& s = c.filter.constraints;
    return unless(s.nonholonomic || s.nonholonomic_auto, "the vehicle constraint is not used");
}
std::string_view no_zero_velocity(const Config& c) {
    return unless(c.filter.constraints.zero_velocity, "filter.zero_velocity is off");
}

/// The first match is used.
constexpr auto table = std::to_array<Applicability>({
    {"filter.aggressive_parts", "filter.loose = \"aggressive\"", not_aggressive},
    {"filter.loose", "filter.scheme = \"loose\"", not_loose},
    {"gnss.consider_errors", "filter.scheme = \"loose\""},  // and before it, while the start is sought
    {"filter.separate.", "filter.scheme = \"separate\"", not_separate},
    {"filter.integrity.use", "schemes that use fixes", ranges_without_fixes},
    {"filter.integrity.", "filter.integrity.use", no_integrity},
    {"filter.protection.use", "schemes that use ranges", no_protection},
    {"filter.protection.", "filter.protection.use", no_protection},
    {"filter.feedback_", "filter.loop = \"mixed\"", not_mixed},
    {"filter.nonholonomic_std_", "the vehicle constraint is used", no_vehicle_constraint},
    {"filter.constraint_rate_hz", "the vehicle constraint is used", no_vehicle_constraint},
    {"filter.zero_velocity_std_m_s", "filter.zero_velocity", no_zero_velocity},
    {"filter.zero_rate_std_deg_s", "filter.zero_velocity", no_zero_velocity},
    {"filter.self_check", "`schuler process`"},
    {"ranges.receiver_acceleration_m_s_sqrt_s", "filter.scheme = \"intermediate\"", not_intermediate},
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

const Applicability* applicability_of(std::string_view key) {
    for (const Applicability& one : table)
        if (key.starts_with(one.prefix)) return &one;
    return nullptr;
}

std::string_view idle_reason(std::string_view key, const Config& config) {
    const Applicability* one = applicability_of(key);
    return one != nullptr && one->idle != nullptr ? one->idle(config) : std::string_view();
}

}  // namespace schuler::settings
