#include "schuler/sim/route.h"

#include "schuler/math/random.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::sim {

namespace {

RoutePlan draped(const RoutePath& settings, const earth::Ellipsoid& ellipsoid) {
    RoutePlan plan = plan_route(settings);
    if (settings.drape) drape(plan, *settings.drape, LocalChart(ellipsoid, settings.start));
    return plan;
}

}  // namespace

Route::Route(const RoutePath& settings, const earth::Ellipsoid& ellipsoid)
    : Route(settings, ellipsoid, draped(settings, ellipsoid)) {}

Route::Route(const RoutePath& settings, const earth::Ellipsoid& ellipsoid, const RoutePlan& plan)
    : s_(settings),
      ellipsoid_(ellipsoid),
      chart_(ellipsoid, settings.start),
      lead_(plan.lead * plan.length_spacing),
      lead_time_(plan.lead_time),
      north_(plan.length_spacing, plan.north),
      east_(plan.length_spacing, plan.east),
      up_(plan.length_spacing, plan.up),
      length_(plan.time_spacing, plan.length) {}

Kinematics Route::at(double t) const {
    const Jet<4> length = length_.at(t + lead_time_);
    const Jet<3> u = length.to<3>();
    const Jet<4> n = north_.at(length.value() + lead_), e = east_.at(length.value() + lead_), h = up_.at(length.value() + lead_);
    const Jet<3> speed = derivative(length);

    GeodeticJet<3> p = chart_.at<3>(compose(n.to<3>(), u), compose(e.to<3>(), u), compose(h.to<3>(), u));
    // The direction of travel is the tangent of the curve, also defined at rest.
    const MetricJet<2> m = metric(ellipsoid_, p.lat.to<2>(), p.h.to<2>());
    const Jet<2> along = u.to<2>();
    const Jet<2> tn = m.north * (chart_.lat_per_m * compose(derivative(n).to<2>(), along));
    const Jet<2> te = m.east * (chart_.lon_per_m * compose(derivative(e).to<2>(), along));
    const Jet<2> tu = compose(derivative(h).to<2>(), along);
    const Jet<2> level = sqrt(tn * tn + te * te);
    const Jet<2> course = atan2(te, tn);
    const Jet<1> v = (level * speed.to<2>()).to<1>();
    AttitudeJet attitude{s_.roll_per_lateral_accel * (v * derivative(course)),
                         atan2(tu, level).to<1>() + s_.pitch_per_accel * derivative(speed.to<2>()), course.to<1>()};

    if (s_.vibration.angle != 0.0 || s_.vibration.accel != 0.0) {
        const Jet<3> moving = speed * speed / (1.0 + speed * speed);
        const double w = 2.0 * std::numbers::pi * s_.vibration.frequency;
        const SinCos<1> swing = sincos(w * Jet<1>::variable(t));
        attitude.roll += s_.vibration.angle * moving.to<1>() * swing.sin;
        attitude.pitch += s_.vibration.angle * moving.to<1>() * swing.cos;
        const double wh = 1.31 * w;
        p.h += s_.vibration.accel / (wh * wh) * moving * sincos(wh * Jet<3>::variable(t)).sin;
    }
    const VelocityJet<2> vel = velocity(ellipsoid_, p);
    return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {vel.north.to<1>(), vel.east.to<1>(), vel.up.to<1>()},
                      attitude);
}

RoutePath town_route(const Geodetic& start, double duration, std::uint64_t seed) {
    math::Random random(seed, "sim.town_route");
    RoutePath route;
    route.start = start;
    double left = duration - route.standstill - 10.0;
    double north = 0.0, east = 0.0, up = 0.0;
    double heading = 0.5 * std::numbers::pi * std::floor(4.0 * random.uniform()) + 0.4;
    while (left > 0.0 || route.waypoints.empty()) {
        const double leg = 80.0 + 320.0 * random.uniform();
        const double speed = 9.0 + 7.0 * random.uniform();
        const bool stops = random.uniform() < 0.3;
        const double dwell = stops ? 8.0 + 25.0 * random.uniform() : 0.0;
        north += leg * std::cos(heading);
        east += leg * std::sin(heading);
        up += 0.04 * leg * (random.uniform() - 0.5) - 0.05 * up;
        route.waypoints.push_back({north, east, up, speed, dwell});
        const double kind = random.uniform();
        const double turn = kind < 0.4 ? 90.0 : (kind < 0.6 ? 45.0 : (kind < 0.8 ? 15.0 : 0.0));
        heading += (random.uniform() < 0.5 ? -turn : turn) * std::numbers::pi / 180.0;
        // Duration of the leg at its speed, with braking and acceleration at a corner or a stop, and of the stop itself.
        left -= leg / speed + (stops || turn > 20.0 ? 0.6 * speed / route.longitudinal_accel : 0.0) + dwell + (stops ? 3.0 : 0.0);
    }
    return route;
}

}  // namespace schuler::sim
