#include "schuler/app/scenario.h"

#include "schuler/app/config_gravity.h"
#include "schuler/app/imu_error_options.h"
#include "schuler/app/option_builders.h"
#include "schuler/app/toml_file.h"
#include "schuler/core/units.h"

#include <algorithm>

namespace schuler::app {
namespace {

using Table = OptionTable<ScenarioConfig>;
using S = ScenarioConfig;
constexpr double deg = units::deg;

/// An option of dataset.toml under the same key: it acts on `processing`.
Option<S> of_processing(const Option<Config>& option) {
    return {option.spec, [set = option.set](S& s, const Value& v) { set(s.processing, v); },
            [get = option.get](const S& s) { return get(s.processing); }};
}

void add_general(Table& table) {
    table.add(text<S>("name", "name of the scenario and of its output folder", [](auto& s) -> auto& { return s.name; }))
        .add(integer<S>("seed", 0, 9.0e15, "of the random numbers", [](auto& s) -> auto& { return s.sim.seed; }))
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

void add_start(Table& table) {
    const struct {
        const char* name;
        double factor, low, high;
        double Geodetic::*field;
    } rows[] = {{"lat_deg", deg, -89, 89, &Geodetic::lat},
                {"lon_deg", deg, -360, 360, &Geodetic::lon},
                {"height_m", 1, -1000, 100000, &Geodetic::h}};
    for (const auto& r : rows) {
        Option<S> option = number<S>(std::string("trajectory.start.") + r.name, r.factor, r.low, r.high, "where the path starts",
                                     [field = r.field](auto& s) -> auto& { return s.start.*field; });
        option.set = [set = option.set](S& s, const Value& v) {
            set(s, v);
            s.start_given = true;
        };
        table.add(std::move(option));
    }
}

void add_paper_a(Table& table) {
    const struct {
        std::string name;
        sim::Oscillation sim::PaperAPath::*field;
        const char* rate;
        const char* amplitude;
    } rows[] = {{"lat", &sim::PaperAPath::lat, "_rate_rad_s", "_amplitude_rad"},
                {"lon", &sim::PaperAPath::lon, "_rate_rad_s", "_amplitude_rad"},
                {"height", &sim::PaperAPath::height, "_rate_m_s", "_amplitude_m"}};
    for (const auto& r : rows) {
        const auto access = [field = r.field](double sim::Oscillation::*part) {
            return [=](auto& s) -> auto& { return (s.paper_a.*field).*part; };
        };
        table
            .add(number<S>("trajectory." + r.name + r.rate, 1.0, -1e3, 1e3, "paper_a: constant rate",
                           access(&sim::Oscillation::rate)))
            .add(number<S>("trajectory." + r.name + r.amplitude, 1.0, -1e5, 1e5, "paper_a: amplitude of the oscillation",
                           access(&sim::Oscillation::amplitude)))
            .add(number<S>("trajectory." + r.name + "_phase_deg", deg, -360, 360, "paper_a: its phase",
                           access(&sim::Oscillation::phase)));
    }
    table
        .add(vector3<S>("trajectory.period_s", 1.0, 0.1, 1e7, "paper_a: periods of latitude, longitude, height",
                        [](auto& s) -> auto& { return s.periods; }))
        .add(number<S>("trajectory.roll_per_accel", 1.0, -1, 1, "paper_a: K of (4.2.5), rad/(m/s2)",
                       [](auto& s) -> auto& { return s.paper_a.roll_per_accel; }));
}

sim::Waypoint waypoint_of(const Value& v) {
    sim::Waypoint w;
    const auto bad = [&](const std::string& what) {
        return input_error(what, {}, "write waypoints = [ { north_m = 100, east_m = 0, speed_m_s = 10, stop_s = 5 }, ... ]");
    };
    if (v.table() == nullptr) throw bad("a waypoint is not a table");
    for (const auto& [name, x] : *v.table()) {
        if (!x.is_number() || !(std::abs(x.number()) < 1e7)) throw bad(fmt::format("{} = {} is not a number", name, to_toml(x)));
        double* field = name == "north_m"     ? &w.north
                        : name == "east_m"    ? &w.east
                        : name == "up_m"      ? &w.up
                        : name == "speed_m_s" ? &w.speed
                        : name == "stop_s"    ? &w.stop
                                              : nullptr;
        if (field == nullptr) throw bad(fmt::format("a waypoint has no \"{}\"", name));
        *field = x.number();
    }
    return w;
}

Option<S> waypoints_option() {
    return special<S>(
        "trajectory.waypoints", "[ { north_m, east_m, up_m, speed_m_s, stop_s }, ... ]",
        "waypoints: corners in metres from the start",
        [](S& s, const Value& v) {
            s.route.waypoints.clear();
            if (v.list() == nullptr)
                throw input_error(fmt::format("is {}, expected a list", kind_of(v)), {},
                                  "write waypoints = [ { north_m = 100, east_m = 0 }, ... ]");
            for (const Value& item : *v.list()) s.route.waypoints.push_back(waypoint_of(item));
        },
        [](const S& s) -> std::optional<Value> {
            if (s.route.waypoints.empty()) return std::nullopt;
            ValueList list;
            for (const sim::Waypoint& w : s.route.waypoints) {
                list.push_back({ValueTable{{"north_m", {w.north}},
                                           {"east_m", {w.east}},
                                           {"up_m", {w.up}},
                                           {"speed_m_s", {w.speed}},
                                           {"stop_s", {w.stop}}}});
            }
            return Value{std::move(list)};
        });
}

void add_trajectory(Table& table) {
    table.add(choice<S, TrajectoryType>(
        "trajectory.type",
        {{"static", TrajectoryType::Static},
         {"great_circle", TrajectoryType::GreatCircle},
         {"paper_a", TrajectoryType::PaperA},
         {"car", TrajectoryType::Car},
         {"waypoints", TrajectoryType::Waypoints}},
        "static, great_circle (constant height and speed), paper_a (its flight), car (a town drive), waypoints",
        [](auto& s) -> auto& { return s.type; }));
    add_start(table);
    table
        .add(vector3<S>("trajectory.attitude_deg", deg, -360, 360, "static: roll, pitch, heading",
                        [](auto& s) -> auto& { return s.attitude; }))
        .add(number<S>("trajectory.heading_deg", deg, -360, 360, "great_circle: heading at the start",
                       [](auto& s) -> auto& { return s.great_circle.heading; }))
        .add(number<S>("trajectory.speed_m_s", 1.0, 0, 1e4, "great_circle: speed",
                       [](auto& s) -> auto& { return s.great_circle.speed; }));
    add_paper_a(table);
    const auto route = [](double sim::RoutePath::*field) { return [=](auto& s) -> auto& { return s.route.*field; }; };
    const auto vibration = [](double sim::Vibration::*field) {
        return [=](auto& s) -> auto& { return s.route.vibration.*field; };
    };
    using R = sim::RoutePath;
    table.add(waypoints_option())
        .add(number<S>("trajectory.standstill_s", 1.0, 0, 1e6, "car, waypoints: at rest before the start", route(&R::standstill)))
        .add(number<S>("trajectory.corner_radius_m", 1.0, 0.1, 1e6, "car, waypoints: radius of the corners",
                       route(&R::corner_radius)))
        .add(number<S>("trajectory.lateral_accel_m_s2", 1.0, 0.01, 100, "car, waypoints: limit in corners",
                       route(&R::lateral_accel)))
        .add(number<S>("trajectory.longitudinal_accel_m_s2", 1.0, 0.01, 100, "car, waypoints: limit when speeding up and braking",
                       route(&R::longitudinal_accel)))
        .add(number<S>("trajectory.roll_per_lateral_accel", 1.0, -1, 1, "car, waypoints: rad/(m/s2)",
                       route(&R::roll_per_lateral_accel)))
        .add(number<S>("trajectory.pitch_per_accel", 1.0, -1, 1, "car, waypoints: rad/(m/s2)", route(&R::pitch_per_accel)))
        .add(number<S>("trajectory.vibration.frequency_hz", 1.0, 0.01, 1e4, "car, waypoints: frequency of the suspension",
                       vibration(&sim::Vibration::frequency)))
        .add(number<S>("trajectory.vibration.angle_deg", deg, 0, 20, "amplitude of roll and pitch",
                       vibration(&sim::Vibration::angle)))
        .add(number<S>("trajectory.vibration.accel_m_s2", 1.0, 0, 100, "amplitude of the vertical acceleration",
                       vibration(&sim::Vibration::accel)));
}

Option<S> both(const std::string& key, double factor, double high, const std::string& help, double sensor::ImuErrorModel::*gyro,
               double sensor::ImuErrorModel::*accel) {
    Option<S> option = number<S>(key, factor, 0, high, help, [=](auto& s) -> auto& { return s.sim.imu.errors.*gyro; });
    option.set = [=](S& s, const Value& v) { s.sim.imu.errors.*gyro = s.sim.imu.errors.*accel = v.number() * factor; };
    option.get = [](const S&) { return std::optional<Value>(); };  // told by the two numbers it sets
    return option;
}

void add_imu(Table& table) {
    const auto errors = [](auto& s) -> auto& { return s.sim.imu.errors; };
    table.add(number<S>("imu.rate_hz", 1.0, 0.1, 1e5, "sample rate", [](auto& s) -> auto& { return s.sim.imu.rate; }))
        .add(choice<S, ImuKind>("imu.kind", {{"increments", ImuKind::Increments}, {"rates", ImuKind::Rates}},
                                "what the log carries", [](auto& s) -> auto& { return s.sim.imu.kind; }))
        .add(vector3<S>("imu.mounting_deg", deg, -360, 360, "roll, pitch, yaw from body to sensor",
                        [](auto& s) -> auto& { return s.sim.imu.mounting; }))
        .add(imu_grade_option<S>([](auto& s) -> auto& { return s.grade; }, errors))
        .add(both("imu.scale_factor_ppm", units::ppm, 1e6, "scale-factor error of gyros and accelerometers",
                  &sensor::ImuErrorModel::gyro_scale, &sensor::ImuErrorModel::accel_scale))
        .add(both("imu.misalignment_arcsec", units::arcsec, 1e5, "axis misalignment of gyros and accelerometers",
                  &sensor::ImuErrorModel::gyro_misalignment, &sensor::ImuErrorModel::accel_misalignment));
    add_imu_error_options(table, "imu.", errors);
}

/// Receivers by name: sigmas of (3.2.1) and (3.2.2) as used for a code-phase and a carrier-phase receiver.
Option<S> receiver_option() {
    OptionSpec spec = detail::spec("gnss.receiver", Shape::Text,
                                   "autonomous (1 m white, 1.5 m slowly varying) or rtk (1 cm); the numbers below refine it");
    spec.choices = {"autonomous", "rtk"};
    return {std::move(spec),
            [](S& s, const Value& v) {
                sim::GnssSettings& g = s.sim.gnss;
                s.receiver = *v.text();
                const bool rtk = s.receiver == "rtk";
                g.white_position = rtk ? Eigen::Vector3d(0.01, 0.01, 0.02) : Eigen::Vector3d(1.0, 1.0, 2.0);
                g.correlated_position = rtk ? Eigen::Vector3d::Zero() : Eigen::Vector3d(1.5, 1.5, 3.0);
                g.white_velocity = rtk ? Eigen::Vector3d(0.03, 0.03, 0.05) : Eigen::Vector3d(0.05, 0.05, 0.1);
                g.fix = rtk ? FixType::RtkFixed : FixType::Autonomous;
            },
            [](const S& s) { return s.receiver.empty() ? std::optional<Value>() : Value{s.receiver}; }};
}

void add_receivers(Table& table) {
    const auto vector = [](Eigen::Vector3d sim::GnssSettings::*field) {
        return [=](auto& s) -> auto& { return s.sim.gnss.*field; };
    };
    const auto scalar = [](double sim::GnssSettings::*field) { return [=](auto& s) -> auto& { return s.sim.gnss.*field; }; };
    const auto baro = [](double sim::BaroSettings::*field) { return [=](auto& s) -> auto& { return s.sim.baro.*field; }; };
    using G = sim::GnssSettings;
    table.add(number<S>("gnss.rate_hz", 1.0, 0, 1000, "rate of the fixes; 0 = no receiver", scalar(&G::rate)))
        .add(receiver_option())
        .add(vector3<S>("gnss.lever_arm_m", 1.0, -100, 100, "IMU to antenna, body axes forward, right, down",
                        vector(&G::lever_arm_b)))
        .add(vector3<S>("gnss.white_m", 1.0, 0, 1e4, "white position error north, east, down", vector(&G::white_position)))
        .add(vector3<S>("gnss.correlated_m", 1.0, 0, 1e4, "slowly varying position error", vector(&G::correlated_position)))
        .add(vector3<S>("gnss.white_velocity_m_s", 1.0, 0, 1e3, "white velocity error", vector(&G::white_velocity)))
        .add(vector3<S>("gnss.correlated_velocity_m_s", 1.0, 0, 1e3, "slowly varying velocity error",
                        vector(&G::correlated_velocity)))
        .add(number<S>("gnss.correlated_time_s", 1.0, 1e-2, 1e15, "correlation time of both", scalar(&G::correlated_time)))
        .add(number<S>("gnss.latency_s", 1.0, 0, 60, "age of the position at its stamp", scalar(&G::position_latency)))
        .add(number<S>("gnss.velocity_latency_s", 1.0, 0, 60, "age of the velocity at its stamp", scalar(&G::velocity_latency)))
        .add(number<S>("baro.rate_hz", 1.0, 0, 1000, "rate of the barometer; 0 = none", baro(&sim::BaroSettings::rate)))
        .add(number<S>("baro.white_m", 1.0, 0, 1e4, "white height error", baro(&sim::BaroSettings::white)))
        .add(number<S>("baro.bias_m", 1.0, 0, 1e5, "constant height error, one sigma over runs", baro(&sim::BaroSettings::bias)))
        .add(number<S>("baro.bias_walk_m", 1.0, 0, 1e3, "its random walk, m in a root second",
                       baro(&sim::BaroSettings::bias_walk)));
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
    for (const OptionSpec& spec : config_table().specs()) {
        if (spec.key.starts_with("filter.")) table.add(of_processing(*config_table().find(spec.key)));
        if (spec.key.starts_with("imu.gyro_") || spec.key.starts_with("imu.accel_")) {
            Option<S> option;
            option.spec = spec;
            option.spec.key = "filter.assumed." + spec.key.substr(4);
            option.spec.help = "the filter is told this instead of what is simulated: " + spec.help;
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
                       "error of the initial roll and pitch, one sigma; without it the filter starts by itself",
                       error(&InitialError::level)))
        .add(number<S>("filter.initial_error.heading_deg", deg, 0, 180, "error of the initial heading, one sigma",
                       error(&InitialError::heading)))
        .add(number<S>("filter.initial_error.velocity_m_s", 1.0, 0, 1e3, "error of the initial velocity, one sigma",
                       error(&InitialError::velocity)))
        .add(number<S>("filter.initial_error.position_m", 1.0, 0, 1e6, "error of the initial position, one sigma",
                       error(&InitialError::position)));
}

Table make_table() {
    Table table;
    add_general(table);
    add_trajectory(table);
    add_imu(table);
    add_receivers(table);
    table.add(outage_option());
    add_filter(table);
    for (const OptionSpec& spec : config_table().specs())
        if (spec.key.starts_with("gravity.")) table.add(of_processing(*config_table().find(spec.key)));
    table.add({anomaly_spec("disturbance of gravity along the path: [[anomaly]] with kind, size_mgal = [east, north, up], start and "
                            "length in _m or _s"),
               [](S& s, const Value& v) { s.sim.anomaly = anomalies_from(*v.list()); },
               [](const S& s) { return value_of(s.sim.anomaly); }});
    return table;
}

sim::PathSettings path_of(const ScenarioConfig& s) {
    switch (s.type) {
        case TrajectoryType::Static: return sim::StaticPath{s.start, s.attitude};
        case TrajectoryType::GreatCircle: {
            sim::GreatCirclePath path = s.great_circle;
            path.start = s.start;
            return path;
        }
        case TrajectoryType::PaperA: {
            sim::PaperAPath path = s.paper_a;
            if (s.start_given) path.start = s.start;
            path.lat.period = s.periods[0];
            path.lon.period = s.periods[1];
            path.height.period = s.periods[2];
            return path;
        }
        case TrajectoryType::Waypoints: {
            sim::RoutePath path = s.route;
            path.start = s.start;
            return path;
        }
        case TrajectoryType::Car: break;
    }
    // the drive is as long as the scenario; what the user set about it stays
    sim::RoutePath path = sim::town_route(s.start, s.sim.duration, s.sim.seed);
    const std::vector<sim::Waypoint> waypoints = path.waypoints;
    path = s.route;
    path.start = s.start;
    path.waypoints = waypoints;
    return path;
}

fusion::VehicleKind vehicle_of(TrajectoryType type) {
    switch (type) {
        case TrajectoryType::Static: return fusion::VehicleKind::Static;
        case TrajectoryType::GreatCircle:
        case TrajectoryType::PaperA: return fusion::VehicleKind::Air;
        default: return fusion::VehicleKind::Car;
    }
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
    if (s.type == TrajectoryType::Waypoints && s.route.waypoints.empty()) {
        throw input_error("no waypoints", {settings.empty() ? "" : settings.front().place.file, 0, 0, "trajectory.waypoints"},
                          "give at least one");
    }
    s.processing.filter.vehicle = s.vehicle.value_or(vehicle_of(s.type));
    s.sim.earth = s.processing.filter.earth;
    s.sim.path = path_of(s);
    return s;
}

ScenarioConfig read_scenario(const std::filesystem::path& file, std::optional<std::uint64_t> seed) {
    SettingList settings = scenario_table().read(read_toml(file), file.string());
    if (std::ranges::find(settings, "name", &Setting::key) == settings.end())
        settings.push_back({"name", {file.stem().string()}, {}});
    if (seed) settings.push_back({"seed", {static_cast<std::int64_t>(*seed)}, {"--seed", 0, 0, {}}});
    return scenario_from(settings);
}

}  // namespace schuler::app
