#include "schuler/app/ignored.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

namespace schuler::app {
namespace {

/// Keys that begin so have no effect where `idle` says why.
struct Rule {
    std::vector<std::string_view> keys;
    std::string reason;      ///< empty: they have an effect
};

std::string unless(bool effect, std::string reason) { return effect ? std::string() : std::move(reason); }

/// Sigmas are stated of every fix.
bool states_all(const std::vector<GnssFix>& fixes, Eigen::Vector3d GnssFix::*std, bool velocity) {
    return !fixes.empty() && std::ranges::all_of(fixes, [&](const GnssFix& f) {
        for (int i = 0; i < 3; ++i)
            if (!((f.*std)(i) > 0.0) && (!velocity || std::isfinite(f.velocity_n(i)))) return false;
        return true;
    });
}

std::vector<Rule> inertial_rules(const ResultBundle& b) {
    const Config& c = b.data.config;
    const fusion::Settings& f = c.filter;
    const bool tight = c.scheme == Scheme::Tight || c.scheme == Scheme::Medium || c.scheme == Scheme::Deep;
    return {{{"filter.aggressive_parts"}, unless(f.loose_kind == fusion::LooseKind::Aggressive, "filter.loose is not \"aggressive\"")},
            {{"filter.separate."}, unless(c.scheme == Scheme::Separate, "the scheme is not \"separate\"")},
            {{"filter.integrity."},
             tight ? "it watches a receiver's fixes; ranges are watched by filter.protection" : unless(f.integrity.use, "filter.integrity.use is not on")},
            {{"filter.loose"}, unless(c.scheme == Scheme::Loose, "the scheme is not \"loose\"")},
            {{"filter.loop"}, unless(c.scheme != Scheme::Separate, "the corrections of the separate scheme are its coupling: the loop is closed")},
            {{"filter.protection."}, unless(tight && f.ranging.protection.use, "it belongs to tight coupling with filter.protection.use")},
            {{"filter.feedback_"}, unless(f.loop == fusion::Loop::Mixed, "filter.loop is not \"mixed\"")},
            {{"filter.nonholonomic_std_", "filter.constraint_rate_hz"},
             unless(f.aids.nonholonomic || f.aids.nonholonomic_auto, "the vehicle constraint is not used")},
            {{"filter.zero_velocity_std_m_s", "filter.zero_rate_std_deg_s"}, unless(f.aids.zero_velocity, "filter.zero_velocity is off")},
            {{"ranges."}, unless(tight || c.scheme == Scheme::Gnss || !b.data.recording.ranges.empty(), "no ranges are used")},
            {{"filter.self_check"}, unless(b.command == "process", "it belongs to `schuler process`")},
            {{"gravity.", "anomaly."}, "it belongs to `schuler gravity`"}};
}

std::vector<Rule> sensor_rules(const ResultBundle& b) {
    const Config& c = b.data.config;
    const fusion::Settings& f = c.filter;
    const Recording& r = b.data.recording;
    const bool baro = f.baro.use && !r.baro.empty(), mag = f.mag.use && !r.mag.empty();
    const bool raw = c.gnss.file.empty() || c.scheme == Scheme::Tight || c.scheme == Scheme::Medium;
    const bool velocities = std::ranges::any_of(r.gnss, [](const GnssFix& x) { return x.velocity_n.allFinite(); });
    const fusion::InitialSettings& i = f.initial;
    const bool position = std::isfinite(i.position.lat) && std::isfinite(i.position.lon) && std::isfinite(i.position.h);
    return {{{"baro.white_m", "baro.bias_", "baro.sea_level_pressure_pa", "baro.columns", "baro.scale", "baro.time_offset_s"},
             unless(baro, "no barometer is used")},
            {{"mag.declination_deg", "mag.heading_", "mag.axes", "mag.columns", "mag.scale", "mag.time_offset_s"},
             unless(mag, "no magnetometer is used")},
            {{"odometer."}, unless(f.odometer.use && !r.odometer.empty(), "no odometer is used")},
            {{"heading."}, unless(f.heading.use && !r.heading.empty(), "no heading sensor is used")},
            {{"gauges."}, unless(!r.gauges.empty(), "no gauges are used")},
            {{"log."}, unless(!r.body_velocity.empty(), "no log of velocity is used")},
            {{"compass."}, unless(f.heading.use && !r.heading.empty(), "no compass is used")},
            {{"gnss.observations", "gnss.navigation"},
             unless(raw || !c.ranges.file.empty(), "gnss.file gives the fixes, and the coupling is loose")},
            {{"gnss.systems", "gnss.elevation_mask_deg", "gnss.ionosphere", "gnss.troposphere", "gnss.precise", "gnss.phase_velocity"},
             unless(!c.raw.observations.empty() || !r.ranges.empty(), "there are no raw measurements")},
            {{"gnss.undulation_m"},
             unless(b.data.logged_height == fusion::HeightKind::Msl, "the heights are not above mean sea level (gnss.height)")},
            {{"gnss.default_std_m"},
             unless(!states_all(r.gnss, &GnssFix::std_position, false), "the log states the sigmas of all positions")},
            {{"gnss.default_std_velocity_m_s"},
             unless(f.gnss.use_velocity && velocities && !states_all(r.gnss, &GnssFix::std_velocity, true),
                    velocities ? "the log states the sigmas of all velocities" : "the log has no velocities")},
            {{"gnss.velocity_latency_s", "gnss.velocity_down_latency_s", "gnss.use_velocity"}, unless(velocities, "the log has no velocities")},
            {{"initial.lat_deg", "initial.lon_deg", "initial.height_m"},
             unless(position, "only latitude, longitude and height together are a position to start from")},
            {{"reference."}, unless(!r.reference.empty(), "there is no reference")},
            {{"stations.coordinates", "stations.columns", "stations.scale"}, unless(!c.ranges.file.empty(), "there is no stations.file")}};
}

}  // namespace

std::vector<Ignored> ignored_of(const ResultBundle& b, const std::set<std::string>& given) {
    static const SettingList defaults = config_table().used(Config{});
    const SettingList used = config_table().used(b.data.config);
    const auto value_in = [](const SettingList& list, const std::string& key) {
        const auto it = std::ranges::find(list, key, &Setting::key);
        return it == list.end() ? std::string() : to_toml(it->value);
    };
    std::vector<Rule> rules = sensor_rules(b);
    if (b.data.config.scheme == Scheme::Gnss)
        rules.push_back({{"filter.smooth", "filter.loop", "filter.mechanization", "filter.backward", "output.lever_arm_m", "output.events", "vehicle."}, "the scheme is \"gnss\": there is no filter"});
    else
        std::ranges::move(inertial_rules(b), std::back_inserter(rules));
    std::vector<Ignored> ignored;
    for (const std::string& key : given) {
        if (value_in(used, key) == value_in(defaults, key)) continue;
        const auto rule = std::ranges::find_if(rules, [&](const Rule& r) {
            return !r.reason.empty() && std::ranges::any_of(r.keys, [&](std::string_view k) { return key.starts_with(k); });
        });
        if (rule != rules.end()) ignored.push_back({key, rule->reason});
    }
    return ignored;
}

}  // namespace schuler::app
