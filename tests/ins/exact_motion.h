// Analytic motions over the Earth and what an ideal IMU senses on them, without the equations of the mechanization: position in
// Earth-fixed axes and attitude are differentiated by Taylor arithmetic, increments are Gauss-Legendre integrals.
#pragma once

#include "jet.h"

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <functional>
#include <vector>

namespace schuler::ins::test {

/// Latitude, longitude, height, roll, pitch, heading as functions of time.
using Pose = std::array<Jet, 6>;
using Motion = std::function<Pose(const Jet& t)>;

struct Sensed {
    Eigen::Vector3d w_ib_b, f_b;
    NavStateEcef state;
};

using JetMatrix = std::array<std::array<Jet, 3>, 3>;

inline JetMatrix product(const JetMatrix& a, const JetMatrix& b) {
    JetMatrix c;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return c;
}

/// Elementary rotations written out here, so that a wrong rotation of the library cannot hide.
inline JetMatrix about_z(const Jet& a) { return {{{cos(a), -sin(a), 0.0}, {sin(a), cos(a), 0.0}, {0.0, 0.0, 1.0}}}; }
inline JetMatrix about_y(const Jet& a) { return {{{cos(a), 0.0, sin(a)}, {0.0, 1.0, 0.0}, {-sin(a), 0.0, cos(a)}}}; }
inline JetMatrix about_x(const Jet& a) { return {{{1.0, 0.0, 0.0}, {0.0, cos(a), -sin(a)}, {0.0, sin(a), cos(a)}}}; }

inline Sensed sensed(const earth::Earth& earth, const Motion& motion, double t) {
    const Pose p = motion(time_jet(t));
    const double e2 = earth.ellipsoid.e2();
    const Jet s = sin(p[0]), c = cos(p[0]);
    const Jet n = earth.ellipsoid.a * inverse_sqrt(1.0 - e2 * s * s);
    const Jet x = (n + p[2]) * c * cos(p[1]), y = (n + p[2]) * c * sin(p[1]), z = (n * (1.0 - e2) + p[2]) * s;

    // C_en = Rz(lon) Ry(-lat - 90 deg), C_nb = Rz(heading) Ry(pitch) Rx(roll).
    const JetMatrix level{{{-s, 0.0, -c}, {0.0, 1.0, 0.0}, {c, 0.0, -s}}};
    const JetMatrix C_nb = product(about_z(p[5]), product(about_y(p[4]), about_x(p[3])));
    const JetMatrix C_eb = product(about_z(p[1]), product(level, C_nb));
    Eigen::Matrix3d C, Cd;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Jet& e = C_eb[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
            C(i, j) = e.v;
            Cd(i, j) = e.d;
        }
    const Eigen::Vector3d w_ie(0.0, 0.0, earth.ellipsoid.w_ie);
    const Eigen::Matrix3d W = C.transpose() * Cd;

    Sensed out;
    out.state.time = Time::from_seconds(t);
    out.state.position.r = {x.v, y.v, z.v};
    out.state.v_eb_e = {x.d, y.d, z.d};
    out.state.q_eb = Eigen::Quaterniond(C);
    out.w_ib_b = Eigen::Vector3d(W(2, 1), W(0, 2), W(1, 0)) + C.transpose() * w_ie;
    const Eigen::Vector3d f_e =
        Eigen::Vector3d(x.dd, y.dd, z.dd) + 2.0 * w_ie.cross(out.state.v_eb_e) - earth::gravity_ecef(earth, out.state.position);
    out.f_b = C.transpose() * f_e;
    return out;
}

/// Ideal increments over (t0, t0 + count dt]: three-point Gauss-Legendre a step (relative error (motion rate x dt)^6/2e6).
inline std::vector<ImuIncrement> ideal_increments(const earth::Earth& earth, const Motion& motion, double t0, double dt,
                                                  long count) {
    constexpr double node = 0.7745966692414834;
    std::vector<ImuIncrement> out;
    out.reserve(static_cast<std::size_t>(count));
    for (long k = 0; k < count; ++k) {
        const double middle = t0 + (static_cast<double>(k) + 0.5) * dt;
        const Sensed a = sensed(earth, motion, middle - 0.5 * dt * node), b = sensed(earth, motion, middle),
                     c = sensed(earth, motion, middle + 0.5 * dt * node);
        out.push_back({Time::from_seconds(t0 + static_cast<double>(k + 1) * dt), dt,
                       dt / 18.0 * (5.0 * (a.w_ib_b + c.w_ib_b) + 8.0 * b.w_ib_b),
                       dt / 18.0 * (5.0 * (a.f_b + c.f_b) + 8.0 * b.f_b)});
    }
    return out;
}

/// Sums of `factor` consecutive increments: the same motion sampled more slowly, still exact.
inline std::vector<ImuIncrement> summed(const std::vector<ImuIncrement>& fine, std::size_t factor) {
    std::vector<ImuIncrement> out;
    for (std::size_t k = 0; k + factor <= fine.size(); k += factor) {
        ImuIncrement sum = fine[k];
        for (std::size_t j = 1; j < factor; ++j) {
            sum.time = fine[k + j].time;
            sum.dt += fine[k + j].dt;
            sum.dtheta += fine[k + j].dtheta;
            sum.dv += fine[k + j].dv;
        }
        out.push_back(sum);
    }
    return out;
}

}  // namespace schuler::ins::test
