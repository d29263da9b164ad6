#include "schuler/sim/weave.h"

#include "schuler/core/units.h"

#include <cmath>
#include <numbers>

namespace schuler::sim {

namespace {

double smoothstep(double x) { return x <= 0.0 ? 0.0 : x >= 1.0 ? 1.0 : x * x * (3.0 - 2.0 * x); }

double turn_rate(const WeavingFlight& f, double t) {
    const double quarter = 0.25 * f.period, phase = std::fmod(t, f.period);
    const bool right = phase >= quarter && phase < 2.0 * quarter, left = phase >= 3.0 * quarter;
    if (!right && !left) return 0.0;
    const double since = phase - (right ? quarter : 3.0 * quarter);
    const double shape = smoothstep(since / f.edge) * smoothstep((quarter - since) / f.edge);
    return right ? f.turn_rate * shape : -f.turn_rate * shape;
}

}  // namespace

RecordedPath weaving_path(const WeavingFlight& f, const earth::Ellipsoid& ellipsoid) {
    constexpr int steps = 20;  // a second
    constexpr double two_pi = 2.0 * std::numbers::pi, dt = 1.0 / steps, margin = 10.0, g = 9.8, incidence = 2.0 * units::deg;
    RecordedPath out;
    double lat = f.start.lat, lon = f.start.lon, heading = f.heading;
    const int seconds = static_cast<int>(std::ceil(f.duration + margin));
    for (int k = 0; k <= seconds * steps; ++k) {
        const double t = k * dt, phase = two_pi * t / f.climb_period;
        const double h = f.start.h + f.climb * f.climb_period / two_pi * (1.0 - std::cos(phase));
        if (k % steps == 0) {
            const double roll = std::atan(f.speed * turn_rate(f, t) / g);
            out.points.push_back({t, {lat, lon, h}, {roll, incidence + f.climb * std::sin(phase) / f.speed, heading}});
        }
        // midpoint rule: the heading at the middle of the step
        const double middle = heading + 0.5 * dt * turn_rate(f, t + 0.25 * dt);
        const earth::Radii r = earth::radii(ellipsoid, lat);
        const double north = f.speed * std::cos(middle), east = f.speed * std::sin(middle);
        const double mid_lat = lat + 0.5 * dt * north / (r.meridian + h);
        lat += dt * north / (r.meridian + h);
        lon += dt * east / ((r.prime_vertical + h) * std::cos(mid_lat));
        heading += dt * turn_rate(f, t + 0.5 * dt);
    }
    return out;
}

}  // namespace schuler::sim
