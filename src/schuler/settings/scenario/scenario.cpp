#include "schuler/settings/scenario/scenario.h"

#include "schuler/core/units.h"
#include "schuler/sensor/receivers.h"
#include "schuler/settings/config/anomaly_options.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/gnss_error_options.h"
#include "schuler/settings/imu_error_options.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/settings/scenario/sections.h"
#include "schuler/settings/toml_file.h"

#include <algorithm>
#include <iterator>

namespace schuler::settings {
namespace {

using Table = OptionTable<ScenarioConfig>;
using S = ScenarioConfig;
using units::deg;

/// An option of dataset.toml under the same key: it applies to `processing`.
Option<S> of_processing(const Option<Config>& option) {
    return {option.spec, [set = option.set](S& s, const Value& v) { set(s.processing, v); },
            [get = option.get](const S& s) { return get(s.processing); }};
}

void add_general(Table& table) {
    table.add(text<S>("name", "name of the scenario and of its output folder", [](auto& s) -> auto& { return s.name; }))
        .add(integer<S>("seed", 0, 9.0e15, "seed of the random numbers", [](auto& s) -> auto& { return s.sim.seed; }))
        .add(number<S>("duration_s", 1.0, 1e-3, 1e6, "simulated time", [](auto& s) -> auto& { return s.sim.duration; }))
        .add(number<S>("reference_rate_hz", 1.0, 1e-3, 1e5, "rate of the truth",
                       [](auto& s) -> auto& { return s.sim.reference_rate; }));
    Option<S> vehicle = of_processing(*config_table().find("vehicle.kind"));
    vehicle.set = [set = vehicle.set](S& s, const Value& v) {
        set(s, v);
        s.vehicle = s.processing.filter.vehicle;
    };
    vehicle.get = [get = vehicle.get](const S& s) { return s.vehicle ? get(s) : std::optional<Value>(); };
    vehicle.spec.help += "; default: as the trajectory suggests";
    table.add(std::move(vehicle));
    for (const char* key : {"earth.model", "earth.gravity", "earth.rotation_rad_s"})
        table.add(of_processing(*config_table().find(key)));
}

Option<S> both(const std::string& key, double factor, double high, const std::string& help, double sensor::ImuErrorModel::*gyro,
               double sensor::ImuErrorModel::*accel) {
    Option<S> option = number<S>(key, factor, 0, high, help, [=](auto& s) -> auto& { return s.sim.imu.errors.*gyro; });
    option.set = [=](S& s, const Value& v) { s.sim.imu.errors.*gyro = s.sim.imu.errors.*accel = v.number() * factor; };
    option.get = [](const S&) { return std::optional<Value>(); };  // given by the two numbers it sets
    return option;
}

void add_imu(Table& table) {
    const auto errors = [](auto& s) -> auto& { return s.sim.imu.errors; };
    table.add(number<S>("imu.rate_hz", 1.0, 0.1, 1e5, "sample rate of the IMU", [](auto& s) -> auto& { return s.sim.imu.rate; }))
        .add(choice<S, ImuKind>("imu.kind", {{"increments", ImuKind::Increments}, {"rates", ImuKind::Rates}},
                                "content of the log: increments over each sample, or rates",
                                [](auto& s) -> auto& { return s.sim.imu.kind; }))
        .add(vector3<S>("imu.mounting_deg", deg, -360, 360, "roll, pitch, yaw from body to sensor",
                        [](auto& s) -> auto& { return s.sim.imu.mounting; }))
        .add(imu_grade_option<S>([](auto& s) -> auto& { return s.grade; }, errors))
        .add(both("imu.scale_factor_ppm", units::ppm, 1e6, "scale-factor error of gyros and accelerometers",
                  &sensor::ImuErrorModel::gyro_scale, &sensor::ImuErrorModel::accel_scale))
        .add(both("imu.misalignment_arcsec", units::arcsec, 1e5, "axis misalignment of gyros and accelerometers",
                  &sensor::ImuErrorModel::gyro_misalignment, &sensor::ImuErrorModel::accel_misalignment));
    add_imu_error_options(table, "imu.", errors);
    table
        .add(number<S>("imu.warm_up_k", 1.0, -100, 100, "temperature rise of the IMU above that of its calibration",
                       [](auto& s) -> auto& { return s.sim.imu.warm_up; }))
        .add(number<S>("imu.warm_up_time_s", 1.0, 1e-3, 1e6, "time constant of the warm-up",
                       [](auto& s) -> auto& { return s.sim.imu.warm_up_time; }));
}

/// Receivers by name (sensor/receivers.h).
Option<S> receiver_option() {
    OptionSpec spec = detail::spec(
        "gnss.receiver", Shape::Text,
        "errors of the receiver: autonomous (1 m white, 1.5 m slowly varying), rtk (1 cm), duostar1000 (paper A: 1 m white, "
        "5 m slowly varying), or a product by its data sheet; the numbers below refine it");
    for (const std::string_view name : sensor::gnss_receiver_names()) spec.choices.emplace_back(name);
    return {std::move(spec),
            [](S& s, const Value& v) {
                sim::GnssSettings& g = s.sim.gnss;
                s.receiver = *v.text();
                const sensor::GnssReceiver receiver = sensor::gnss_receiver(s.receiver);
                g.white_position = receiver.white_position;
                g.white_velocity = receiver.white_velocity;
                g.errors = receiver.errors;
                g.fix = receiver.fix;
            },
            [](const S& s) { return s.receiver.empty() ? std::optional<Value>() : Value{s.receiver}; }};
}

void add_receivers(Table& table) {
    const auto vector = [](Eigen::Vector3d sim::GnssSettings::*field) {
        return [=](auto& s) -> auto& { return s.sim.gnss.*field; };
    };
    const auto scalar = [](double sim::GnssSettings::*field) { return [=](auto& s) -> auto& { return s.sim.gnss.*field; }; };
    const auto mag = [](double sim::MagSettings::*field) { return [=](auto& s) -> auto& { return s.sim.mag.*field; }; };
    using M = sim::MagSettings;
    const auto baro = [](double sim::BaroSettings::*field) { return [=](auto& s) -> auto& { return s.sim.baro.*field; }; };
    using G = sim::GnssSettings;
    table.add(number<S>("gnss.rate_hz", 1.0, 0, 1000, "rate of the fixes; 0 = no receiver", scalar(&G::rate)))
        .add(receiver_option())
        .add(vector3<S>("gnss.lever_arm_m", 1.0, -100, 100, "IMU to antenna, body axes forward, right, down",
                        vector(&G::lever_arm_b)))
        .add(vector3<S>("gnss.white_m", 1.0, 0, 1e4, "white position error north, east, down", vector(&G::white_position)))
        .add(vector3<S>("gnss.white_velocity_m_s", 1.0, 0, 1e3, "white velocity error north, east, down",
                        vector(&G::white_velocity)))
        .add(number<S>("gnss.latency_s", 1.0, 0, 60, "age of the position at its stamp", scalar(&G::position_latency)))
        .add(number<S>("gnss.velocity_latency_s", 1.0, 0, 60, "age of the velocity at its stamp", scalar(&G::velocity_latency)))
        .add(number<S>("baro.rate_hz", 1.0, 0, 1000, "rate of the barometer; 0 = none", baro(&sim::BaroSettings::rate)))
        .add(number<S>("baro.white_m", 1.0, 0, 1e4, "white error of the barometric height", baro(&sim::BaroSettings::white)))
        .add(number<S>("baro.bias_m", 1.0, 0, 1e5, "constant error of the barometric height, one sigma over runs",
                       baro(&sim::BaroSettings::bias)))
        .add(number<S>("baro.bias_walk_m", 1.0, 0, 1e3, "random walk of the height error", baro(&sim::BaroSettings::bias_walk)))
        .add(flag<S>("baro.pressure", "the log has static pressures, which are converted to heights of the standard atmosphere",
                     [](auto& s) -> auto& { return s.sim.baro.pressure; }))
        .add(number<S>("baro.sea_level_pressure_pa", 1.0, 8e4, 1.2e5, "pressure at sea level",
                       baro(&sim::BaroSettings::sea_level_pressure)))
        .add(number<S>("baro.temperature_offset_k", 1.0, -60, 60, "deviation of the temperature from the standard atmosphere",
                       baro(&sim::BaroSettings::temperature_offset)))
        .add(number<S>("mag.rate_hz", 1.0, 0, 1000, "rate of the magnetometer; 0 = none", mag(&M::rate)))
        .add(number<S>("mag.field_ut", 1e-6, 1, 1000, "strength of the Earth's field", mag(&M::field)))
        .add(number<S>("mag.declination_deg", deg, -180, 180, "magnetic declination, east positive", mag(&M::declination)))
        .add(number<S>("mag.inclination_deg", deg, -89, 89, "magnetic inclination, down positive", mag(&M::inclination)))
        .add(number<S>("mag.white_ut", 1e-6, 0, 1000, "white noise of the magnetometer", mag(&M::white)))
        .add(number<S>("mag.hard_iron_ut", 1e-6, 0, 1000, "constant field of the body, one sigma over runs", mag(&M::hard_iron)))
        .add(number<S>("mag.soft_iron", 1.0, 0, 1, "distortion by the body, one sigma over runs of each coefficient",
                       mag(&M::soft_iron)));
    add_gnss_error_options(table, [](auto& s) -> auto& { return s.sim.gnss.errors; });
    table.add(constellation_change_option<S>(
        "times, from the start, at which the set of satellites changes",
        [](const S& s) { return s.sim.gnss.constellation_changes; },
        [](S& s, const std::vector<double>& times) { s.sim.gnss.constellation_changes = times; }));
}

Option<S> outage_option() {
    Option<Config> source = *config_table().find("outage");
    Option<S> option{source.spec,
                     [](S& s, const Value& v) {
                         ValueList gnss;
                         s.sim.outages.clear();
                         for (const Value& item : *v.list()) {
                             ValueTable table = *item.table();
                             const auto sensor = std::ranges::find_if(table, [](const auto& e) { return e.first == "sensor"; });
                             const bool baro =
                                 sensor != table.end() && sensor->second.text() != nullptr && *sensor->second.text() == "baro";
                             if (baro) sensor->second = Value{std::string("gnss")};
                             const auto span = outages_from_tables({Value{table}});
                             if (baro) s.sim.outages.push_back({span.front().start, span.front().duration, sim::Channel::Baro});
                             if (!baro) gnss.push_back(Value{std::move(table)});
                         }
                         s.outages = outages_from_tables(gnss);
                     },
                     [](const S&) { return std::optional<Value>(); }};
    option.spec.help = "spans without a sensor: [[outage]] with start_s, duration_s, sensor = \"gnss\" or \"baro\"";
    return option;
}

void add_filter(Table& table) {
    table.add(of_processing(*config_table().find("run.settle_s")));
    for (const OptionSpec& spec : config_table().specs()) {
        if (spec.key.starts_with("filter.")) table.add(of_processing(*config_table().find(spec.key)));
        if (spec.key.starts_with("imu.gyro_") || spec.key.starts_with("imu.accel_")) {
            Option<S> option;
            option.spec = spec;
            option.spec.key = "filter.assumed." + spec.key.substr(4);
            option.spec.help = "value that the filter assumes instead of the simulated one: " + spec.help;
            option.set = [key = spec.key](S& s, const Value& v) { s.assumed.push_back({key, v, {}}); };
            option.get = [key = spec.key](const S& s) -> std::optional<Value> {
                const auto it = std::ranges::find(s.assumed, key, &Setting::key);
                return it == s.assumed.end() ? std::nullopt : std::optional<Value>(it->value);
            };
            table.add(std::move(option));
        }
    }
    const auto error = [](double InitialError::*field) { return [=](auto& s) -> auto& { return s.initial_error.*field; }; };
    table
        .add(number<S>("filter.initial_error.level_deg", deg, 0, 90,
                       "error of the initial roll and pitch, one sigma; without it the filter aligns itself",
                       error(&InitialError::level)))
        .add(number<S>("filter.initial_error.heading_deg", deg, 0, 180, "error of the initial heading, one sigma",
                       error(&InitialError::heading)))
        .add(number<S>("filter.initial_error.velocity_m_s", 1.0, 0, 1e3, "error of the initial velocity, one sigma",
                       error(&InitialError::velocity)))
        .add(number<S>("filter.initial_error.position_m", 1.0, 0, 1e6, "error of the initial position, one sigma",
                       error(&InitialError::position)));
}

void add_published(Table& table) {
    table.add(text<S>("published.source",
                      "source of published root mean squares of this scenario, to compare with those of a run",
                      [](auto& s) -> auto& { return s.published.source; }));
    const struct {
        const char* name;
        double factor;
        const char* help;
    } rows[published_blocks] = {{"position_m", 1.0, "published position errors east, north, up"},
                                {"velocity_m_s", 1.0, "published velocity errors east, north, up"},
                                {"attitude_rad", 1.0, "published attitude errors about east, north, up"},
                                {"gyro_bias_rad_s", 1.0, "published errors of the gyro biases x, y, z"},
                                {"accel_bias_ug", units::ug, "published errors of the accelerometer biases x, y, z"}};
    for (std::size_t b = 0; b < published_blocks; ++b)
        table.add(vector3<S>(std::string("published.") + rows[b].name, rows[b].factor, 0, 1e9, rows[b].help,
                             [b](auto& s) -> auto& { return s.published.rms[b]; }));
}

Table make_table() {
    Table table;
    add_general(table);
    add_trajectory_options(table);
    add_survey_options(table);
    add_imu(table);
    add_receivers(table);
    add_instrument_scenario_options(table);
    add_ranging_scenario_options(table);
    add_receiver_scenario_options(table);
    table.add(outage_option()).add(fault_option());
    add_filter(table);
    add_montecarlo_options(table);
    add_published(table);
    add_compare_options(table);
    for (const OptionSpec& spec : config_table().specs())
        if (spec.key.starts_with("gravity.")) table.add(of_processing(*config_table().find(spec.key)));
    table.add(
        {anomaly_spec("disturbance of gravity along the path: [[anomaly]] with kind, size_mgal = [east, north, up], start and "
                      "length in _m or _s"),
         [](S& s, const Value& v) { s.sim.anomaly = anomalies_from(*v.list()); },
         [](const S& s) { return value_of(s.sim.anomaly); }});
    table.edit_specs([](OptionSpec& spec) {
        if (const std::string_view condition = condition_in_scenario(spec.key); !condition.empty()) spec.applies = condition;
    });
    return table;
}

}  // namespace

const OptionTable<ScenarioConfig>& scenario_table() {
    static const Table table = make_table();
    return table;
}

ScenarioConfig scenario_from(const SettingList& settings) {
    ScenarioConfig s;
    s.sim.imu.errors = sensor::imu_grade(s.grade);
    scenario_table().apply(settings, s);
    for (const Setting& setting : settings) s.given.insert(setting.key);
    if (!s.receiver.empty() && !s.given.contains("gnss.rate_hz"))
        if (const double rate = sensor::gnss_receiver(s.receiver).rate; rate > 0.0) s.sim.gnss.rate = rate;
    for (const Setting& setting : settings)
        if (s.folder.empty() && setting.place.line > 0) s.folder = std::filesystem::path(setting.place.file).parent_path();
    s.processing.filter.vehicle = s.vehicle.value_or(vehicle_of(s.type));
    s.sim.earth = s.processing.filter.earth;
    with_places(settings, [&s] {
        s.sim.path = path_of(s);
        const auto path = sim::make_path(s.sim.path, s.sim.earth.ellipsoid);
        sim::require_above_ground(*path, s.sim.duration, s.ground.value_or(ground_of(s)));
        s.sim.anomaly_field = field_of(s);
        check_gravity(s.processing.gravity);
        if (s.receiver_channels.rate > 0.0) check_receiver(s);
    });
    return s;
}

SettingList scenario_settings(const std::filesystem::path& file, std::optional<std::uint64_t> seed) {
    SettingList settings = scenario_table().read(read_toml(file), file.string());
    if (std::ranges::find(settings, "name", &Setting::key) == settings.end())
        settings.push_back({"name", {file.stem().string()}, {}});
    if (seed) settings.push_back({"seed", {static_cast<std::int64_t>(*seed)}, {"--seed", 0, 0, {}}});
    return settings;
}

ScenarioConfig read_scenario(const std::filesystem::path& file, std::optional<std::uint64_t> seed) {
    return scenario_from(scenario_settings(file, seed));
}

std::set<std::string> keys_of_processing(const ScenarioConfig& scenario, const SettingList& above) {
    std::set<std::string> keys;
    std::ranges::copy_if(scenario.given, std::inserter(keys, keys.end()), [](const std::string& key) {
        return key.starts_with("filter.") && !key.starts_with("filter.assumed.") && !key.starts_with("filter.initial_error");
    });
    for (const Setting& s : above) keys.insert(s.key);
    return keys;
}

}  // namespace schuler::settings
