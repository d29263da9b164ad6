// The oscillator's Allan variance against the spectrum it is made from.
#include "schuler/receiver/oscillator.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::receiver {
namespace {

using std::numbers::pi;

/// Overlapping Allan variance at m steps, mean of several runs.
double allan(const OscillatorSettings& settings, double dt, std::size_t m) {
    double sum = 0.0;
    std::size_t count = 0;
    for (int run = 0; run < 20; ++run) {
        math::Random random(static_cast<std::uint64_t>(run), "oscillator");
        Oscillator oscillator(settings, random);
        std::vector<double> x{0.0};
        for (std::size_t i = 0; i < 40 * m; ++i) {
            oscillator.step(dt, Eigen::Vector3d::Zero(), random);
            x.push_back(oscillator.offset());
        }
        const double tau = static_cast<double>(m) * dt;
        for (std::size_t i = 0; i + 2 * m < x.size(); i += m / 4 + 1, ++count)
            sum += std::pow((x[i + 2 * m] - 2.0 * x[i + m] + x[i]) / tau, 2) / 2.0;
    }
    return sum / static_cast<double>(count);
}

TEST(Oscillator, AllanVarianceOfEachNoise) {
    // [IEEE1139:table B.2]; the spread of the estimate is 3 to 8 %
    for (const std::size_t m : {5U, 100U}) {
        const double tau = 0.1 * static_cast<double>(m);
        EXPECT_NEAR(allan({1e-20, 0.0, 0.0}, 0.1, m) * 2.0 * tau / 1e-20, 1.0, 0.15) << tau;
        EXPECT_NEAR(allan({0.0, 1e-20, 0.0}, 0.1, m) / (2.0 * std::numbers::ln2 * 1e-20), 1.0, 0.20) << tau;
        EXPECT_NEAR(allan({0.0, 0.0, 1e-20}, 0.1, m) * 3.0 / (2.0 * pi * pi * tau * 1e-20), 1.0, 0.20) << tau;
    }
}

TEST(Oscillator, RandomWalkIsTheSameInOneStepAndInMany) {
    // Variance of the phase after a second: q t^3 / 3 with q = 2 pi^2 h_2, whatever the steps.
    for (const int steps : {1, 20}) {
        double square = 0.0;
        constexpr int runs = 4000;
        math::Random random(7, "walk");
        for (int run = 0; run < runs; ++run) {
            Oscillator oscillator({0.0, 0.0, 1e-20}, random);
            for (int i = 0; i < steps; ++i) oscillator.step(1.0 / steps, Eigen::Vector3d::Zero(), random);
            square += oscillator.offset() * oscillator.offset() / runs;
        }
        EXPECT_NEAR(square / (2.0 * pi * pi * 1e-20 / 3.0), 1.0, 0.08) << steps;
    }
}

TEST(Oscillator, AccelerationShiftsTheFrequency) {
    OscillatorSettings settings{0.0, 0.0, 0.0};
    settings.g_sensitivity = Eigen::Vector3d(1e-9, -2e-9, 0.5e-9) / units::g0;
    math::Random random(1, "g");
    Oscillator oscillator(settings, random);
    oscillator.step(2.0, units::g0 * Eigen::Vector3d(10.0, 1.0, 2.0), random);
    EXPECT_NEAR(oscillator.drift(), 9e-9, 1e-20);
    EXPECT_NEAR(oscillator.offset(), 18e-9, 1e-20);
    settings.h_1 = -1.0;
    EXPECT_THROW(Oscillator(settings, random), Error);
}

}  // namespace
}  // namespace schuler::receiver
