// Spectra of series whose density is known.
#include "schuler/math/spectrum.h"
#include "schuler/core/error.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace schuler::math {
namespace {

TEST(Spectrum, WhiteNoiseIsFlatAndASineHasItsPower) {
    constexpr double rate = 200.0, sigma = 0.7, amplitude = 3.0, line = 25.0;
    Random random(11, "spectrum");
    Spectrum noise(rate, 1024), sine(rate, 1024);
    for (int i = 0; i < 400'000; ++i) {
        noise.add(5.0 + sigma * random.normal());
        sine.add(amplitude * std::sin(2.0 * std::numbers::pi * line * i / rate));
    }
    EXPECT_EQ(noise.segments(), 780u);
    const std::vector<double> density = noise.density(), peak = sine.density();
    for (std::size_t first = 8; first + 64 <= density.size(); first += 64) {
        const double mean =
            std::accumulate(density.begin() + static_cast<long>(first), density.begin() + static_cast<long>(first) + 64, 0.0) /
            64.0;
        EXPECT_NEAR(mean, 2.0 * sigma * sigma / rate, 0.03 * 2.0 * sigma * sigma / rate);
    }
    const double bin = rate / 1024.0, power = bin * std::accumulate(peak.begin(), peak.end(), 0.0);
    EXPECT_NEAR(power, amplitude * amplitude / 2.0, 1e-6);
    const auto highest = static_cast<std::size_t>(std::max_element(peak.begin(), peak.end()) - peak.begin());
    EXPECT_NEAR(sine.frequency(highest), line, 1e-9);
    EXPECT_LT(peak[highest + 3], 1e-20 * peak[highest]);  // Hann's window ends after its neighbours on a line of its own
}

TEST(Spectrum, RefusesWhatHasNoTransform) {
    EXPECT_THROW(Spectrum(100.0, 1000), Error);
    EXPECT_THROW(Spectrum(0.0, 1024), Error);
    EXPECT_TRUE(Spectrum(1.0, 8).density().empty());
}

}  // namespace
}  // namespace schuler::math
