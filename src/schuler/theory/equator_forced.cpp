#include "schuler/theory/equator.h"

#include <algorithm>
#include <cmath>

namespace schuler::theory {
namespace {

/// b(tau) of (8): forcing of the velocity rows; phase = mu0 + lambda0 + w_n tau (the paper counts u t twice).
Vector6 forcing(const EquatorConstants& c, const Eigen::Matrix3d& l, double phase) {
    const double cs = std::cos(phase), sn = std::sin(phase);
    Vector6 b = Vector6::Zero();
    b(vn) = c.a_h * (l(0, 1) * cs + l(0, 2) * sn);
    b(vh) = c.a_h * (l(1, 1) * cs * cs + (l(2, 1) + l(1, 2)) * cs * sn + l(2, 2) * sn * sn);
    b(ve) = c.a_h * (l(2, 1) * cs * cs + (l(2, 2) - l(1, 1)) * cs * sn - l(1, 2) * sn * sn);
    return b;
}

/// Integral of P(t - tau) b(tau): Gauss-Legendre with eight points on panels short relative to every period.
Vector6 by_quadrature(const EquatorFlight& flight, const Eigen::Matrix3d& l, double longitude, double t) {
    constexpr double node[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623};
    constexpr double weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626};
    const EquatorConstants& c = flight.constants();
    const double fastest = std::max({c.omega, std::sqrt(std::abs(c.rho1)), std::abs(c.w_n)});
    const long panels = std::max(1L, std::lround(std::ceil(2.0 * std::abs(t) * fastest)));
    const double half = 0.5 * t / static_cast<double>(panels);
    Vector6 sum = Vector6::Zero();
    for (long k = 0; k < panels; ++k) {
        const double middle = (2.0 * static_cast<double>(k) + 1.0) * half;
        for (int i = 0; i < 4; ++i)
            for (const double tau : {middle - half * node[i], middle + half * node[i]})
                sum += weight[i] * half * flight.transition(t - tau) * forcing(c, l, longitude + c.w_n * tau);
    }
    return sum;
}

}  // namespace

Eigen::Matrix3d misalignment_matrix(const Eigen::Vector3d& e) {
    Eigen::Matrix3d l;
    l << 0.0, -e.z(), e.y(), e.z(), 0.0, -e.x(), -e.y(), e.x(), 0.0;
    return l;
}

Vector6 forced_by_misalignment(const EquatorFlight& flight, const Eigen::Matrix3d& l, double longitude, double t) {
    const EquatorConstants& c = flight.constants();
    Vector6 x = by_quadrature(flight, l, longitude, t);
    const double w = c.omega, n = c.w_n, D = w * w - n * n;
    if (std::abs(D) < 1e-6 * w * w) return x;  // resonance of the two rates: the quadrature is used
    const double cl = std::cos(longitude), sl = std::sin(longitude);
    const double cw = std::cos(w * t), sw = std::sin(w * t), cn = std::cos(n * t), sn = std::sin(n * t);
    // Integrals over tau of cos(w (t - tau)) and sin(w (t - tau)) times cos(n tau) and sin(n tau).
    const double cos_cos = (w * sw - n * sn) / D, cos_sin = n * (cn - cw) / D;
    const double sin_cos = w * (cn - cw) / D, sin_sin = (w * sn - n * sw) / D;
    const double by_cos = l(0, 1) * cl + l(0, 2) * sl, by_sin = -l(0, 1) * sl + l(0, 2) * cl;
    x(vn) = c.a_h * (by_cos * cos_cos + by_sin * cos_sin);
    x(lat) = c.a_h / (w * c.R) * (by_cos * sin_cos + by_sin * sin_sin);
    return x;
}

}  // namespace schuler::theory
