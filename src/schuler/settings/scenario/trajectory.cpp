// The trajectories of scenario files: their keys, and the corresponding paths.
#include "schuler/core/units.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/settings/option_builders.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/scenario/sections.h"
#include "schuler/sim/weave.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::settings {
namespace {

using Table = OptionTable<ScenarioConfig>;
using S = ScenarioConfig;
using units::deg;

void add_start(Table& table) {
    const struct {
        const char* name;
        double factor, low, high;
        const char* help;
        double Geodetic::*field;
    } rows[] = {{"lat_deg", deg, -89, 89, "latitude at the start", &Geodetic::lat},
                {"lon_deg", deg, -360, 360, "longitude at the start", &Geodetic::lon},
                {"height_m", 1, -1000, 100000, "ellipsoidal height at the start", &Geodetic::h}};
    for (const auto& r : rows) {
        Option<S> option = number<S>(std::string("trajectory.start.") + r.name, r.factor, r.low, r.high, r.help,
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
        std::string name, quantity;
        sim::Oscillation sim::PaperAPath::*field;
        const char* rate;
        const char* amplitude;
    } rows[] = {{"lat", "latitude", &sim::PaperAPath::lat, "_rate_rad_s", "_amplitude_rad"},
                {"lon", "longitude", &sim::PaperAPath::lon, "_rate_rad_s", "_amplitude_rad"},
                {"height", "height", &sim::PaperAPath::height, "_rate_m_s", "_amplitude_m"}};
    for (const auto& r : rows) {
        const auto access = [field = r.field](double sim::Oscillation::*part) {
            return [=](auto& s) -> auto& { return (s.paper_a.*field).*part; };
        };
        table
            .add(number<S>("trajectory." + r.name + r.rate, 1.0, -1e3, 1e3, "constant rate of the " + r.quantity,
                           access(&sim::Oscillation::rate)))
            .add(number<S>("trajectory." + r.name + r.amplitude, 1.0, -1e5, 1e5,
                           "amplitude of the oscillation of the " + r.quantity, access(&sim::Oscillation::amplitude)))
            .add(number<S>("trajectory." + r.name + "_phase_deg", deg, -360, 360, "phase of the oscillation of the " + r.quantity,
                           access(&sim::Oscillation::phase)));
    }
    table
        .add(vector3<S>("trajectory.period_s", 1.0, 0.1, 1e7, "periods of latitude, longitude, height",
                        [](auto& s) -> auto& { return s.periods; }))
        .add(number<S>("trajectory.roll_per_accel", 1.0, -1, 1, "roll per lateral acceleration, K of (4.2.5)",
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
        "trajectory.waypoints", "[ { north_m, east_m, up_m, speed_m_s, stop_s }, ... ]", "corners in metres from the start",
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

Option<S> moves_option() {
    return special<S>(
        "trajectory.moves", "[ { roll_deg, pitch_deg, heading_deg, duration_s, dwell_s }, ... ]", "sequence of turns",
        [](S& s, const Value& v) {
            const auto bad = [](const std::string& what) {
                return input_error(what, {}, "write moves = [ { heading_deg = 90, duration_s = 10, dwell_s = 60 }, ... ]");
            };
            if (v.list() == nullptr) throw bad(fmt::format("is {}, expected a list", kind_of(v)));
            s.table.moves.clear();
            for (const Value& item : *v.list()) {
                if (item.table() == nullptr) throw bad("a move is not a table");
                sim::TableMove m;
                for (const auto& [name, x] : *item.table()) {
                    if (!x.is_number() || !(std::abs(x.number()) < 1e6))
                        throw bad(fmt::format("{} = {} is not a number", name, to_toml(x)));
                    if (name == "roll_deg") m.turn.x() = x.number() * deg;
                    else if (name == "pitch_deg") m.turn.y() = x.number() * deg;
                    else if (name == "heading_deg") m.turn.z() = x.number() * deg;
                    else if (name == "duration_s") m.duration = x.number();
                    else if (name == "dwell_s") m.dwell = x.number();
                    else throw bad(fmt::format("a move has no \"{}\"", name));
                }
                s.table.moves.push_back(m);
            }
        },
        [](const S&) { return std::optional<Value>(); });
}

void add_motions(Table& table) {
    table.add(moves_option())
        .add(text<S>("trajectory.file", "a trajectory: reference.csv, a solution, ten columns; relative to the scenario",
                     [](auto& s) -> auto& { return s.file; }))
        .add(number<S>("trajectory.smoothing_s", 1.0, 1e-3, 100, "interval of the points that are kept",
                       [](auto& s) -> auto& { return s.recorded.spacing; }))
        .add(number<S>("trajectory.height_change_m", 1.0, 1, 2e4, "height climbed or descended",
                       [](auto& s) -> auto& { return s.phase.height_change; }))
        .add(number<S>("trajectory.length_m", 1.0, 1, 1e6, "long axis", [](auto& s) -> auto& { return s.figure8.length; }))
        .add(number<S>("trajectory.width_m", 1.0, 1, 1e6, "short axis", [](auto& s) -> auto& { return s.figure8.width; }))
        .add(number<S>("trajectory.loop_height_m", 1.0, 0, 1e4, "height of one loop above and of the other below the start",
                       [](auto& s) -> auto& { return s.figure8.height_amplitude; }))
        .add(number<S>("trajectory.figure_s", 1.0, 1, 1e5, "time of one figure",
                       [](auto& s) -> auto& { return s.figure8.period; }));
    const struct {
        const char* name;
        const char* unit;
        double factor;
        sim::Wave sim::ShipPath::*wave;
    } waves[] = {{"roll", "_deg", deg, &sim::ShipPath::roll},
                 {"pitch", "_deg", deg, &sim::ShipPath::pitch},
                 {"yaw", "_deg", deg, &sim::ShipPath::yaw},
                 {"heave", "_m", 1.0, &sim::ShipPath::heave}};
    for (const auto& w : waves) {
        const std::string key = fmt::format("trajectory.waves.{}", w.name);
        const auto part = [wave = w.wave](double sim::Wave::*field) {
            return [=](auto& s) -> auto& { return s.ship.*wave.*field; };
        };
        table.add(number<S>(key + w.unit, w.factor, 0, 60, fmt::format("amplitude of {}", w.name), part(&sim::Wave::amplitude)))
            .add(number<S>(key + "_period_s", 1.0, 0.1, 1e4, fmt::format("period of {}", w.name), part(&sim::Wave::period)));
    }
}

}  // namespace

void add_trajectory_options(Table& table) {
    table.add(choice<S, TrajectoryType>("trajectory.type",
                                        {{"static", TrajectoryType::Static},
                                         {"great_circle", TrajectoryType::GreatCircle},
                                         {"paper_a", TrajectoryType::PaperA},
                                         {"car", TrajectoryType::Car},
                                         {"waypoints", TrajectoryType::Waypoints},
                                         {"takeoff", TrajectoryType::Takeoff},
                                         {"racetrack", TrajectoryType::Racetrack},
                                         {"approach", TrajectoryType::Approach},
                                         {"figure8", TrajectoryType::Figure8},
                                         {"ship", TrajectoryType::Ship},
                                         {"table", TrajectoryType::Table},
                                         {"file", TrajectoryType::File},
                                         {"weave", TrajectoryType::Weave},
                                         {"survey", TrajectoryType::Survey}},
                                        "static, great_circle (constant height and speed), paper_a (its flight), car (a town "
                                        "drive), waypoints, takeoff (and climb), racetrack "
                                        "(holding pattern), approach (and landing), figure8, ship (in waves), table (turntable), "
                                        "file (a recorded trajectory), weave "
                                        "(straight legs with alternating turns), survey (parallel lines and tie lines)",
                                        [](auto& s) -> auto& { return s.type; }));
    add_start(table);
    table
        .add(vector3<S>("trajectory.attitude_deg", deg, -360, 360, "roll, pitch, heading",
                        [](auto& s) -> auto& { return s.attitude; }))
        .add(number<S>("trajectory.heading_deg", deg, -360, 360, "heading at the start",
                       [](auto& s) -> auto& { return s.heading; }))
        .add(number<S>("trajectory.speed_m_s", 1.0, 0, 1e4, "speed; default: 200, 130, 6, 60",
                       [](auto& s) -> auto& { return s.speed; }))
        .add(number<S>("trajectory.ground_height_m", 1.0, -1e4, 1e5,
                       "lowest height of a path; default: 0 for aircraft, the start of a take-off, -500 otherwise",
                       [](auto& s) -> auto& { return s.ground; }));
    add_paper_a(table);
    add_motions(table);
    const auto route = [](double sim::RoutePath::*field) { return [=](auto& s) -> auto& { return s.route.*field; }; };
    const auto vibration = [](double sim::Vibration::*field) {
        return [=](auto& s) -> auto& { return s.route.vibration.*field; };
    };
    using R = sim::RoutePath;
    Option<S> standstill = number<S>("trajectory.standstill_s", 1.0, 0, 1e6, "time at rest before the start; default: 30, 30, 0",
                                     route(&R::standstill));
    standstill.set = [set = standstill.set](S& s, const Value& v) {
        set(s, v);
        s.standstill_given = true;
    };
    table.add(waypoints_option())
        .add(std::move(standstill))
        .add(number<S>("trajectory.start_speed_m_s", 1.0, 0, 1e3, "initial speed", route(&R::start_speed)))
        .add(number<S>("trajectory.knot_spacing_m", 1.0, 0.5, 1e4,
                       "length over which bends and climbs are smoothed; aircraft: 50", route(&R::knot_spacing)))
        .add(number<S>("trajectory.corner_radius_m", 1.0, 0.1, 1e6, "radius of the corners", route(&R::corner_radius)))
        .add(number<S>("trajectory.lateral_accel_m_s2", 1.0, 0.01, 1000, "largest lateral acceleration in corners",
                       route(&R::lateral_accel)))
        .add(number<S>("trajectory.longitudinal_accel_m_s2", 1.0, 0.01, 100, "largest acceleration and deceleration",
                       route(&R::longitudinal_accel)))
        .add(number<S>("trajectory.roll_per_lateral_accel", 1.0, -1, 1, "roll per lateral acceleration",
                       route(&R::roll_per_lateral_accel)))
        .add(number<S>("trajectory.pitch_per_accel", 1.0, -1, 1, "pitch per longitudinal acceleration",
                       route(&R::pitch_per_accel)))
        .add(number<S>("trajectory.vibration.frequency_hz", 1.0, 0.01, 1e4, "frequency of the suspension",
                       vibration(&sim::Vibration::frequency)))
        .add(number<S>("trajectory.vibration.angle_deg", deg, 0, 20, "amplitude of roll and pitch of the suspension",
                       vibration(&sim::Vibration::angle)))
        .add(number<S>("trajectory.vibration.accel_m_s2", 1.0, 0, 100, "amplitude of the vertical acceleration of the suspension",
                       vibration(&sim::Vibration::accel)));
}

namespace {

/// A path with the start, heading and speed of the scenario, as far as applicable; standstill and duration if required.
template <class Path>
Path led(Path path, const ScenarioConfig& s) {
    path.start = s.start;
    path.heading = s.heading;
    if constexpr (requires { path.speed; }) path.speed = s.speed.value_or(path.speed);
    if constexpr (requires { path.duration; }) path.duration = s.sim.duration;
    return path;
}

sim::FlightPhase phase_of(const ScenarioConfig& s) {
    sim::FlightPhase phase = led(s.phase, s);
    phase.standstill = s.route.standstill;
    return phase;
}

sim::RoutePath survey_of(const ScenarioConfig& s) {
    sim::SurveyPattern pattern = led(s.survey, s);
    pattern.standstill = s.standstill_given ? s.route.standstill : 0.0;
    sim::RoutePath route = sim::survey_route(pattern);
    route.vibration = s.route.vibration;
    route.drape = drape_of(s, pattern.speed);
    return route;
}

sim::RecordedPath recorded_path(const ScenarioConfig& s) {
    const auto bad = [](std::string what, const char* key, const char* hint) {
        return input_error(std::move(what), {.file = {}, .line = 0, .column = 0, .key = key}, hint);
    };
    if (s.file.empty()) throw bad("no trajectory to replay", "trajectory.file", "name it: file = \"reference.csv\"");
    WarningLog unheard;
    const std::filesystem::path file(s.file);
    const std::vector<SolutionRow> rows = dataset::read_trajectory(file.is_absolute() ? file : s.folder / file, unheard).rows;
    sim::RecordedPath path = s.recorded;
    for (const SolutionRow& row : rows) path.points.push_back({(row.time - rows.front().time).seconds(), row.position, row.rpy});
    const double lasts = path.points.empty() ? 0.0 : path.points.back().time;
    if (lasts < s.sim.duration)
        throw bad(fmt::format("the trajectory lasts {:.1f} s, less than the scenario", lasts), "duration_s",
                  "shorten the scenario");
    return path;
}

}  // namespace

sim::PathSettings path_of(const ScenarioConfig& s) {
    switch (s.type) {
        case TrajectoryType::Static: return sim::StaticPath{s.start, s.attitude};
        case TrajectoryType::GreatCircle: return led(s.great_circle, s);
        case TrajectoryType::PaperA: {
            sim::PaperAPath path = s.paper_a;
            if (s.start_given) path.start = s.start;
            path.lat.period = s.periods[0];
            path.lon.period = s.periods[1];
            path.height.period = s.periods[2];
            return path;
        }
        case TrajectoryType::Waypoints: {
            if (s.route.waypoints.empty())
                throw input_error("no waypoints", {.file = {}, .line = 0, .column = 0, .key = "trajectory.waypoints"},
                                  "give at least one");
            sim::RoutePath path = s.route;
            if (path.start_speed > 0.0) path.standstill = 0.0;
            path.start = s.start;
            path.drape = drape_of(s, path.waypoints.front().speed);
            return path;
        }
        case TrajectoryType::Takeoff: return sim::takeoff_route(phase_of(s));
        case TrajectoryType::Racetrack: return sim::holding_route(phase_of(s));
        case TrajectoryType::Approach: return sim::approach_route(phase_of(s));
        case TrajectoryType::Figure8: return led(s.figure8, s);
        case TrajectoryType::Ship: return led(s.ship, s);
        case TrajectoryType::Table: {
            sim::TablePath path = s.table;
            path.start = s.start;
            path.rpy = s.attitude;
            path.standstill = s.route.standstill;
            return path;
        }
        case TrajectoryType::File: return recorded_path(s);
        case TrajectoryType::Weave: return sim::weaving_path(led(sim::WeavingFlight{}, s), s.sim.earth.ellipsoid);
        case TrajectoryType::Survey: return survey_of(s);
        case TrajectoryType::Car: break;
    }
    // the drive is as long as the scenario; values set by the user are kept
    sim::RoutePath path = sim::town_route(s.start, s.sim.duration, s.sim.seed);
    const std::vector<sim::Waypoint> waypoints = path.waypoints;
    path = s.route;
    path.start = s.start;
    path.waypoints = waypoints;
    return path;
}

double ground_of(const ScenarioConfig& s) {
    constexpr double lowest = -500.0;  // below any shore
    switch (s.type) {
        case TrajectoryType::Takeoff: return s.start.h;
        case TrajectoryType::GreatCircle:
        case TrajectoryType::PaperA:
        case TrajectoryType::Racetrack:
        case TrajectoryType::Approach:
        case TrajectoryType::Weave:
        case TrajectoryType::Figure8: return 0.0;
        default: return lowest;
    }
}

fusion::VehicleKind vehicle_of(TrajectoryType type) {
    switch (type) {
        case TrajectoryType::Static: return fusion::VehicleKind::Static;
        case TrajectoryType::GreatCircle:
        case TrajectoryType::PaperA:
        case TrajectoryType::Takeoff:
        case TrajectoryType::Racetrack:
        case TrajectoryType::Approach:
        case TrajectoryType::Weave:
        case TrajectoryType::Survey:
        case TrajectoryType::Figure8: return fusion::VehicleKind::Air;
        case TrajectoryType::Ship: return fusion::VehicleKind::Ship;
        case TrajectoryType::Table:
        case TrajectoryType::File: return fusion::VehicleKind::Hand;
        default: return fusion::VehicleKind::Car;
    }
}

}  // namespace schuler::settings
