// Ranks of paper E's model against those found with fifty digits by another program (reference numbers of math.md section 4), and
// the combinations against what must be inseparable.
#include "schuler/gravimetry/observability.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/detail/model_series.h"
#include "schuler/gravimetry/model.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace schuler::gravimetry {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double hour = 1.0 / 3600.0;

ObservedMotion moving(const Vector3d& v, double mu) {
    ObservedMotion m;
    m.v_eb_n = v;
    m.random_rate = mu;
    return m;
}
ObservedMotion turning(double mu) {
    ObservedMotion m = moving(Vector3d::Zero(), mu);
    m.heading_rate = units::deg;
    return m;
}

void expect_rank(const ObservedMotion& motion, int rank) {
    const Observability o = observability({}, motion);
    EXPECT_EQ(o.rank, rank);
    EXPECT_GT(o.pivots.back(), 1e-14);  // and the gap is wide: the rank is that of exact arithmetic
    EXPECT_LT(o.next, 1e-40);
}

TEST(Observability, RanksAtRest) {
    expect_rank(moving(Vector3d::Zero(), 0.0), 15);
    expect_rank(moving(Vector3d::Zero(), hour), 18);
}

TEST(ObservabilitySlow, RanksInMotion) {
    expect_rank(moving({1.0, 1.0, 0.0}, 0.0), 22);
    expect_rank(moving({1.0, 1.0, 0.0}, hour), 25);
    expect_rank(moving({0.0, 10.0, 0.0}, 0.0), 22);
    expect_rank(moving({10.0, 0.0, 0.0}, 0.0), 22);
    // Constant course against north: a third program (Python, sixty digits) finds these. Eastward it is a turn about the polar axis,
    // steady in every respect, and tells no more than turning on the spot.
    const auto rhumb = [](const Vector3d& v, double mu) {
        ObservedMotion m = moving(v, mu);
        m.rhumb = true;
        return m;
    };
    expect_rank(rhumb({0.0, 10.0, 0.0}, 0.0), 19);
    const Observability o = observability({}, rhumb({1.0, 1.0, 0.0}, 0.0));
    EXPECT_EQ(o.rank, 24);
    EXPECT_LT(o.pivots.back(), 1e-15);  // 2e-17: a matter of principle only
    expect_rank(turning(0.0), 19);
    expect_rank(turning(hour), 22);
}

TEST(ObservabilitySlow, APolynomialsDerivativesAreSeenInMotionOnly) {
    for (const int degree : {1, 2}) {
        ObservedMotion still = moving(Vector3d::Zero(), 0.0), course = moving({1.0, 1.0, 0.0}, 0.0);
        still.degree = course.degree = degree;
        const Observability seen = observability({}, course);
        EXPECT_EQ(observability({}, still).rank, 15);
        EXPECT_EQ(seen.rank, 22 + 3 * degree);
        EXPECT_EQ(seen.states, 27 + 3 * degree);
        EXPECT_LT(seen.next, 1e-40);
        EXPECT_LT(seen.pivots.back(), 1e-15);  // a matter of principle only: 9e-17 and 4e-21
    }
}

TEST(Observability, RanksOfTheFrozenModelAreThoseAtRest) {
    ObservedMotion m = moving({1.0, 1.0, 0.0}, 0.0);
    m.frozen = true;
    EXPECT_EQ(observability({}, m).rank, 15);
    m.random_rate = hour;
    EXPECT_EQ(observability({}, m).rank, 18);
}

TEST(ObservabilitySlow, ThePapersEighteenIsAMatterOfTolerance) {
    const ObservedMotion m = moving({1.0, 1.0, 0.0}, 0.0);
    EXPECT_EQ(observability({}, m, 1e-7).rank, 18);
    EXPECT_EQ(observability({}, m, 1e-5).rank, 16);
}

