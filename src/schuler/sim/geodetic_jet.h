// From latitude, longitude and height as functions of time to velocity and acceleration in the local level.
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/sim/jet.h"
#include "schuler/sim/path.h"

namespace schuler::sim {

/// Geodetic position to order N.
template <int N>
struct GeodeticJet {
    Jet<N> lat, lon, h;
};

/// Metres per radian of latitude and of longitude at a position.
template <int N>
struct MetricJet {
    Jet<N> north, east;
};

/// R_M + h and (R_N + h) cos(lat); Groves 2013, (2.105) and (2.106).
template <int N>
[[nodiscard]] MetricJet<N> metric(const earth::Ellipsoid& ellipsoid, const Jet<N>& lat, const Jet<N>& h) {
    const SinCos<N> sc = sincos(lat);
    const double e2 = ellipsoid.e2();
    const Jet<N> w = Jet<N>(1.0) - e2 * (sc.sin * sc.sin);
    const Jet<N> prime_vertical = ellipsoid.a / sqrt(w);
    return {prime_vertical * (1.0 - e2) / w + h, (prime_vertical + h) * sc.cos};
}

/// North, east, up velocity.
template <int N>
struct VelocityJet {
    Jet<N> north, east, up;
};

template <int N>
[[nodiscard]] VelocityJet<N - 1> velocity(const earth::Ellipsoid& ellipsoid, const GeodeticJet<N>& p) {
    const MetricJet<N - 1> m = metric(ellipsoid, p.lat.template to<N - 1>(), p.h.template to<N - 1>());
    return {m.north * derivative(p.lat), m.east * derivative(p.lon), derivative(p.h)};
}

/// Roll, pitch, heading and their rates.
struct AttitudeJet {
    Jet<1> roll, pitch, heading;
};

[[nodiscard]] Kinematics kinematics(const GeodeticJet<1>& p, const VelocityJet<1>& v, const AttitudeJet& attitude);

}  // namespace schuler::sim
