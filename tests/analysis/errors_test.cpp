#include "schuler/analysis/errors.h"
#include "schuler/analysis/reference_point.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>

#include <cmath>
#include <numbers>

namespace schuler::analysis {
namespace {

using Eigen::Vector3d;

using units::deg;
const earth::Earth wgs;
const Geodetic home{52.0 * deg, 13.0 * deg, 40.0};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Time at(double s) { return Time::from_seconds(s); }

Geodetic place(double east, double north, double up) {
    const GeographicLib::LocalCartesian local(home.lat / deg, home.lon / deg, home.h);
    double lat, lon, h;
    local.Reverse(east, north, up, lat, lon, h);
    return {lat * deg, lon * deg, h};
}

SolutionRow row(double t, const Geodetic& position, const Vector3d& v_n = Vector3d::Zero(),
                const Vector3d& rpy = Vector3d::Zero()) {
    return {at(t), position, v_n, rpy, {1.0, 2.0, 3.0}, {0.1, 0.2, 0.3}, {0.01, 0.02, 0.03}};
}

ReferenceSample truth(double t, const Geodetic& position, const Vector3d& v_n = Vector3d::Zero(),
                      const Vector3d& rpy = Vector3d::Zero()) {
    ReferenceSample s;
    s.time = at(t);
    s.position = position;
    s.velocity_n = v_n;
    s.rpy = rpy;
    return s;
}

TEST(ErrorBetween, IsEstimateMinusReferenceInEastNorthUp) {
    const ErrorRow e = error_between(wgs, row(0, place(3.0, -4.0, 12.0), {1.0, 2.0, 3.0}, {-179.0 * deg, 2.0 * deg, 1.0 * deg}),
                                     truth(0, home, {0.5, 2.5, 1.0}, {179.0 * deg, 5.0 * deg, 359.0 * deg}), Vector3d::Zero());
    EXPECT_LT((e.position - Vector3d(3.0, -4.0, 12.0)).norm(), 1e-4);  // linear in the angles: curvature over 5 m and 12 m
    EXPECT_LT((e.velocity - Vector3d(-0.5, 0.5, -2.0)).norm(), 1e-14);
    EXPECT_LT((e.rpy - Vector3d(2.0, -3.0, 2.0) * deg).norm(), 1e-13);
    EXPECT_EQ(e.std_position, Vector3d(2.0, 1.0, 3.0));
    EXPECT_EQ(e.std_velocity, Vector3d(0.2, 0.1, 0.3));
}

/// Near the vertical, where roll and heading differ by anything for a small turn, errors stay as small as the turn.
TEST(ErrorBetween, OfASteepAttitudeIsThatOfTheRotation) {
    const Vector3d rpy(0.3, 89.99 * deg, 1.0), other(0.3 + 0.8, 89.98 * deg, 1.0 + 0.8);
    const ErrorRow e =
        error_between(wgs, row(0.0, home, Vector3d::Zero(), other), truth(0.0, home, Vector3d::Zero(), rpy), Vector3d::Zero());
    EXPECT_LT(e.rpy.norm(), 0.002);
    EXPECT_GT(e.rpy.norm(), 1e-5);
    const ErrorRow turned = error_between(wgs, row(0.0, home, Vector3d::Zero(), rpy + Vector3d(0.01, 0, 0)),
                                          truth(0.0, home, Vector3d::Zero(), rpy), Vector3d::Zero());
    EXPECT_NEAR(turned.rpy.x(), 0.01, 1e-6);
}

TEST(ErrorBetween, LeverArmMovesTheEstimateToTheReference) {
    // Heading east, banked right by 90 deg: forward is east, right points down, down points to the left, north.
    const Vector3d rpy(90.0 * deg, 0.0, 90.0 * deg);
    const ErrorRow e = error_between(wgs, row(0, home, Vector3d::Zero(), rpy), truth(0, home), Vector3d(1.0, 2.0, 3.0));
    EXPECT_LT((e.position - Vector3d(1.0, 3.0, -2.0)).norm(), 1e-5);
    EXPECT_TRUE(e.velocity.array().isNaN().all());
}

/// A body that turns about the vertical at a constant rate: the point describes a circle, with rate times arm as its velocity.
TEST(ReferenceAt, APointOfATurningBodyDescribesACircle) {
    constexpr double rate = 0.4;
    const Vector3d lever_b(3.0, 1.0, -2.0), v_n(1.0, -2.0, 0.5);
    std::vector<ReferenceSample> reference;
    for (const double t : {0.0, 0.5, 0.75, 1.5, 5.0, 6.0, 7.0}) reference.push_back(truth(t, home, v_n, {0.0, 0.0, rate * t}));
    reference[5].rpy.z() = nan;
    const std::vector<ReferenceSample> moved = reference_at(wgs, reference, lever_b);
    ASSERT_EQ(moved.size(), 6u);  // without the one that has no heading
    for (const ReferenceSample& s : moved) {
        const double heading = rate * s.time.seconds(), c = std::cos(heading), sn = std::sin(heading);
        const Vector3d lever_n(c * 3.0 - sn * 1.0, sn * 3.0 + c * 1.0, -2.0);
        EXPECT_LT((earth::ned_difference(wgs, s.position, home) - lever_n).norm(), 1e-5);
        const bool between_neighbours = s.time.seconds() > 0.2 && s.time.seconds() < 1.2;  // the others: at an end or a gap
        EXPECT_EQ(s.velocity_n.allFinite(), between_neighbours) << s.time.seconds();
        if (!between_neighbours) continue;
        EXPECT_LT((s.velocity_n - v_n - rate * Vector3d(-lever_n.y(), lever_n.x(), 0.0)).norm(), 1e-9);
    }
    EXPECT_EQ(reference_at(wgs, reference, Vector3d::Zero()).front().velocity_n, v_n);
}

TEST(SolutionAt, InterpolatesACubicMotionExactly) {
    const auto east = [](double t) { return 1.0 + 20.0 * t - 3.0 * t * t + 0.5 * t * t * t; };
    const auto speed = [](double t) { return 20.0 - 6.0 * t + 1.5 * t * t; };
    std::vector<SolutionRow> rows;
    for (int k = 0; k < 4; ++k) {
        rows.push_back(row(k, earth::moved_by_ned(wgs, home, {0.0, east(k), 0.0}), {0.0, speed(k), 0.0},
                           {0.0, 0.0, (350.0 + 10.0 * k) * deg}));
    }
    const std::optional<SolutionRow> got = solution_at(wgs, rows, at(1.3), Duration::from_seconds(2.0));
    ASSERT_TRUE(got);
    EXPECT_NEAR(earth::ned_difference(wgs, got->position, home).y(), east(1.3), 1e-6);
    EXPECT_NEAR(got->rpy.z(), 3.0 * deg, 1e-12);  // over north
    EXPECT_NEAR(got->v_eb_n.y(), speed(1.0) + 0.3 * (speed(2.0) - speed(1.0)), 1e-12);
    EXPECT_FALSE(solution_at(wgs, rows, at(3.1), Duration::from_seconds(2.0)));
    EXPECT_FALSE(solution_at(wgs, rows, at(-0.1), Duration::from_seconds(2.0)));
    EXPECT_FALSE(solution_at(wgs, rows, at(1.3), Duration::from_seconds(0.9)));
    EXPECT_TRUE(solution_at(wgs, rows, at(3.0), Duration::from_seconds(0.9)));
}

TEST(SolutionAt, TakesTheLastOfRowsOfOneTime) {
    const std::vector<SolutionRow> rows = {row(0, home), row(1, place(1, 0, 0)), row(1, place(2, 0, 0)), row(2, place(2, 0, 0))};
    EXPECT_NEAR(solution_at(wgs, rows, at(1.0), Duration::from_seconds(2.0))->position.lon, place(2, 0, 0).lon, 1e-15);
    EXPECT_NEAR(solution_at(wgs, rows, at(1.5), Duration::from_seconds(2.0))->position.lon, place(2, 0, 0).lon, 1e-15);
}

TEST(Spread, ByHand) {
    // |v| sorted 0..20: the 95th percentile is the value of rank 19.
    std::vector<double> values;
    for (int k = 0; k <= 20; ++k) values.push_back(k % 2 == 0 ? k : -k);
    values.push_back(nan);
    const Spread s = spread_of(values);
    EXPECT_DOUBLE_EQ(s.rms, std::sqrt(2870.0 / 21.0));
    EXPECT_DOUBLE_EQ(s.p95, 19.0);
    EXPECT_DOUBLE_EQ(s.max, 20.0);
    EXPECT_DOUBLE_EQ(spread_of({1.0, -3.0}).p95, 2.9);
    EXPECT_DOUBLE_EQ(spread_of({-4.0}).p95, 4.0);
    EXPECT_TRUE(std::isnan(spread_of({nan}).rms));
}

TEST(Summary, CountsFromWhereItIsSettledAndLeavesOutWhatTheReferenceDoesNotSay) {
    std::vector<SolutionRow> rows;
    std::vector<ReferenceSample> reference;
    for (int k = 0; k <= 100; ++k) {
        const double error = k < 50 ? 100.0 : 3.0;
        const Geodetic estimate = earth::moved_by_ned(wgs, home, {4.0 / 3.0 * error, error, 0.0});
        rows.push_back(row(k, estimate, {0.0, k % 2 == 0 ? 0.1 : -0.1, 0.0}));
        reference.push_back(truth(k, home, Vector3d::Zero(), Vector3d::Constant(nan)));
    }
    const std::vector<ErrorRow> errors = errors_against(wgs, rows, reference);
    ASSERT_EQ(errors.size(), 101u);
    const ErrorSummary s = summarise(errors, at(50.0));
    EXPECT_EQ(s.epochs, 51u);
    EXPECT_NEAR(s.east.rms, 3.0, 1e-6);
    EXPECT_NEAR(s.north.max, 4.0, 1e-6);
    EXPECT_NEAR(s.horizontal.p95, 5.0, 1e-5);
    EXPECT_NEAR(s.three_d.rms, 5.0, 1e-5);
    EXPECT_NEAR(s.v_east.rms, 0.1, 1e-12);
    EXPECT_TRUE(std::isnan(s.heading.rms));
    EXPECT_NEAR(summarise(errors, at(0.0)).east.max, 100.0, 1e-6);
}

}  // namespace
}  // namespace schuler::analysis
