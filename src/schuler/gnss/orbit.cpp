#include "schuler/gnss/orbit.h"

#include "schuler/core/units.h"
#include "schuler/gnss/system_time.h"

#include <algorithm>
#include <cmath>

namespace schuler::gnss {
namespace {

/// Constants of each system's interface document, with which the elements were fitted.
struct OrbitConstants {
    double mu;          ///< m^3/s^2
    double earth_rate;  ///< rad/s
};
OrbitConstants constants_of(System system) {
    switch (system) {
        case System::Galileo: return {3.986004418e14, gps_earth_rate};
        case System::BeiDou: return {3.986004418e14, 7.2921150e-5};
        default: return {3.986005e14, gps_earth_rate};
    }
}

/// Kepler's equation by Newton's method: eccentric anomaly from mean anomaly.
double eccentric_anomaly(double mean, double e) {
    double anomaly = mean;
    for (int i = 0; i < 30; ++i) {
        const double step = (anomaly - e * std::sin(anomaly) - mean) / (1.0 - e * std::cos(anomaly));
        anomaly -= step;
        if (std::abs(step) < 1e-14) break;
    }
    return anomaly;
}

/// In-plane position with its rate, and the inclination.
struct OrbitPlane {
    double x, y, vx, vy, i, idot;
};

OrbitPlane in_plane(const KeplerEphemeris& k, double tk, double anomaly, double n) {
    const double a = k.sqrt_a * k.sqrt_a + k.a_rate * tk;
    const double se = std::sin(anomaly), ce = std::cos(anomaly), root = std::sqrt(1.0 - k.e * k.e);
    const double anomaly_rate = n / (1.0 - k.e * ce);
    const double latitude = std::atan2(root * se, ce - k.e) + k.omega;  // argument of latitude, without corrections
    const double latitude_rate = anomaly_rate * root / (1.0 - k.e * ce);
    const double s2 = std::sin(2.0 * latitude), c2 = std::cos(2.0 * latitude);
    const double u = latitude + k.cus * s2 + k.cuc * c2;
    const double udot = latitude_rate * (1.0 + 2.0 * (k.cus * c2 - k.cuc * s2));
    const double r = a * (1.0 - k.e * ce) + k.crs * s2 + k.crc * c2;
    const double rdot =
        a * k.e * se * anomaly_rate + k.a_rate * (1.0 - k.e * ce) + 2.0 * latitude_rate * (k.crs * c2 - k.crc * s2);
    const double i = k.i0 + k.idot * tk + k.cis * s2 + k.cic * c2;
    const double idot = k.idot + 2.0 * latitude_rate * (k.cis * c2 - k.cic * s2);
    const double su = std::sin(u), cu = std::cos(u);
    return {r * cu, r * su, rdot * cu - r * udot * su, rdot * su + r * udot * cu, i, idot};
}

void place(const KeplerEphemeris& k, const OrbitConstants& c, double tk, double toe_of_week, const OrbitPlane& o,
           SatelliteState& out) {
    const bool inertial = is_geostationary_beidou(k.satellite);
    const double node_rate = k.omega_dot - (inertial ? 0.0 : c.earth_rate);
    const double node = k.omega0 + node_rate * tk - c.earth_rate * toe_of_week;
    const double sn = std::sin(node), cn = std::cos(node), si = std::sin(o.i), ci = std::cos(o.i);
    Eigen::Vector3d r(o.x * cn - o.y * ci * sn, o.x * sn + o.y * ci * cn, o.y * si);
    Eigen::Vector3d v(o.vx * cn - o.vy * ci * sn + o.y * si * o.idot * sn - node_rate * r.y(),
                      o.vx * sn + o.vy * ci * cn - o.y * si * o.idot * cn + node_rate * r.x(), o.vy * si + o.y * ci * o.idot);
    if (inertial) {
        // from the frame tilted by -5 degrees about x, then rotated with the Earth since toe
        const double s5 = std::sin(-5.0 * units::deg), c5 = std::cos(-5.0 * units::deg);
        const double angle = c.earth_rate * tk, sa = std::sin(angle), ca = std::cos(angle);
        const auto turned = [&](const Eigen::Vector3d& p) {
            const double y = p.y() * c5 + p.z() * s5, z = -p.y() * s5 + p.z() * c5;
            return Eigen::Vector3d(p.x() * ca + y * sa, -p.x() * sa + y * ca, z);
        };
        r = turned(r);
        v = turned(v) + c.earth_rate * Eigen::Vector3d(r.y(), -r.x(), 0.0);
    }
    out.position.r = r;
    out.velocity = v;
}

constexpr double unknown_accuracy = 4.0;  // m, if not guaranteed by the message

}  // namespace

SatelliteState satellite_state(const KeplerEphemeris& k, Time t) {
    const OrbitConstants c = constants_of(k.satellite.system);
    const double tk = (t - k.toe).seconds(), a = k.sqrt_a * k.sqrt_a;
    const double mean = std::sqrt(c.mu / (a * a * a)) + k.delta_n, n = mean + k.delta_n_rate * tk;
    const double anomaly = eccentric_anomaly(k.m0 + (mean + 0.5 * k.delta_n_rate * tk) * tk, k.e);
    SatelliteState out;
    place(k, c, tk, week_second(k.toe, k.satellite.system).second, in_plane(k, tk, anomaly, n), out);
    const double tc = (t - k.toc).seconds();
    // relativity: -2 r.v/c^2 = F e sqrt(A) sin E with F = -2 sqrt(mu)/c^2 [ISGPS200:20.3.3.3.3.1]
    const double F = -2.0 * std::sqrt(c.mu) / (speed_of_light * speed_of_light);
    out.clock = k.af0 + tc * (k.af1 + tc * k.af2) + F * k.e * k.sqrt_a * std::sin(anomaly);
    out.clock_rate = k.af1 + 2.0 * k.af2 * tc + F * k.e * k.sqrt_a * std::cos(anomaly) * n / (1.0 - k.e * std::cos(anomaly));
    const double sigma = k.accuracy > 0.0 ? k.accuracy : unknown_accuracy;
    out.variance = sigma * sigma;
    return out;
}

namespace {

using Motion = Eigen::Matrix<double, 6, 1>;

/// Equations of motion in the rotating frame [GLONASSICD:A.3.1.2]: central field, oblateness, Earth rotation, Sun and Moon.
Motion glonass_rate(const Motion& s, const Eigen::Vector3d& acceleration) {
    constexpr double mu = 3.986004418e14, j2 = 1.08262575e-3, radius = 6378136.0, w = 7.292115e-5;
    const Eigen::Vector3d r = s.head<3>(), v = s.tail<3>();
    const double r2 = r.squaredNorm(), r3 = r2 * std::sqrt(r2);
    const double flat = 1.5 * j2 * mu * radius * radius / (r2 * r3), z2 = 5.0 * r.z() * r.z() / r2;
    const double in_plane = -mu / r3 - flat * (1.0 - z2);
    Motion rate;
    rate.head<3>() = v;
    rate[3] = (in_plane + w * w) * r.x() + 2.0 * w * v.y() + acceleration.x();
    rate[4] = (in_plane + w * w) * r.y() - 2.0 * w * v.x() + acceleration.y();
    rate[5] = (-mu / r3 - flat * (3.0 - z2)) * r.z() + acceleration.z();
    return rate;
}

}  // namespace

SatelliteState satellite_state(const GlonassEphemeris& g, Time t) {
    constexpr double longest_step = 60.0, farthest = 86'400.0;
    const double dt = std::clamp((t - g.toe).seconds(), -farthest, farthest);
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(dt) / longest_step)));
    const double h = dt / steps;
    Motion s;
    s << g.position, g.velocity;
    for (int i = 0; i < steps; ++i) {
        const Motion k1 = glonass_rate(s, g.acceleration);
        const Motion k2 = glonass_rate(s + 0.5 * h * k1, g.acceleration);
        const Motion k3 = glonass_rate(s + 0.5 * h * k2, g.acceleration);
        const Motion k4 = glonass_rate(s + h * k3, g.acceleration);
        s += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    constexpr double sigma = 5.0;  // m
    return {{s.head<3>()}, s.tail<3>(), g.clock + g.clock_rate * dt, g.clock_rate, sigma * sigma};
}