TEST(Observability, WhatIsSeenAtRest) {
    // Every combination must be blind to the directions that cannot be told apart: the constant and the "random" part of a
    // disturbance, a disturbance and the accelerometers' errors that feel the same, here in the program's signs.
    const ObservedMotion m = moving(Vector3d::Zero(), 0.0);
    const Matrix3d C_eb = earth::C_en(m.start.lat, m.start.lon) * math::dcm_from_rpy(m.rpy);
    const auto names = state_names();
    std::vector<std::map<std::string, double>> blind;
    for (int axis = 0; axis < 3; ++axis) {
        const auto named = [&](int group, int i) { return names[static_cast<std::size_t>(group + i)]; };
        blind.push_back({{named(systematic, axis), 1.0}, {named(random, axis), -1.0}});
        std::map<std::string, double> direction{{named(systematic, axis), 1.0}};
        for (int i = 0; i < 3; ++i) direction[named(accel_bias, i)] = C_eb(axis, i);  // -C db + dA = 0
        blind.push_back(direction);
    }
    const Observability o = observability({}, m);
    ASSERT_EQ(o.combinations.size(), 15U);
    for (const SeenCombination& seen : o.combinations)
        for (const auto& direction : blind) {
            const auto at = [&](const std::string& name) { return direction.count(name) ? direction.at(name) : 0.0; };
            double sum = at(seen.state), size = std::abs(sum);
            for (const auto& [name, coefficient] : seen.with) {
                sum += coefficient * at(name);
                size += std::abs(coefficient * at(name));
            }
            EXPECT_LE(std::abs(sum), 1e-9 * size) << seen.state;
        }
}

TEST(Observability, TheSeriesBeginWithTheFiltersModel) {
    // Two programmings of F. The filter's gradient knows the flattening (0.5 %); the force that keeps the velocity is the same.
    const earth::Earth earth;
    ObservedMotion m = moving({60.0, -40.0, 3.0}, hour);
    m.rpy = {0.1, -0.2, 2.0};
    m.centrifugal = true;
    m.rhumb = true;
    m.degree = 2;
    const detail::ModelSeries model = detail::model_series(earth, m);
    const earth::EarthTerms terms = earth::terms_at(earth, m.start, m.v_eb_n);
    const Matrix3d C_en = earth::C_en(m.start.lat, m.start.lon);
    const Vector3d g_n(0.0, 0.0, earth::gravity_down(earth.gravity, m.start.lat, m.start.h));
    const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(m.v_eb_n) - g_n;
    const StateMatrix expected = gravity_error_dynamics(
        earth,
        {DisturbanceKind::QuadraticAndFirstOrder, m.v_eb_n.norm() / hour, Vector3d::Ones(), false, DisturbanceAxes::EarthFixed},
        {earth::ecef_from_geodetic(earth.ellipsoid, m.start), C_en * m.v_eb_n, C_en * math::dcm_from_rpy(m.rpy), C_en * f_n});
    StateMatrix found = StateMatrix::Zero();
    for (const detail::SeriesEntry& e : model.F)
        found(e.row, e.column) += static_cast<double>(e.value[0]) * model.scale[static_cast<std::size_t>(e.row)] /
                                  model.scale[static_cast<std::size_t>(e.column)] / model.time_scale;
    for (int i = 0; i < Observability::most; ++i)
        for (int j = 0; j < Observability::most; ++j) {
            const bool gradient = i / 3 * 3 == velocity && j / 3 * 3 == position;
            EXPECT_NEAR(found(i, j), expected(i, j), gradient ? 0.01 * 1.54e-6 : 1e-12 * std::abs(expected(i, j)) + 1e-15)
                << i << ", " << j;
        }
}

TEST(Observability, SeriesAreTaylorSeries) {
    using detail::Series;
    const Series x = Series::line(0.3, 0.7) * Series::line(1.0, -0.2);
    const auto [s, c] = detail::sin_cos(x);
    const Series root = detail::power(x + Series(detail::Real(1)), detail::Real(-1.5));
    const double t = 0.05, at = (0.3 + 0.7 * t) * (1.0 - 0.2 * t);
    const auto sum = [t](const Series& y) {
        double out = 0.0;
        for (std::size_t n = Series::terms; n-- > 0;) out = out * t + static_cast<double>(y[n]);
        return out;
    };
    EXPECT_NEAR(sum(s), std::sin(at), 1e-15);
    EXPECT_NEAR(sum(c), std::cos(at), 1e-15);
    EXPECT_NEAR(sum(root), std::pow(1.0 + at, -1.5), 1e-15);
}

TEST(Observability, UnusableMotionsAreRefused) {
    ObservedMotion m;
    m.start.lat = 1.57;
    EXPECT_THROW((void)observability({}, m), Error);
    m = moving(Vector3d::Zero(), -1.0);
    EXPECT_THROW((void)observability({}, m), Error);
    EXPECT_THROW((void)observability({}, moving(Vector3d::Zero(), 0.0), 2.0), Error);
}

}  // namespace
}  // namespace schuler::gravimetry
