// Paper A's complete error dynamics: the printed reference state, the filter's F by similarity, and the pendulum's claims.
#include "schuler/theory/level_dynamics.h"

#include "schuler/core/units.h"
#include "schuler/ins/error_model.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

namespace schuler::theory {
namespace {

using Eigen::Vector3d;

TEST(LevelDynamics, ReferenceState) {
    // math.md 2.3, R_3 = 6371000 m: paper A's row and column numbers.
    const earth::Earth earth;
    const Geodetic position{50.0 * units::deg, 0.0, 3000.0};
    const Matrix9 F = level_error_dynamics(earth, position, {150.0, -120.0, 8.0}, {1.0, 2.0, 9.8});
    const double R3 = 6371000.0;
    // clang-format off
    const std::vector<std::tuple<int, int, double>> expected{
        {4, 2, -2.693096161e-9 * R3}, {5, 2, -3.542086254e-9 * R3}, {5, 4, -1.676401600e-4}, {6, 2, -1.066014226e-8 * R3},
        {6, 3, 3.079929641e-6}, {6, 4, 1.406667965e-4}, {1, 2, 4.337612493e-5}, {9, 2, 1.625513070e-11 * R3},
        {8, 2, -8.780167062e-12 * R3}, {9, 4, 1.863949218e-7}};
    // clang-format on
    for (const auto& [i, j, value] : expected) EXPECT_NEAR(F(i - 1, j - 1), value, 1e-9 * std::abs(value)) << i << ", " << j;
}

TEST(LevelDynamics, TheFiltersModelIsSimilar) {
    // x_n = T x with T of the place: F_n T = T F + dT/dt. Gravity models without a north component, as here.
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int point = 0; point < 20; ++point) {
        earth::Earth earth;
        earth.gravity = point % 2 == 0 ? earth::GravityModel::KfGins : earth::GravityModel::PaperC;
        const Geodetic p{1.4 * unit(generator), unit(generator), 5000.0 * (1.0 + unit(generator))};
        const Vector3d v{250.0 * unit(generator), 250.0 * unit(generator), 30.0 * unit(generator)};
        const Vector3d f{4.0 * unit(generator), 4.0 * unit(generator), 9.8};
        const auto T = [&](double lat_, double h) {
            const earth::Radii r = earth::radii(earth.ellipsoid, lat_);
            Matrix9 M = Matrix9::Zero();
            M(0, d_lat) = r.meridian + h;
            M(1, d_lon) = (r.prime_vertical + h) * std::cos(lat_);
            M(2, d_h) = -1.0;
            M(3, d_vn) = M(4, d_ve) = M(6, a_n) = M(7, a_e) = 1.0;
            M(5, d_vu) = M(8, a_u) = -1.0;
            return M;
        };
        const Matrix9 F_n = ins::matrix(ins::error_n(earth, p, {v(1), v(0), -v(2)}, {f(1), f(0), -f(2)}));
        const double dt = 0.5, lat_rate = v(1) / (earth::radii(earth.ellipsoid, p.lat).meridian + p.h);
        const Matrix9 T_rate =
            (T(p.lat + lat_rate * dt, p.h + v(2) * dt) - T(p.lat - lat_rate * dt, p.h - v(2) * dt)) / (2.0 * dt);
        const Matrix9 here = T(p.lat, p.h), F = level_error_dynamics(earth, p, v, f);
        const Matrix9 misfit = F_n * here - here * F - T_rate;
        const Matrix9 size = F_n.cwiseAbs() * here.cwiseAbs() + here.cwiseAbs() * F.cwiseAbs() + T_rate.cwiseAbs();
        EXPECT_LE(misfit.cwiseAbs().cwiseQuotient(size.cwiseMax(1e-300)).maxCoeff(), 1e-8) << point << "\n" << misfit;
    }
}

TEST(LevelDynamics, ForceThatKeepsTheVelocity) {
    const earth::Earth earth{earth::wgs84, earth::GravityModel::KfGins};
    const Geodetic p{-0.6, 1.0, 4000.0};
    const Vector3d v(120.0, 200.0, -6.0), v_n(200.0, 120.0, 6.0);
    const earth::EarthTerms t = earth::terms_at(earth, p, v_n);
    const Vector3d f_n = (2.0 * t.w_ie_n + t.w_en_n).cross(v_n) - t.g_n, f = steady_level_force(earth, p, v);
    EXPECT_LT((Vector3d(f(1), f(0), -f(2)) - f_n).norm(), 1e-14);
}

TEST(Pendulum, ClaimsOfPaperAWithTheRightNumbers) {
    // math.md 2.9 and 2.10.
    const Pendulum p;
    EXPECT_NEAR(p.frequency(), 1.2406707e-3, 1e-10);
    const double period = 2.0 * std::numbers::pi / p.frequency();
    EXPECT_NEAR(period / 60.0, 84.4058, 1e-4);
    EXPECT_NEAR(p.from_tilt(1e-3, 0.5 * period), 12742.0, 0.1);
    EXPECT_NEAR(p.from_gyro(0.01 * units::deg_per_hour, 3600.0), 1353.4, 0.05);
    EXPECT_NEAR(p.from_velocity(1.0, 0.25 * period), 806.0, 0.05);
    EXPECT_NEAR(p.from_gyro(0.961 * units::deg_per_hour, 600.0), 1600.0, 1.0);
    EXPECT_NEAR(p.from_gyro(876.6 * units::deg_per_hour, 60.0), 1500.0, 1.0);
    EXPECT_NEAR(p.from_accelerometer(0.100001283, 10.0), 5.0, 1e-7);
    EXPECT_NEAR(p.from_gyro(3.05917218e-3, 10.0), 5.0, 2e-6);
}

}  // namespace
}  // namespace schuler::theory
