#include "schuler/theory/ideal_operation.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::theory {

Eigen::Vector4d geographic_frame(double latitude, double inertial_longitude) {
    // First about the pole, then about the new east axis: longitude moves the zenith eastwards, latitude towards the pole.
    const double p = 0.5 * latitude, l = 0.5 * inertial_longitude;
    return quaternion_product<double>({std::cos(l), std::sin(l), 0.0, 0.0}, {std::cos(p), 0.0, 0.0, -std::sin(p)});
}

Matrix6 error_dynamics(const PaperCEarth& earth, const Vector6& x, const Eigen::Vector3d& a) {
    const IdealRates<double> k = ideal_rates<double>(earth, x);
    const double r = earth.a + x(height), e2 = earth.e2, alpha = k.alpha, R1 = k.R1, R2 = k.R2;
    const double s = std::sin(x(lat)), c = std::cos(x(lat)), sc = s * c;
    const double vN = x(vn), vH = x(vh), vE = x(ve);
    const double own_N = k.w_N - k.u_N, own_H = k.w_H - k.u_H;  // due to the motion alone
    Matrix6 A;
    A.row(vn) << -vH / R2, k.w_E, -2.0 * k.w_H, (own_H * vE - k.w_E * vH) / r,
        -a(1) - 2.0 * k.u_N * vE - own_N * vE / (c * c) + vE * vE * e2 * s * s / (r * alpha) +
            3.0 * vN * vH * e2 * sc / (R1 * (1.0 - e2)),
        -a(2) * s;
    A.row(vh) << -2.0 * k.w_E, 0.0, 2.0 * k.w_N, (k.w_E * vN - own_N * vE + 2.0 * k.g) / r,
        a(0) - 2.0 * k.u_H * vE - 2.0 * earth.g_eo * earth.a * earth.a * earth.delta * sc / (r * r) -
            3.0 * vN * vN * e2 * sc / (R1 * (1.0 - e2)) - vE * vE * e2 * sc / (r * alpha),
        a(2) * c;
    // clang-format off
    A.row(ve) << k.u_H + k.w_H, -k.u_N - k.w_N, (vN * s / c - vH) / R1, (own_N * vH - own_H * vN) / r,
        2.0 * k.u_N * vN + 2.0 * k.u_H * vH + own_N * vN / (c * c) + vE * e2 * s * (vH * c - vN * s) / (r * alpha),
        a(0) * s - a(1) * c;
    // clang-format on
    A.row(height) << 0.0, 1.0 / alpha, 0.0, 0.0, vH * e2 * sc / (alpha * alpha * alpha), 0.0;
    A.row(lat) << 1.0 / R2, 0.0, 0.0, -vN / (R2 * r), -3.0 * vN * e2 * sc / (R1 * (1.0 - e2)), 0.0;
    A.row(lon) << 0.0, 0.0, 1.0 / (R1 * c), -vE / (R1 * c * r), vE * s / (R1 * c * c) - vE * e2 * s / (r * alpha), 0.0;
    return A;
}

Eigen::Vector3d steady_force(const PaperCEarth& earth, const Vector6& x) {
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    return -navigation_rates<double>(earth, x, zero).head<3>();
}

namespace {

/// Jointly integrated quantities: height, latitude and longitude of the flight, two solutions, the linear errors.
using Joint = Eigen::Matrix<double, 29, 1>;

Joint rates(const PaperCEarth& earth, const Eigen::Vector3d& velocity, const Joint& y) {
    Vector6 flight;
    flight << velocity, y.head<3>();
    const Eigen::Vector3d force = steady_force(earth, flight);
    const IdealRates<double> k = ideal_rates<double>(earth, flight);
    const Eigen::Vector3d rate(k.w_N, k.w_H, k.w_E);  // the body axes coincide with the geographic ones
    Joint d;
    d.head<3>() = navigation_rates<double>(earth, flight, force).tail<3>();
    d.segment<10>(3) = ideal_operation<double>(earth, y.segment<10>(3), rate, force);
    d.segment<10>(13) = ideal_operation<double>(earth, y.segment<10>(13), rate, force);
    d.tail<6>() = error_dynamics(earth, flight, force) * y.tail<6>();
    return d;
}

Joint stepped(const PaperCEarth& earth, const Eigen::Vector3d& velocity, const Joint& y, double h) {
    const Joint k1 = rates(earth, velocity, y);
    const Joint k2 = rates(earth, velocity, y + 0.5 * h * k1);
    const Joint k3 = rates(earth, velocity, y + 0.5 * h * k2);
    const Joint k4 = rates(earth, velocity, y + h * k3);
    return y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
}

bool usable(const PaperCEarth& earth, const Vector6& x) {
    return x.allFinite() && std::abs(x(lat)) < 89.9 * units::deg && x(height) > -0.5 * earth.a;
}

}  // namespace

std::vector<Comparison> compare_integrations(const PaperCEarth& earth, const Vector6& start, const Vector6& initial,
                                             double duration, int count) {
    if (!usable(earth, start) || !usable(earth, start + initial) || !(duration >= 0.0) || !std::isfinite(duration) || count < 1)
        throw input_error("the start or the time of the comparison is unusable", {},
                          "give finite numbers, a latitude within 89.9 deg and a time that is not negative");
    const Vector6 wrong = start + initial;
    const Eigen::Vector3d velocity = start.head<3>();
    // The inertial attitude is correct: the error of the geographic frame enters kappa.
    const Eigen::Vector4d truly = geographic_frame(start(lat), start(lon)), believed = geographic_frame(wrong(lat), wrong(lon));
    Joint y;
    // clang-format off
    y << start.tail<3>(), start, 1.0, 0.0, 0.0, 0.0, wrong, quaternion_product<double>(conjugated<double>(believed), truly),
        initial;
    // clang-format on
    std::vector<Comparison> out;
    const auto sample = [&](double t) { out.push_back({t, y.segment<6>(13) - y.segment<6>(3), y.tail<6>()}); };
    sample(0.0);
    const long steps = std::max(1L, std::lround(std::ceil(duration / count)));
    const double h = duration / count / static_cast<double>(steps);
    for (int k = 1; k <= count; ++k) {
        for (long i = 0; i < steps; ++i) y = stepped(earth, velocity, y, h);
        const double t = duration * k / count;
        if (!usable(earth, y.segment<6>(3)) || !usable(earth, y.segment<6>(13)))
            throw computation_error(
                fmt::format("at {:.0f} s the flight or its perturbed solution is at a pole or has left the Earth", t),
                "give a shorter time or smaller initial errors");
        sample(t);
    }
    return out;
}

}  // namespace schuler::theory
