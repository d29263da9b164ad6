#include "schuler/solution/ignored.h"

#include "schuler/fusion/start.h"
#include "schuler/settings/config/applicability.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

namespace schuler::solution {
namespace {

/// Keys with this prefix have no effect, for the reason in `idle`.
struct Rule {
    std::vector<std::string_view> keys;
    std::string reason;  ///< empty: they have an effect
};

std::string unless(bool effect, std::string reason) { return effect ? std::string() : std::move(reason); }

/// Whether a setting differs from its default.
class Differing {
public:
    explicit Differing(const settings::Config& config) : in_force_(settings::config_table().used(config)) {}

    /// True for keys without a value of their own (ranges.clock stands for two others).
    bool operator()(const std::string& key) const {
        static const settings::SettingList defaults = settings::config_table().used(settings::Config{});
        const std::string value = value_in(in_force_, key);
        return value.empty() || value != value_in(defaults, key);
    }

private:
    static std::string value_in(const settings::SettingList& list, const std::string& key) {
        const auto it = std::ranges::find(list, key, &settings::Setting::key);
        return it == list.end() ? std::string() : settings::to_toml(it->value);
    }

    settings::SettingList in_force_;
};

/// True if sigmas are stated for every fix.
bool states_all(const std::vector<GnssFix>& fixes, Eigen::Vector3d GnssFix::*std, bool velocity) {
    return !fixes.empty() && std::ranges::all_of(fixes, [&](const GnssFix& f) {
        for (int i = 0; i < 3; ++i)
            if (!((f.*std)(i) > 0.0) && (!velocity || std::isfinite(f.velocity_n(i)))) return false;
        return true;
    });
}

bool ranges_state_all(const RangingLog& log, double RangeSample::*std) {
    const auto stated = [&](const RangeSample& m) { return log.sources[m.source].station || m.*std > 0.0; };
    return !log.empty() && std::ranges::all_of(log.samples, stated);
}

/// A preset that is entirely overruled by other settings.
std::string why_preset_is_overruled(const settings::Config& c) {
    if (c.preset == "gravity27") return "these states are those of `schuler gravity`";
    if (const auto coupling = settings::coupling_of_preset(c.preset)) {
        if (coupling->scheme != c.scheme)
            return fmt::format("filter.scheme is given too, and is \"{}\"", settings::scheme_name(c.scheme));
        return unless(c.scheme != settings::Scheme::Loose || coupling->loose_kind == c.filter.loose_kind,
                      "filter.loose is given too, and differs");
    }
    return unless(c.preset != "ins21" || c.filter.scale_factors, "filter.scale_factors is given too, and off");
}

/// Whether the set of satellites is known to change.
bool satellites_change(const ResultBundle& b) {
    const auto another = [](const GnssFix& a, const GnssFix& c) {
        return a.satellites >= 0 && c.satellites >= 0 && a.satellites != c.satellites;
    };
    return !b.data.config.filter.gnss.constellation_changes.empty() ||
           std::ranges::adjacent_find(b.data.recording.gnss, another) != b.data.recording.gnss.end();
}

/// Whether there are errors against a reference that count.
bool compares_after_start(const ResultBundle& b) {
    return std::ranges::any_of(b.evaluation.errors, [&](const auto& e) { return e.time >= b.evaluation.settled; });
}

struct SourceKinds {
    std::size_t systems = 0;  ///< satellite systems
    bool stations = false;
};

SourceKinds kinds_of_sources(const ResultBundle& b) {
    SourceKinds kinds;
    std::set<char> systems;
    for (const RangeSource& source : b.data.recording.ranges.sources) {
        kinds.stations = kinds.stations || source.station;
        if (!source.station && !source.name.empty()) systems.insert(source.name.front());
    }
    kinds.systems = systems.size();
    return kinds;
}

constexpr const char* start_alone = "; it is used for the initial alignment only";

std::vector<Rule> inertial_rules(const ResultBundle& b) {
    const settings::Config& c = b.data.config;
    const fusion::Settings& f = c.filter;
    const bool tight = fusion::uses_ranges(f.coupling);
    const bool separate = c.scheme == settings::Scheme::Separate;
    // The start is found by runs of the loosely coupled filter.
    const auto but_for_start = [&](bool effect, const char* reason) {
        return unless(effect, std::string(reason) + (f.initial.rpy.allFinite() ? "" : start_alone));
    };
    return {{{"gnss.consider_errors"}, but_for_start(c.scheme == settings::Scheme::Loose, "the scheme is not \"loose\"")},
            {{"gnss.consider_errors"},
             unless(!f.gnss.errors.correlated_position.isZero(0.0) || !f.gnss.errors.correlated_velocity.isZero(0.0),
                    "the fixes have no slow errors (gnss.correlated_m, gnss.correlated_velocity_m_s)")},
            {{"filter.preset"}, why_preset_is_overruled(c)},
            {{"filter.loop"},
             unless(c.scheme != settings::Scheme::Separate,
                    "the corrections of the uncoupled scheme are its coupling: the loop is closed")},
            {{"filter.zero_", "filter.nonholonomic", "filter.detect_wheels", "filter.constraint_rate_hz", "filter.floor_", "mag.",
              "odometer.", "heading.", "compass.", "gauges.", "log.", "vehicle.leeway_deg"},
             but_for_start(!separate, "the uncoupled scheme is corrected by position, velocity and height alone")},
            {{"imu.mounting_std_deg"}, unless(!separate, "the uncoupled scheme uses no motion of the vehicle")},
            {{"gnss.latency_", "gnss.velocity_latency_", "gnss.height_latency_s", "gnss.velocity_down_latency_s", "gnss.jitter_s",
              "gnss.correlated_", "gnss.change_", "gnss.std_", "gnss.velocity_std_scale"},
             unless(!tight, "the coupling takes ranges; fixes serve the start, and as reference where ranges are withheld")},
            {{"filter.detect_wheels"},
             unless(f.vehicle != fusion::VehicleKind::Car || !f.constraints.nonholonomic,
                    "a car has the vehicle constraint without it")},
            {{"ranges.network_m"},
             unless(kinds_of_sources(b).stations && kinds_of_sources(b).systems > 0,
                    "the ranges are not of both satellites and stations")},
            {{"ranges.intersystem_m"}, unless(kinds_of_sources(b).systems > 1, "the ranges are those of one satellite system")},
            {{"filter.zero_velocity_std_m_s", "filter.zero_rate_std_deg_s"},
             unless(std::ranges::any_of(b.result.measurements,
                                        [](const auto& r) { return r.kind == fusion::MeasurementKind::ZeroVelocity; }),
                    "no standstill was found")},
            {{"ranges.white_m"},
             unless(!tight || !ranges_state_all(b.data.recording.ranges, &RangeSample::std),
                    "the log states the sigmas of all ranges")},
            {{"ranges.rate_m_s"},
             unless(!tight || !ranges_state_all(b.data.recording.ranges, &RangeSample::std_rate),
                    "the log states the sigmas of all rates")},
            {{"ranges.use_stations"},
             unless(std::ranges::any_of(b.data.recording.ranges.sources, &RangeSource::station), "there are no ground stations")},
            {{"ranges."}, unless(tight || (c.gnss.file.empty() && !b.data.recording.ranges.empty()), "no ranges are used")},
            {{"filter.self_check"}, unless(b.command == "process", "it belongs to `schuler process`")},
            {{"gravity.", "anomaly."}, "it belongs to `schuler gravity`"}};
}

/// Settings disabled by gravimetry::gravity27 in `schuler gravity`. Without [initial], a prior run uses them to find the start.
std::vector<Rule> gravity_rules(const ResultBundle& b) {
    const settings::Config& c = b.data.config;
    const char* what = c.filter.initial.rpy.allFinite() ? "" : start_alone;
    const auto by_survey = [&](const char* reason) { return std::string(reason) + what; };
    return {
        {{"filter.scheme"}, unless(c.scheme == settings::Scheme::Loose, by_survey("gravimetry is loosely coupled"))},
        {{"filter.preset"}, unless(c.preset == "gravity27", by_survey("gravimetry has states of its own, those of gravity27"))},
        {{"filter.loose", "filter.aggressive_parts", "filter.separate.", "filter.protection.", "gnss.consider_errors"},
         by_survey("gravimetry is loosely coupled and uses each fix at its time")},
        {{"filter.mechanization"}, by_survey("gravimetry is Earth-fixed")},
        {{"filter.smooth"}, by_survey("gravity.smooth switches the smoother of gravimetry")},
        {{"filter.integrity."}, by_survey("gravimetry does not exclude the receiver")},
        {{"filter.zero_", "filter.nonholonomic", "filter.detect_wheels", "filter.constraint_rate_hz", "odometer."},
         by_survey("gravimetry uses no wheels and no standstill")},
        {{"output.at_antenna"}, "gravimetry is that of the unit"},
        {{"mag."}, by_survey("gravimetry uses no magnetometer")},
        {{"baro."}, unless(c.gravity.height_aid, by_survey("the barometer is used with gravity.height_aid only"))},
        {{"filter.self_check"}, "it belongs to `schuler process`"},
        {{"imu.mounting_std_deg", "vehicle."}, by_survey("gravimetry uses no motion of the vehicle")},
        {{"filter.feedback_"}, std::string(settings::idle_reason("filter.feedback_", c))},
        {{"imu.estimate_noise"},
         unless(!fusion::gives_start(c.filter.initial), "noise is estimated where the start is, and [initial] gives the start")},
        {{"ranges.", "stations."}, by_survey("gravimetry uses no ranges")}};
}

/// Files and outputs of single runs, which a campaign does not have.
std::vector<Rule> campaign_rules(const ResultBundle& b) {
    constexpr std::array<std::string_view, 4> of_a_run{"covariance", "states", "mat", "kml"};
    const std::vector<std::string>& files = b.data.config.output.files;
    const bool asked =
        std::ranges::any_of(of_a_run, [&](std::string_view f) { return std::ranges::find(files, f) != files.end(); });
    return {
        {{"filter.backward", "output.events", "output.lever_arm_m"}, "a campaign keeps no solution of its runs"},
        {{"output.files"},
         unless(!asked || files == settings::Config{}.output.files, "a campaign writes summary.json, runs.csv and report.html")}};
}

std::vector<Rule> sensor_rules(const ResultBundle& b) {
    const settings::Config& c = b.data.config;
    const fusion::Settings& f = c.filter;
    const Recording& r = b.data.recording;
    const bool baro = f.baro.use && !r.baro.empty(), mag = f.mag.use && !r.mag.empty();
    const bool raw = c.gnss.file.empty() || fusion::uses_ranges(f.coupling);
    const bool velocities = std::ranges::any_of(r.gnss, [](const GnssFix& x) { return x.velocity_n.allFinite(); });
    const fusion::InitialSettings& i = f.initial;
    const bool position = std::isfinite(i.position.lat) && std::isfinite(i.position.lon) && std::isfinite(i.position.h);
    return {
        {{"gnss.change_"},
         unless(satellites_change(b), "the log shows no change of the satellites (gnss.constellation_change_s gives them)")},
        {{"gnss.correlated_time_s", "gnss.correlated_distance_m"},
         unless(!f.gnss.errors.correlated_position.isZero(0.0), "the positions have no slow errors (gnss.correlated_m)")},
        {{"gnss.correlated_velocity_time_s"},
         unless(!f.gnss.errors.correlated_velocity.isZero(0.0),
                "the velocities have no slow errors (gnss.correlated_velocity_m_s)")},
        {{"baro.sea_level_pressure_pa"},
         unless(!baro || std::ranges::any_of(r.baro, [](const BaroSample& x) { return std::isfinite(x.pressure); }),
                "the log gives heights, not pressures")},
        {{"imu.gyro_quantum_", "imu.gyro_temperature_", "imu.accel_quantum_", "imu.accel_temperature_"},
         unless(b.command != "process" && (b.command != "gravity" || b.data.true_reference),
                "it is an error of simulated units; the filter has biases and white noise for it")},
        {{"baro.white_m", "baro.bias_", "baro.sea_level_pressure_pa", "baro.columns", "baro.scale", "baro.time_offset_s"},
         unless(baro, "no barometer is used")},
        {{"mag.declination_deg", "mag.heading_", "mag.axes", "mag.columns", "mag.scale", "mag.time_offset_s"},
         unless(mag || !f.mag.use, "no magnetometer is used")},
        {{"odometer."}, unless(f.odometer.use && !r.odometer.empty(), "no odometer is used")},
        {{"heading."}, unless(f.heading.use && !r.heading.empty(), "no heading sensor is used")},
        {{"heading.std_deg"},
         unless(!std::ranges::all_of(r.heading, [](const HeadingSample& h) { return h.std > 0.0; }),
                "the log states the sigmas of all headings")},
        {{"odometer.std_m_s"},
         unless(!std::ranges::all_of(r.odometer, [](const OdometerSample& o) { return o.std > 0.0; }),
                "the log states the sigmas of all speeds")},
        {{"heading.std_deg", "heading.offset_deg"},
         unless(!f.heading.by_course, "the course takes the place of a heading sensor")},
        {{"vehicle.leeway_deg"},
         unless(f.heading.by_course || c.leeway == 0.0,
                "the course is used for ships without a heading sensor that make a metre per second or more")},
        {{"gauges."}, unless(!r.gauges.empty(), "no gauges are used")},
        {{"log."}, unless(!r.body_velocity.empty(), "no log of velocity is used")},
        {{"compass."}, unless(f.heading.use && !r.heading.empty() && !c.instruments.compass.file.empty(), "no compass is used")},
        {{"gnss.observations", "gnss.navigation"},
         unless(raw || !c.ranges.file.empty(), "gnss.file gives the fixes, and the coupling is loose")},
        {{"gnss.elevation_mask_deg"},
         unless(raw && (!c.raw.observations.empty() || !r.ranges.empty()), "no raw measurements are used")},
        {{"gnss.ionosphere", "gnss.troposphere", "gnss.systems", "gnss.cn0_mask_db_hz", "gnss.code_std_m", "gnss.doppler_std_m_s",
          "gnss.precise", "gnss.phase_velocity", "gnss.raim"},
         unless(raw && !c.raw.observations.empty(), raw && !r.ranges.empty()
                                                        ? "the ranges are those of a table, not of observations"
                                                        : "no raw measurements are used")},
        {{"gnss.antennas"},
         unless(!c.raw.precise.empty() || !b.data.carrier.epochs.empty(), "there is neither a base nor gnss.precise")},
        {{"gnss.antenna_type", "base.antenna_type"},
         unless(!c.raw.antennas.empty() && !b.data.carrier.epochs.empty(),
                c.raw.antennas.empty() ? "gnss.antennas gives no calibrations" : "no base is used")},
        {{"base."},
         b.data.carrier.epochs.empty() ? c.base.observations.empty() ? "no base station is given (base.observations)"
                                         : !c.gnss.file.empty()      ? "gnss.file gives the fixes"
                                                                     : "the coupling takes ranges instead of fixes"
         : fusion::uses_ranges(f.coupling) && r.ranges.carriers.empty()
             ? f.coupling == fusion::Coupling::Tight
                   ? "the base's position is not known well enough, and its phases serve the start and the self-check alone: give base.position"
                   : "the coupling takes pseudoranges and range rates; positions by the phases against the base serve the start and the "
                     "self-check alone, --scheme tight or loose uses them"
             : ""},
        {{"gnss.undulation_m"},
         unless(b.data.logged_height == fusion::HeightKind::Msl, "the heights are not above mean sea level (gnss.height)")},
        {{"gnss.default_std_m"},
         unless(!states_all(r.gnss, &GnssFix::std_position, false), "the log states the sigmas of all positions")},
        {{"gnss.default_std_velocity_m_s"},
         unless(f.gnss.use_velocity && velocities && !states_all(r.gnss, &GnssFix::std_velocity, true),
                velocities            ? "the log states the sigmas of all velocities"
                : f.gnss.use_velocity ? "the log has no velocities"
                                      : "velocities are not used (gnss.use_velocity)")},
        {{"gnss.velocity_latency_s", "gnss.velocity_down_latency_s"},
         unless(velocities, f.gnss.use_velocity ? "the log has no velocities" : "velocities are not used (gnss.use_velocity)")},
        {{"gnss.lever_arm_std_m"}, unless(f.estimate_lever_arm, "the lever arm is no state (filter.estimate_lever_arm)")},
        {{"gnss.use_velocity"}, unless(velocities || !f.gnss.use_velocity, "the log has no velocities")},
        {{"initial.lat_deg", "initial.lon_deg", "initial.height_m"},
         unless(position, "only latitude, longitude and height together are a position to start from")},
        {{"reference."}, unless(!r.reference.empty(), "there is no reference")},
        {{"stations."}, unless(raw, "no ranges are used")},
        {{"stations.coordinates", "stations.columns", "stations.scale"},
         unless(!c.ranges.file.empty(), "there is no stations.file")}};
}

}  // namespace

std::vector<Ignored> ignored_of(const ResultBundle& b, const std::set<std::string>& given) {
    const Differing differs(b.data.config);
    std::vector<Rule> rules = b.command == "gravity" ? gravity_rules(b) : std::vector<Rule>{};  // the first match is used
    if (b.command == "montecarlo") std::ranges::move(campaign_rules(b), std::back_inserter(rules));
    std::ranges::move(sensor_rules(b), std::back_inserter(rules));
    if (b.data.config.scheme == settings::Scheme::Gnss && b.command != "gravity")
        rules.insert(
            rules.begin(),
            {{{"output.at_antenna"}, "the solution is that of the receiver"},
             {{"gnss.lever_arm_m"},
              unless(compares_after_start(b), "the scheme is \"gnss\": there is no filter, and no reference to compare it with")},
             {{"output.files"},
              unless(!b.data.config.output.wants("states") && !b.data.config.output.wants("covariance"),
                     "\"states\" and \"covariance\" are those of a filter, and the scheme is \"gnss\"")},
             {{"filter.",
               "output.lever_arm_m",
               "output.events",
               "vehicle.",
               "mag.",
               "baro.",
               "odometer.",
               "heading.",
               "compass.",
               "gauges.",
               "log.",
               "ranges.",
               "gnss.use_velocity",
               "gnss.latency_std_s",
               "gnss.velocity_latency_std_s",
               "gnss.correlated_",
               "gnss.change_",
               "gnss.consider_errors",
               "gnss.std_",
               "gnss.velocity_std_scale",
               "gnss.jitter_s",
               "gnss.found_lever_arm_std_m",
               "gnss.height_latency_s",
               "gnss.velocity_latency_s",
               "gnss.velocity_down_latency_s",
               "gravity.",
               "earth.gravity",
               "earth.rotation_rad_s",
               "imu.stamp",
               "imu.grade",
               "gnss.estimate_",
               "imu.gyro_",
               "imu.accel_",
               "imu.estimate_",
               "imu.mounting_",
               "imu.found_mounting_",
               "initial."},
              "the scheme is \"gnss\": there is no filter"}});
    else if (b.command != "gravity") {
        for (const std::string& key : given)
            if (const std::string_view reason = settings::idle_reason(key, b.data.config); !reason.empty())
                rules.push_back({{key}, std::string(reason)});
        std::ranges::move(inertial_rules(b), std::back_inserter(rules));
    }
    std::vector<Ignored> ignored;
    for (const std::string& key : given) {
        const bool contrary = key == "filter.smooth" && b.command == "gravity";  // its default is the smoother
        if ((key == "filter.scheme" && b.command != "gravity") || (!contrary && !differs(key))) continue;
        const auto rule = std::ranges::find_if(rules, [&](const Rule& r) {
            return !r.reason.empty() && std::ranges::any_of(r.keys, [&](std::string_view k) { return key.starts_with(k); });
        });
        if (rule != rules.end()) ignored.push_back({key, rule->reason});
    }
    return ignored;
}

std::vector<Ignored> ignored_by_attitude(const settings::Config& config, const std::set<std::string>& given) {
    constexpr std::array<std::string_view, 16> used{"imu.file",         "imu.format",        "imu.source",
                                                    "imu.columns",      "imu.scale",         "imu.parts",
                                                    "imu.kind",         "imu.stamp",         "imu.axes",
                                                    "imu.mounting_deg", "imu.time_offset_s", "imu.clock_drift_ppm",
                                                    "imu.arrival_time", "imu.gap_factor",    "imu.gyro_range_deg_s",
                                                    "imu.accel_range_g"};
    constexpr std::array<std::string_view, 9> used_of_magnetometer{"file",  "format",        "source", "columns",        "scale",
                                                                   "parts", "time_offset_s", "use",    "declination_deg"};
    constexpr std::array<std::string_view, 8> used_elsewhere{"name",       "reference.",   "time.",        "run.start_s",
                                                             "run.stop_s", "output.files", "vehicle.kind", "initial.lat_deg"};
    // of the receiver: what decides how its velocities and its first position are read
    constexpr std::array<std::string_view, 10> used_of_gnss{"file",  "format", "source",        "columns",      "scale",
                                                            "parts", "height", "time_offset_s", "undulation_m", "fix_codes"};
    const Differing differs(config);
    const auto is_used = [&](const std::string& key) {
        const auto within = [&](std::string_view section, const auto& names) {
            return key.starts_with(section) &&
                   std::ranges::find(names, std::string_view(key).substr(section.size())) != names.end();
        };
        return std::ranges::find(used, key) != used.end() || within("mag.", used_of_magnetometer) ||
               within("gnss.", used_of_gnss) || key == "initial.lon_deg" || key == "initial.height_m" ||
               std::ranges::any_of(used_elsewhere, [&](std::string_view k) { return key.starts_with(k); });
    };
    std::vector<Ignored> ignored;
    for (const std::string& key : given)
        if (!is_used(key) && differs(key)) ignored.push_back({key, "not used by attitude filters"});
    return ignored;
}

void warn_of_ignored(const std::vector<Ignored>& ignored, WarningLog& warnings) {
    constexpr std::size_t shown = 4;
    std::map<std::string, std::vector<std::string>> keys;  // by reason
    for (const Ignored& i : ignored) keys[i.reason].push_back(i.key);
    for (const Ignored& i : ignored) {
        const std::vector<std::string>& same = keys[i.reason];
        if (same.front() != i.key) continue;
        std::string names = fmt::format(
            "{}", fmt::join(same.begin(), same.begin() + static_cast<std::ptrdiff_t>(std::min(shown, same.size())), ", "));
        if (same.size() > shown) names += fmt::format(" and {} more", same.size() - shown);
        warnings.add("ignored." + i.key, fmt::format("{} {} given and {} no effect: {}", names, same.size() == 1 ? "is" : "are",
                                                     same.size() == 1 ? "has" : "have", i.reason));
    }
}

}  // namespace schuler::solution