SatelliteState satellite_state(const SbasEphemeris& g, Time t) {
    const double dt = (t - g.toe).seconds();
    constexpr double sigma = 5.0;  // m
    return {{g.position + dt * g.velocity + 0.5 * dt * dt * g.acceleration},
            g.velocity + dt * g.acceleration,
            g.clock + g.clock_rate * dt,
            g.clock_rate,
            sigma * sigma};
}

double group_delay(const KeplerEphemeris& k, Signal signal) {
    const System system = k.satellite.system;
    const auto ratio = [&](char other) {
        const double f1 = frequency_of(system, '1'), f2 = frequency_of(system, other);
        return f1 * f1 / (f2 * f2);
    };
    switch (system) {
        case System::Gps:
        case System::Qzss:
            if (k.message == NavMessage::Cnav) return k.group_delay[signal.band == '1' ? 0 : signal.band == '2' ? 1 : 2];
            if (signal.band == '1') return k.group_delay[0];
            return signal.band == '2' ? ratio('2') * k.group_delay[0] : 0.0;
        case System::Galileo: {
            const double e5a = k.group_delay[0], e5b = k.group_delay[1];
            const double e1 = k.message == NavMessage::Fnav ? e5a : e5b;
            // signals differ from E1 by the same delays for both clocks
            if (signal.band == '5') return e1 + (ratio('5') - 1.0) * e5a;
            if (signal.band == '7') return e1 + (ratio('7') - 1.0) * e5b;
            return e1;
        }
        case System::BeiDou: return signal.band == '2' ? k.group_delay[0] : signal.band == '7' ? k.group_delay[1] : 0.0;
        case System::Navic: return signal.band == '5' ? k.group_delay[0] : 0.0;
        default: return 0.0;
    }
}

double group_delay(const GlonassEphemeris& g, Signal signal) { return signal.band == '2' ? g.l2_delay : 0.0; }

}  // namespace schuler::gnss
