// A hand-held sensor in closed form: attitude from sines, sway with a velocity of known spread, a field that can be disturbed.
#pragma once

#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::ahrs::testing {

struct Motion {
    double dt = 0.01, duration = 120.0;
    bool moving = true;
    double swing = 1.0;                        ///< of the attitude
    double rest = 5.0;                         ///< s, at the start
    double gyro_std = 0.1 * units::deg_per_s;  ///< rad/s a sample
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
    double accel_std = 0.05;                 ///< m/s^2 a sample
    double sway_std = 0.0, sway_time = 0.3;  ///< m/s and s, first-order Markov velocity, horizontal and vertical
    double field_std = 200e-9;               ///< T a sample
    Eigen::Vector3d hard_iron = Eigen::Vector3d::Zero();
    Eigen::Vector2d place = Eigen::Vector2d::Zero();    ///< T, what the room adds, north and east
    double horizontal = 18964e-9, vertical = 46962e-9;  ///< T
    double gravity = 9.81;
    double disturbed_from = 1e9, disturbed_to = 1e9;    ///< s
    double turn = 20.0 * units::deg, lift = -10000e-9;  ///< of the field then: horizontally, and added downwards
};

struct Instant {
    double time;
    Eigen::Vector3d gyro, accel, field;
    Eigen::Quaterniond q_nb;
};

inline Eigen::Quaterniond attitude_at(const Motion& m, double t) {
    if (!m.moving) return math::quaternion_from_rpy({0.0, 0.0, 0.0});
    constexpr double tau = 2.0 * std::numbers::pi;
    t = std::max(0.0, t - m.rest);
    const double deg = m.swing * units::deg;
    return math::quaternion_from_rpy(
        {20.0 * deg * std::sin(tau * t / 7.0), 15.0 * deg * std::sin(tau * t / 5.0), 60.0 * deg * std::sin(tau * t / 23.0)});
}

/// The same seed gives the same noise whatever the disturbance is.
inline std::vector<Instant> simulated(const Motion& m, std::uint64_t seed) {
    math::Random gyro(seed, "gyro"), accel(seed, "accel"), field(seed, "field"), sway(seed, "sway");
    std::vector<Instant> out;
    Eigen::Vector3d velocity = m.sway_std * sway.normal3();
    const double keep = std::exp(-m.dt / m.sway_time);
    const int n = static_cast<int>(std::lround(m.duration / m.dt));
    for (int i = 1; i <= n; ++i) {
        const double t = i * m.dt;
        Instant s;
        s.time = t;
        s.q_nb = attitude_at(m, t);
        const Eigen::Quaterniond before = attitude_at(m, t - m.dt);
        s.gyro =
            math::rotation_vector_from_quaternion(before.conjugate() * s.q_nb) / m.dt + m.gyro_bias + m.gyro_std * gyro.normal3();
        const Eigen::Vector3d next = keep * velocity + std::sqrt(1.0 - keep * keep) * m.sway_std * sway.normal3();
        const Eigen::Vector3d sway_a = t > m.rest ? ((next - velocity) / m.dt).eval() : Eigen::Vector3d::Zero().eval();
        const Eigen::Vector3d force_n = sway_a - Eigen::Vector3d(0.0, 0.0, m.gravity);
        velocity = next;
        s.accel = s.q_nb.conjugate() * force_n + m.accel_bias + m.accel_std * accel.normal3();
        const bool disturbed = t >= m.disturbed_from && t < m.disturbed_to;
        const double turn = disturbed ? m.turn : 0.0, down = m.vertical + (disturbed ? m.lift : 0.0);
        const Eigen::Vector3d field_n(m.horizontal * std::cos(turn) + m.place.x(), m.horizontal * std::sin(turn) + m.place.y(),
                                      down);
        s.field = s.q_nb.conjugate() * field_n + m.hard_iron + m.field_std * field.normal3();
        out.push_back(s);
    }
    return out;
}

}  // namespace schuler::ahrs::testing
