// What a gravimetrist does with the estimates: lines and levels, the classical pipeline, responses, what can be resolved.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/classical.h"
#include "schuler/gravimetry/lines.h"
#include "schuler/gravimetry/resolution.h"
#include "schuler/gravimetry/response.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::gravimetry {
namespace {

using Eigen::Vector2d;

constexpr double pi = std::numbers::pi;

/// A field that any line over it sees alike.
double field(const Vector2d& p) { return 3.0 * std::sin(p.x() / 2000.0) + 0.001 * p.y(); }

/// Straight legs through corners, a point each 50 m; leg k has an offset of its own.
std::vector<TrackPoint> zigzag(const std::vector<Vector2d>& corners, const std::vector<double>& offsets) {
    std::vector<TrackPoint> out;
    for (std::size_t k = 1; k < corners.size(); ++k) {
        const Vector2d way = corners[k] - corners[k - 1];
        const int steps = static_cast<int>(way.norm() / 50.0);
        for (int i = 0; i < steps; ++i) {
            const Vector2d p = corners[k - 1] + way * i / steps;
            out.push_back({p, std::atan2(way.y(), way.x()), field(p) + offsets[k - 1]});
        }
    }
    return out;
}

TEST(SurveyLines, LevellingFindsTheOffsetsOfCrossingLines) {
    // Three lines north, two tie lines east over them: six crossovers; the corners between them are lines too where they are long.
    // clang-format off
    const std::vector<Vector2d> corners{{0, 0},      {10000, 0},    {10000, 500},   {0, 500},       {0, 1000},
                                        {10000, 1000}, {7000, 3000}, {7000, -2000}, {3000, -2000}, {3000, 3000}};
    // clang-format on
    const std::vector<double> offsets{1.0, 0, -2.0, 0, 0.5, 0, 0.25, 0, -0.75};
    const std::vector<TrackPoint> track = zigzag(corners, offsets);
    std::vector<SurveyLine> lines = survey_lines(track, 4500.0, 5.0 * units::deg);
    ASSERT_EQ(lines.size(), 5U);
    const std::vector<Crossover> crossings = crossovers(track, lines);
    ASSERT_EQ(crossings.size(), 6U);
    EXPECT_GT(crossover_rms(lines, crossings), 1.0);
    level(lines, crossings);
    EXPECT_LT(crossover_rms(lines, crossings), 2e-3);  // of the straight lines between points
    const double truth[5] = {1.0, -2.0, 0.5, 0.25, -0.75};
    double sum = 0.0;
    for (int i = 0; i < 5; ++i) sum += truth[i] / 5.0;
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(lines[i].level, truth[i] - sum, 3e-3);
    EXPECT_TRUE(repeated_lines(track, lines, 200.0, 2000.0).empty());
}

TEST(SurveyLines, RepeatedLinesAreComparedWhicheverWayTheyWereFlown) {
    const std::vector<TrackPoint> track = zigzag({{0, 0}, {8000, 0}, {8000, 100}, {1000, 100}}, {0.0, 0.0, 1.5});
    const std::vector<SurveyLine> lines = survey_lines(track, 5000.0, 5.0 * units::deg);
    ASSERT_EQ(lines.size(), 2U);
    const std::vector<RepeatedLine> repeats = repeated_lines(track, lines, 200.0, 5000.0);
    ASSERT_EQ(repeats.size(), 1U);
    EXPECT_NEAR(repeats.front().mean, -1.5 - 0.1, 1e-3);  // and 100 m further east
    EXPECT_LT(repeats.front().deviation, 1e-3);
    EXPECT_NEAR(repeats.front().length, 7000.0, 150.0);
}

TEST(Classical, TheLowPassHalvesAHarmonicOfItsPeriod) {
    std::vector<double> t, x;
    for (int i = 0; i < 4000; ++i) {
        t.push_back(0.5 * i);
        x.push_back(std::sin(2.0 * pi * t.back() / 100.0) + 4.0);
    }
    const std::vector<double> y = low_passed(t, x, 100.0);
    for (std::size_t i = 400; i < 3600; i += 13) EXPECT_NEAR(y[i] - 4.0, 0.5 * (x[i] - 4.0), 2e-3);
}

TEST(Response, AHarmonicAndItsCorrection) {
    const double length = 700.0, gain = 0.6, lag = 0.8;
    std::vector<double> s, in, out;
    for (int i = 0; i < 3000; ++i) {
        s.push_back(3.0 * i);
        const double phase = 2.0 * pi * (s.back() - 100.0) / length;
        in.push_back(2.0 * std::sin(phase));
        out.push_back(2.0 * gain * std::sin(phase - lag));
    }
    const HarmonicResponse r = harmonic_response(s, out, length, 100.0, 2.0);
    EXPECT_NEAR(r.gain, gain, 1e-9);
    EXPECT_NEAR(r.lag, lag, 1e-9);
    EXPECT_LT(r.residual, 1e-7);
    const std::vector<double> back = corrected_for(s, out, r, length);
    for (std::size_t i = 0; i < 2900; i += 17) EXPECT_NEAR(back[i], in[i], 0.02);
    EXPECT_THROW((void)harmonic_response({1.0}, {1.0}, 10.0, 0.0, 1.0), Error);
}

TEST(Response, WidthOfAHump) {
    std::vector<double> s, y;
    for (int i = -200; i <= 200; ++i) {
        s.push_back(i);
        y.push_back(std::exp(-0.5 * std::pow((i - 3.0) / 20.0, 2)));
    }
    EXPECT_NEAR(half_width(s, y), 20.0 * 2.0 * std::sqrt(2.0 * std::numbers::ln2), 0.05);
    EXPECT_TRUE(std::isnan(half_width({0.0, 1.0, 2.0}, {1.0, 0.9, 0.8})));
}

TEST(Resolution, DensitiesHoldTheVarianceOfTheProcess) {
    // The integral of the two-sided density over all frequencies is the variance.
    for (const DisturbanceKind kind : {DisturbanceKind::FirstOrder, DisturbanceKind::SecondOrder, DisturbanceKind::ThirdOrder}) {
        const DisturbanceModel model{kind, 3000.0, Eigen::Vector3d::Constant(2e-4), false};
        double sum = 0.0;
        for (double f = 0.5e-6; f < 2.0; f += f < 0.01 ? 1e-6 : 1e-4)
            sum += 2.0 * disturbance_density(model, 60.0, f) * (f < 0.01 ? 1e-6 : 1e-4);
        EXPECT_NEAR(sum, 4e-8, 0.01 * 4e-8) << static_cast<int>(kind);
    }
}

TEST(Resolution, QuieterInstrumentsResolveShorterWaves) {
    SurveySettings s;
    s.noise = {0.0, 4e-10, 0.0, 0.0};
    s.disturbance = {DisturbanceKind::SecondOrder, 5000.0, Eigen::Vector3d::Constant(2e-4), false};
    const double period = resolved_period(s, {0.015, 0.01, 2.0, 60.0});
    EXPECT_GT(period, 40.0);
    EXPECT_LT(period, 150.0);
    EXPECT_NEAR(disturbance_density(s.disturbance, 60.0, 1.0 / period),
                noise_density(s.noise, {0.015, 0.01, 2.0, 60.0}, 1.0 / period),
                0.1 * noise_density(s.noise, {0.015, 0.01, 2.0, 60.0}, 1.0 / period));
    EXPECT_GT(resolved_period(s, {0.15, 0.1, 2.0, 60.0}), 1.5 * period);
    s.disturbance = {};
    EXPECT_TRUE(std::isnan(resolved_period(s, {0.015, 0.01, 2.0, 60.0})));
}

}  // namespace
}  // namespace schuler::gravimetry
