// The one-pass Allan deviation against its definition, and coefficients of noise that is made with them.
#include "schuler/analysis/allan.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace schuler::analysis {
namespace {

/// By the definition: differences of neighbouring means over m samples, from every `step`-th sample on.
double by_definition(const std::vector<double>& x, std::size_t m, std::size_t step) {
    std::vector<double> sums{0.0};
    for (const double v : x) sums.push_back(sums.back() + v);
    double squares = 0.0, n = 0.0;
    for (std::size_t i = 0; i + 2 * m <= x.size(); i += step, n += 1.0) {
        const double d = (sums[i + 2 * m] - 2.0 * sums[i + m] + sums[i]) / static_cast<double>(m);
        squares += d * d;
    }
    return std::sqrt(0.5 * squares / n);
}

TEST(Allan, IsThatOfTheDefinition) {
    math::Random random(7, "allan");
    std::vector<double> x;
    double walk = 9.8;
    AllanDeviation allan(0.02);
    for (int i = 0; i < 5000; ++i) {
        walk += 0.01 * random.normal();
        x.push_back(walk + random.normal());
        allan.add(x.back());
    }
    const std::vector<AllanPoint> points = allan.points();
    ASSERT_GT(points.size(), 30u);
    for (const AllanPoint& p : points) {
        const auto m = static_cast<std::size_t>(std::lround(p.tau / 0.02));
        std::size_t step = 1;
        while (m / step > 7) step *= 2;
        EXPECT_NEAR(p.deviation, by_definition(x, m, step), 1e-9) << m;
        EXPECT_NEAR(p.relative_sigma, 1.0 / std::sqrt(2.0 * (5000.0 / static_cast<double>(m) - 1.0)), 1e-12);
    }
    EXPECT_LE(points.back().tau, 5000 * 0.02 / 9);
}

TEST(Allan, CoefficientsOfKnownNoise) {
    constexpr double dt = 0.01, white = 0.3, walk = 0.02, quantization = 0.01;
    math::Random random(3, "allan");
    AllanDeviation allan(dt);
    double slow = 0.0, before = 0.0;
    for (int i = 0; i < 1'000'000; ++i) {
        slow += walk * std::sqrt(dt) * random.normal();
        const double angle = quantization * random.normal();  // error of the counted angle; the rate carries its difference
        allan.add(slow + white / std::sqrt(dt) * random.normal() + (angle - before) / dt);
        before = angle;
    }
    const AllanCoefficients c = fitted(allan.points());
    EXPECT_NEAR(c.white, white, 0.03 * white);
    EXPECT_NEAR(c.random_walk, walk, 0.25 * walk);
    EXPECT_NEAR(c.quantization, quantization, 0.06 * quantization);
    EXPECT_LT(c.bias_instability, 0.05);
    EXPECT_LT(c.ramp, 1e-3);
}

TEST(Allan, ExactCurvesGiveTheirCoefficients) {
    std::vector<AllanPoint> points;
    for (double t = 0.01; t < 1e5; t *= 1.3)
        points.push_back({t, std::sqrt(3e-12 / (t * t) + 4e-6 / t + 0.4412712 * 9e-8 + 1e-12 * t / 3 + 1e-18 * t * t / 2), 0.05});
    const AllanCoefficients c = fitted(points);
    EXPECT_NEAR(c.quantization, 1e-6, 1e-9);
    EXPECT_NEAR(c.white, 2e-3, 1e-8);
    EXPECT_NEAR(c.bias_instability, 3e-4, 1e-9);
    EXPECT_NEAR(c.random_walk, 1e-6, 1e-10);
    EXPECT_NEAR(c.ramp, 1e-9, 1e-13);
    EXPECT_EQ(fitted({}).white, 0.0);
}

}  // namespace
}  // namespace schuler::analysis
