#include "schuler/math/random.h"

#include "schuler/math/chi_square.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace schuler::math {
namespace {

TEST(Random, StreamsRepeatAndDifferBySeedAndChannel) {
    Random a(7, "imu.gyro"), again(7, "imu.gyro"), seed(8, "imu.gyro"), channel(7, "imu.accel");
    int equal_seed = 0, equal_channel = 0;
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t bits = a.bits();
        EXPECT_EQ(bits, again.bits());
        equal_seed += bits == seed.bits();
        equal_channel += bits == channel.bits();
    }
    EXPECT_EQ(equal_seed + equal_channel, 0);
}

// Computed by an independent program from the published definitions: FNV-1a of the name, splitmix64, xoshiro256++.
TEST(Random, IntegersAreTheSameEverywhere) {
    Random r(1, "gnss");
    EXPECT_EQ(r.bits(), 12051692680880576658ULL);
    EXPECT_EQ(r.bits(), 6532399291843254448ULL);
    EXPECT_EQ(r.bits(), 12262174777470241905ULL);
}

TEST(Random, UniformFillsItsBinsEvenly) {
    Random r(3, "uniform");
    std::array<int, 50> bins{};
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const double u = r.uniform();
        ASSERT_GE(u, 0.0);
        ASSERT_LT(u, 1.0);
        ++bins[static_cast<std::size_t>(50.0 * u)];
    }
    double statistic = 0.0;
    for (const int count : bins) statistic += std::pow(count - n / 50.0, 2) / (n / 50.0);
    EXPECT_LT(statistic, chi_square_quantile(0.9999, 49));
    EXPECT_GT(statistic, chi_square_quantile(0.0001, 49));
}

TEST(Random, NormalHasTheNormalDistributionAndNoMemory) {
    Random r(4, "normal");
    // Bins of equal probability by the error function, which the generator does not use.
    const int n = 200000, cells = 100;
    std::vector<int> bins(cells, 0);
    double neighbours = 0.0, before = 0.0;
    for (int i = 0; i < n; ++i) {
        const double x = r.normal();
        const double p = 0.5 * std::erfc(-x / std::sqrt(2.0));
        ++bins[static_cast<std::size_t>(std::min(p * cells, cells - 1.0))];
        neighbours += x * before;
        before = x;
    }
    double statistic = 0.0;
    const double expected = static_cast<double>(n) / cells;
    for (const int count : bins) statistic += std::pow(count - expected, 2) / expected;
    EXPECT_LT(statistic, chi_square_quantile(0.9999, cells - 1));
    EXPECT_GT(statistic, chi_square_quantile(0.0001, cells - 1));
    EXPECT_LT(std::abs(neighbours) / std::sqrt(n), 4.0);
}

}  // namespace
}  // namespace schuler::math
