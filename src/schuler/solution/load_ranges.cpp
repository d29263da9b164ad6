#include "schuler/solution/load_ranges.h"

#include "schuler/dataset/ranges.h"
#include "schuler/fusion/integer_search.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/facts.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace schuler::solution {

RangingLog ranges_from_raw(const std::filesystem::path& folder, settings::Config& c, const std::set<std::string>& given,
                           WarningLog& warnings) {
    fusion::RangingFilterSettings& f = c.filter.ranging;
    const bool phases = c.scheme == settings::Scheme::Tight && c.raw.phase_velocity;
    dataset::RawRanges raw = dataset::ranges_from_raw(folder, c, phases, warnings);
    if (raw.phase_span > 0.0) {
        constexpr double slow_rate = 0.005, slow_time = 600.0;  // m/s, s: what air and orbit models leave changes slowly
        if (!given.contains("ranges.correlated_rate_m_s")) f.errors.satellite.correlated_rate = slow_rate;
        if (!given.contains("ranges.correlated_rate_time_s")) f.errors.satellite.correlated_rate_time = slow_time;
        if (!given.contains("ranges.rate_span_s")) f.errors.rate_span = raw.phase_span;
        // The usual value has room for what positions off by metres make of the changes.
        constexpr double much = 1.5;
        if (raw.phase_change > much * f.phase_change_std) {
            warnings.add(
                "phases.noise",
                fmt::format("carrier phases change with {:.1f} mm of noise (one sigma at the zenith; usual: {:.1f} mm): they "
                            "count accordingly",
                            1e3 * raw.phase_change, 1e3 * f.phase_change_std));
            f.phase_change_std = raw.phase_change;
        }
    }
    f.ionosphere = raw.ionosphere;
    f.sigma_by_elevation = true;
    if (!given.contains("ranges.slow_by_model")) f.slow_by_model = !given.contains("ranges.correlated_m");
    // Receivers use temperature-compensated crystals accurate to about a millionth, and let their clock drift within a millisecond.
    constexpr double wander = 3e5, off = 1000.0;  // m, m/s
    sensor::Oscillator& clock = f.errors.clock;
    const bool kind = given.contains("ranges.clock");
    if (!kind && !given.contains("ranges.clock_h0_s")) clock.h0 = sensor::tcxo.h0;
    if (!kind && !given.contains("ranges.clock_h_minus2_hz")) clock.h_minus2 = sensor::tcxo.h_minus2;
    if (!given.contains("ranges.clock_std_m")) clock.bias = wander;
    if (!given.contains("ranges.drift_std_m_s")) clock.drift = off;
    return std::move(raw.log);
}

void take_ranges_to_base(LoadedDataset& data, WarningLog& warnings) {
    settings::Config& c = data.config;
    RangingLog& relative = data.carrier.ranges;
    if (relative.empty()) return;
    if (data.carrier.base_sigma > 0.0) {
        warnings.add(
            "base.tight",
            "the ranges are not taken relative to the base, whose position is not known well enough: give base.position");
        relative = {};
        return;
    }
    if (c.filter.estimate_lever_arm) {
        warnings.add(
            "base.lever_arm",
            "the ranges are not taken relative to the base, whose phases are too exact for a lever arm as a state: give gnss.lever_arm_m "
            "and leave out filter.estimate_lever_arm");
        relative = {};
        return;
    }
    data.recording.ranges = dataset::with_own(std::exchange(relative, {}), data.recording.ranges);
    fusion::RangingFilterSettings& f = c.filter.ranging;
    f.code_correlation = c.base.settings.code_correlation;
    f.phase_correlation = c.base.settings.phase_correlation;
    if (c.base.settings.integers.use) f.integers = std::make_shared<fusion::PpkIntegerSearch>(c.base.settings.integers);
    if (!f.protection.use) return;
    f.protection.use = false;
    warnings.add(
        "base.protection",
        "filter.protection watches pseudoranges: with the carrier phases of a base it is off, and their slips are found one by one");
}

void take_fixes_from_ranges(LoadedDataset& data) {
    const sensor::RangeErrorModel& ranges = data.config.filter.ranging.errors.satellite;
    const bool known = data.given.contains("ranges.correlated_m");
    dataset::RangeFixes found =
        dataset::fixes_from_ranges(data.recording.ranges, data.config.filter.ranging.ionosphere, data.config.raw.solver,
                                   known ? ranges.correlated : 0.0, ranges.correlated_rate);
    data.recording.gnss = std::move(found.fixes);
    if (data.recording.gnss.empty()) return;
    sensor::GnssErrorModel& errors = data.config.filter.gnss.errors;
    const auto tell = [&data](const char* key, auto& setting, const auto& value, const char* note) {
        if (data.given.contains(key)) return;
        setting = value;
        std::erase_if(data.facts, [&](const Fact& f) { return f.key == key; });
        Fact fact;
        fact.key = key;
        fact.value = settings::fact_value_of(*settings::config_table().find(key)->get(data.config));
        fact.note = note;
        data.facts.push_back(std::move(fact));
    };
    const char* by_geometry = "derived from ranges.correlated_m by the geometry of the fixes";
    const bool derived = known && !data.given.contains("gnss.correlated_m");
    if (derived) {
        tell("gnss.correlated_m", errors.correlated_position, found.slow, by_geometry);
        tell("gnss.change_correlated_m", errors.change_correlated_position, found.change, by_geometry);
        tell("gnss.correlated_time_s", errors.correlated_time, ranges.correlation_time, "that of the ranges");
        tell("gnss.correlated_distance_m", errors.correlated_distance, 0.0, "that of the ranges");
    }
    if (ranges.correlated_rate > 0.0) {
        tell("gnss.correlated_velocity_m_s", errors.correlated_velocity, found.slow_velocity,
             "derived from ranges.correlated_rate_m_s by the geometry of the fixes");
        tell("gnss.correlated_velocity_time_s", errors.correlated_velocity_time, ranges.correlated_rate_time,
             "that of the range rates");
    } else if (derived) {
        tell("gnss.correlated_velocity_m_s", errors.correlated_velocity, found.slow_velocity,
             "the errors of range rates are white");
    }
}

}  // namespace schuler::solution
