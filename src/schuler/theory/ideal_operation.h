// Paper C, sections 1 and 2: the equations of ideal operation of a strapdown INS in the north-up-east frame with
// Rodrigues-Hamilton parameters, and the matrix A of their linear errors. In the paper's axes and Earth, independent of room ins.
#pragma once

#include "schuler/theory/equator.h"

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace schuler::theory {

/// State of section 1: v_N, v_H, v_E (m/s), H (m), latitude, longitude (rad), kappa_0 to kappa_3 (scalar first: geographic
/// frame to body). T: double, or a complex type for derivatives by the complex step.
template <class T>
using IdealState = Eigen::Matrix<T, 10, 1>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Hamilton product l * m; conjugation without complex conjugation.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 1> quaternion_product(const Eigen::Matrix<T, 4, 1>& l, const Eigen::Matrix<T, 4, 1>& m) {
    return {l(0) * m(0) - l(1) * m(1) - l(2) * m(2) - l(3) * m(3), l(0) * m(1) + l(1) * m(0) + l(2) * m(3) - l(3) * m(2),
            l(0) * m(2) - l(1) * m(3) + l(2) * m(0) + l(3) * m(1), l(0) * m(3) + l(1) * m(2) - l(2) * m(1) + l(3) * m(0)};
}
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 1> conjugated(const Eigen::Matrix<T, 4, 1>& q) {
    return {q(0), -q(1), -q(2), -q(3)};
}

/// Terms common to the equations at a position and velocity. R_1, R_2 belong to the family of ellipsoids with semi-axis a + H.
template <class T>
struct IdealRates {
    T alpha, R1, R2, g;
    T u_N, u_H;       ///< Earth rate, rad/s
    T w_N, w_H, w_E;  ///< rate of the geographic frame, rad/s
};

/// x: first six entries of the state.
template <class T>
[[nodiscard]] IdealRates<T> ideal_rates(const PaperCEarth& earth, const Eigen::Matrix<T, 6, 1>& x) {
    using std::cos, std::sin, std::sqrt, std::tan;
    const T s = sin(x(lat)), r = earth.a + x(height);
    IdealRates<T> k;
    k.alpha = sqrt(1.0 - earth.e2 * s * s);
    k.R1 = r / k.alpha;
    k.R2 = r * (1.0 - earth.e2) / (k.alpha * k.alpha * k.alpha);
    k.g = earth.g_eo * earth.a * earth.a * (1.0 + earth.delta * s * s) / (r * r);
    k.u_N = earth.u * cos(x(lat));
    k.u_H = earth.u * s;
    k.w_N = k.u_N + x(ve) / k.R1;
    k.w_H = k.u_H + x(ve) * tan(x(lat)) / k.R1;
    k.w_E = -x(vn) / k.R2;
    return k;
}

/// Time derivatives of the six navigation variables for a specific force in geographic axes (N, H, E).
template <class T>
[[nodiscard]] Eigen::Matrix<T, 6, 1> navigation_rates(const PaperCEarth& earth, const Eigen::Matrix<T, 6, 1>& x,
                                                      const Vector3<T>& a) {
    using std::cos;
    const IdealRates<T> k = ideal_rates(earth, x);
    const T up = k.u_H + k.w_H, north = k.u_N + k.w_N;
    Eigen::Matrix<T, 6, 1> d;
    // clang-format off
    d << a(0) + k.w_E * x(vh) - up * x(ve), a(1) - k.w_E * x(vn) + north * x(ve) - k.g, a(2) + up * x(vn) - north * x(vh),
        x(vh) / k.alpha, x(vn) / k.R2, x(ve) / (k.R1 * cos(x(lat)));
    // clang-format on
    return d;
}

/// The whole system of section 1, driven by ideal gyros (rad/s) and accelerometers (m/s^2) in body axes.
template <class T>
[[nodiscard]] IdealState<T> ideal_operation(const PaperCEarth& earth, const IdealState<T>& x, const Vector3<T>& w_body,
                                            const Vector3<T>& a_body) {
    using Quaternion = Eigen::Matrix<T, 4, 1>;
    const Quaternion kappa = x.template tail<4>();
    const Eigen::Matrix<T, 6, 1> place = x.template head<6>();
    const Quaternion a =
        quaternion_product<T>(quaternion_product<T>(kappa, {T(0.0), a_body(0), a_body(1), a_body(2)}), conjugated<T>(kappa));
    const IdealRates<T> k = ideal_rates(earth, place);
    IdealState<T> d;
    d.template head<6>() = navigation_rates<T>(earth, place, a.template tail<3>());
    d.template tail<4>() = 0.5 * (quaternion_product<T>(kappa, {T(0.0), w_body(0), w_body(1), w_body(2)}) -
                                  quaternion_product<T>({T(0.0), k.w_N, k.w_H, k.w_E}, kappa));
    return d;
}

/// C_nu of section 2 as a quaternion: inertial axes (pole, meridian of angle 0, east of it) to the geographic frame at a
/// latitude and inertial longitude mu0 + u t + lon, so that kappa = conjugated(nu) * lambda.
[[nodiscard]] Eigen::Vector4d geographic_frame(double latitude, double inertial_longitude);

/// A of (1), all 36 entries as printed (correct if the attitude is held in inertial space: math.md 1.1).
/// x: v_N, v_H, v_E, H, latitude, longitude of the flight; a: its specific force in geographic axes (N, H, E), m/s^2.
[[nodiscard]] Matrix6 error_dynamics(const PaperCEarth& earth, const Vector6& x, const Eigen::Vector3d& a);

/// Specific force (N, H, E) that keeps the velocity constant, m/s^2.
[[nodiscard]] Eigen::Vector3d steady_force(const PaperCEarth& earth, const Vector6& x);

/// The same errors at one instant, computed in different ways (estimate minus truth).
struct Comparison {
    double t;           ///< s
    Vector6 nonlinear;  ///< difference of two integrations of the complete equations
    Vector6 linear;     ///< integration of dx/dt = A x along the flight
};

/// A flight at constant velocity components in the geographic frame from `start` (v_N, v_H, v_E, H, lat, lon): the complete
/// equations are integrated with ideal sensors from the true start and from start + initial, with correct inertial attitude;
/// fourth-order Runge-Kutta with steps of at most 1 s. Samples at 0 and at count equal intervals. @throws Error(Input) for
/// numbers that are not finite or a start near a pole; Error(Computation) if the perturbed solution leaves the vicinity of the
/// Earth or a pole is reached.
[[nodiscard]] std::vector<Comparison> compare_integrations(const PaperCEarth& earth, const Vector6& start, const Vector6& initial,
                                                           double duration, int count);

}  // namespace schuler::theory
