#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/gnss_error_options.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {
namespace {

using fusion::GnssSettings;

constexpr double latency_low = -60.0, latency_high = 60.0;

Option<Config> latency_option() {
    return special<Config>(
        "gnss.latency_s", "a number from -60 to 60 or \"estimate\"",
        "age of a fix at its time stamp; \"estimate\" finds every latency that is not given",
        [](Config& c, const Value& v) {
            GnssSettings& s = c.filter.gnss;
            if (v.text() != nullptr && *v.text() == "estimate") {
                s.estimate_latency = true;
                return;
            }
            if (!v.is_number() || !(v.number() >= latency_low && v.number() <= latency_high)) {
                throw input_error(fmt::format("{} is not a latency", to_toml(v)), {},
                                  "give seconds from -60 to 60, or \"estimate\"");
            }
            s.estimate_latency = false;
            s.latency = v.number();
        },
        [](const Config& c) -> std::optional<Value> {
            if (c.filter.gnss.estimate_latency) return Value{std::string("estimate")};
            return Value{c.filter.gnss.latency};
        });
}

Option<Config> fix_codes_option() {
    static const std::vector<std::string> names{"none", "autonomous", "differential", "rtk_fixed", "rtk_float"};
    Option<Config> option =
        text_map<Config>("gnss.fix_codes", "code in the file = none, autonomous, differential, rtk_fixed or rtk_float",
                         [](auto& c) -> auto& { return c.fix_codes; });
    option.set = [set = option.set](Config& c, const Value& v) {
        set(c, v);
        for (const auto& [code, name] : c.fix_codes) {
            if (std::ranges::find(names, name) == names.end()) {
                throw input_error(fmt::format("unknown fix type \"{}\"", name), {},
                                  "use none, autonomous, differential, rtk_fixed or rtk_float");
            }
        }
    };
    return option;
}

/// Access to a field of the GNSS settings.
template <class T>
auto gnss(T GnssSettings::*field) {
    return [=](auto& c) -> auto& { return c.filter.gnss.*field; };
}

}  // namespace

void add_gnss_options(OptionTable<Config>& table) {
    using fusion::HeightKind;
    table.add(fix_codes_option())
        .add(vector3<Config>("gnss.lever_arm_m", 1.0, -100, 100, "IMU to antenna, body axes forward, right, down",
                             gnss(&GnssSettings::lever_arm_b)))
        .add(number<Config>("gnss.lever_arm_std_m", 1.0, 1e-4, 1000,
                            "one sigma of each component of the lever arm, where it is a state (filter.estimate_lever_arm)",
                            gnss(&GnssSettings::lever_arm_std)))
        .add(vector3<Config>(
            "gnss.found_lever_arm_std_m", 1.0, 0, 100,
            "one sigma of a lever arm that was found, beyond that of its state; the reported position includes it",
            gnss(&GnssSettings::found_lever_arm_std)))
        .add(latency_option())
        .add(number<Config>("gnss.latency_std_s", 1.0, 0, 10,
                            "one sigma of the latency of positions; above 0 the filter estimates its error",
                            gnss(&GnssSettings::latency_std)))
        .add(number<Config>("gnss.velocity_latency_s", 1.0, latency_low, latency_high, "replaces latency_s for the velocity",
                            gnss(&GnssSettings::velocity_latency)))
        .add(flag<Config>(
            "gnss.consider_errors",
            "loose coupling: the slow errors of fixes widen the covariance and lower the gains, but are not estimated",
            gnss(&GnssSettings::consider_errors)))
        .add(number<Config>(
            "gnss.jitter_s", 1.0, 0, 10,
            "one sigma of the white error of the fixes' times: positions vary by it times the velocity, velocities times the "
            "acceleration; default: fitted with the noise",
            [](auto& c) -> auto& { return c.filter.gnss.jitter; }))
        .add(number<Config>(
            "gnss.velocity_latency_std_s", 1.0, 0, 10,
            "one sigma of the velocities' latency; above 0 the filter estimates its error, separately from the positions'",
            gnss(&GnssSettings::velocity_latency_std)))
        .add(number<Config>("gnss.height_latency_s", 1.0, latency_low, latency_high, "replaces latency_s for the height",
                            gnss(&GnssSettings::height_latency)))
        .add(number<Config>("gnss.velocity_down_latency_s", 1.0, latency_low, latency_high,
                            "replaces velocity_latency_s for the down component", gnss(&GnssSettings::velocity_down_latency)))
        .add(choice<Config, HeightKind>(
            "gnss.height",
            {{"ellipsoidal", HeightKind::Ellipsoidal}, {"msl", HeightKind::Msl}, {"relative", HeightKind::Relative}},
            "surface that heights refer to", gnss(&GnssSettings::height)))
        .add(number<Config>("gnss.undulation_m", 1.0, -120, 120,
                            "geoid above the ellipsoid, added to heights above mean sea level",
                            [](auto& c) -> auto& { return c.undulation; }))
        .add(vector3<Config>("gnss.default_std_m", 1.0, 1e-4, 1e5, "one sigma north, east, down where the log gives none",
                             gnss(&GnssSettings::default_std_position)))
        .add(vector3<Config>("gnss.default_std_velocity_m_s", 1.0, 1e-4, 1e4,
                             "one sigma of the velocity where the log gives none", gnss(&GnssSettings::default_std_velocity)))
        .add(vector3<Config>("gnss.std_floor_m", 1.0, 0, 1e3, "lower limit of the standard deviations of the log",
                             gnss(&GnssSettings::std_floor_position)))
        .add(number<Config>("gnss.std_scale", 1.0, 1e-3, 1e3, "factor to the log's own sigmas of positions",
                            gnss(&GnssSettings::std_scale)))
        .add(number<Config>("gnss.velocity_std_scale", 1.0, 1e-3, 1e3, "factor to the log's own sigmas of velocities",
                            gnss(&GnssSettings::velocity_std_scale)))
        .add(flag<Config>("gnss.estimate_std",
                          "where the log gives no standard deviations: scale the defaults until the innovations are consistent",
                          gnss(&GnssSettings::estimate_std)))
        .add(flag<Config>("gnss.use_velocity", "use the velocity of the log", gnss(&GnssSettings::use_velocity)));
    add_gnss_error_options(table, gnss(&GnssSettings::errors));
    table.add(constellation_change_option<Config>(
        "times, on the data set's own axis, at which the set of satellites changes, besides changes of their number",
        [](const Config& c) {
            std::vector<double> times;
            for (const Time t : c.filter.gnss.constellation_changes) times.push_back(t.seconds());
            return times;
        },
        [](Config& c, const std::vector<double>& times) {
            c.filter.gnss.constellation_changes.clear();
            for (const double t : times) c.filter.gnss.constellation_changes.push_back(Time::from_seconds(t));
        }));
}

}  // namespace schuler::settings
