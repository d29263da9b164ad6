// Phases of a flight as routes: take-off and climb, holding pattern, approach and landing.
#include "schuler/core/error.h"
#include "schuler/sim/path.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::sim {

namespace {

/// Places waypoints by flying from one to the next.
class Pilot {
public:
    Pilot(RoutePath& route, double heading) : route_(route), heading_(heading) {}
    Pilot& turn(double by) {
        heading_ += by;
        return *this;
    }
    Pilot& fly(double distance, double climb, double speed) {
        north_ += distance * std::cos(heading_);
        east_ += distance * std::sin(heading_);
        up_ += climb;
        route_.waypoints.push_back({north_, east_, up_, speed, 0.0});
        return *this;
    }

private:
    RoutePath& route_;
    double heading_, north_ = 0.0, east_ = 0.0, up_ = 0.0;
};

constexpr double right_angle = 0.5 * std::numbers::pi;
constexpr double rate_one = std::numbers::pi / 60.0;  // rad/s, two minutes a circle

RoutePath aircraft(const FlightPhase& s) {
    const auto require = [](bool ok, const char* key, const char* what, const char* hint) {
        if (!ok) throw input_error(what, {.file = {}, .line = 0, .column = 0, .key = key}, hint);
    };
    require(std::isfinite(s.speed) && s.speed >= 20.0 && s.speed <= 400.0, "trajectory.speed_m_s",
            "is not the speed of an aircraft", "give 20 to 400 m/s");
    require(std::isfinite(s.height_change) && s.height_change > 0.0, "trajectory.height_change_m", "is not positive",
            "give metres");
    require(std::isfinite(s.heading), "trajectory.heading_deg", "is not a number", "give degrees");
    RoutePath route;
    route.start = s.start;
    route.standstill = 0.0;
    route.knot_spacing = 50.0;
    route.corner_radius = s.speed / rate_one;
    route.lateral_accel = 1.2 * s.speed * rate_one;
    route.longitudinal_accel = 2.0;
    route.roll_per_lateral_accel = 0.102;
    route.pitch_per_accel = 0.0;
    return route;
}

}  // namespace

RoutePath takeoff_route(const FlightPhase& s) {
    RoutePath route = aircraft(s);
    route.standstill = s.standstill;
    const double unstick = 0.5 * s.speed, climb = s.height_change;
    const double runway = std::max(500.0, 0.6 * unstick * unstick / route.longitudinal_accel);
    // Path angle of about 4 degrees to a third of the height, then flatter and faster; level flight for the requested duration.
    Pilot(route, s.heading)
        .fly(runway, 0.0, unstick)
        .fly(std::max(14.0 * climb / 3.0, 4.0 * route.corner_radius), climb / 3.0, 0.7 * s.speed)
        .turn(0.5 * right_angle)
        .fly(std::max(18.0 * 2.0 * climb / 3.0, 4.0 * route.corner_radius), 2.0 * climb / 3.0, s.speed)
        .fly(s.duration * s.speed + 5000.0, 0.0, s.speed);
    return route;
}

RoutePath holding_route(const FlightPhase& s) {
    RoutePath route = aircraft(s);
    route.start_speed = s.speed;
    const double leg = 60.0 * s.speed + 2.0 * route.corner_radius, width = 2.0 * route.corner_radius / 0.9;
    Pilot pilot(route, s.heading);
    for (double left = s.duration + 60.0; left > 0.0; left -= 2.0 * (leg + width) / s.speed)
        pilot.fly(leg, 0.0, s.speed)
            .turn(right_angle)
            .fly(width, 0.0, s.speed)
            .turn(right_angle)
            .fly(leg, 0.0, s.speed)
            .turn(right_angle)
            .fly(width, 0.0, s.speed)
            .turn(right_angle);
    return route;
}

RoutePath approach_route(const FlightPhase& s) {
    RoutePath route = aircraft(s);
    route.start_speed = s.speed;
    route.longitudinal_accel = 1.5;
    const double base = 3.0 * route.corner_radius, touchdown = 0.6 * s.speed;
    const double glide = s.height_change / std::tan(3.0 * std::numbers::pi / 180.0);
    const double stop = touchdown * touchdown / (2.0 * route.longitudinal_accel);
    // Downwind, base, then a glide path of three degrees to the runway and the landing run.
    Pilot(route, s.heading)
        .fly(glide + base, 0.0, s.speed)
        .turn(right_angle)
        .fly(base, 0.0, 0.8 * s.speed)
        .turn(right_angle)
        .fly(glide + route.corner_radius, -s.height_change, touchdown)  // the turn uses a radius of the leg
        .fly(std::max(1.2 * stop, 600.0), 0.0, touchdown);
    return route;
}

}  // namespace schuler::sim
