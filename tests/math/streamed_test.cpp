// Sums and quantiles that do not depend on the order in which values come.
#include "schuler/math/exact_sum.h"
#include "schuler/math/quantile.h"
#include "schuler/math/quantile_sketch.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::math {
namespace {

RC_GTEST_PROP(ExactSum, DoesNotDependOnOrderOrParts, (std::vector<std::int32_t> mantissas)) {
    std::vector<double> terms;
    for (std::size_t i = 0; i < mantissas.size(); ++i)
        terms.push_back(std::ldexp(static_cast<double>(mantissas[i]), static_cast<int>((i * 37) % 140) - 90));
    ExactSum forward, backward, parts[3];
    for (const double x : terms) forward.add(x);
    std::ranges::reverse(terms);
    for (const double x : terms) backward.add(x);
    RC_ASSERT(forward == backward);
    for (std::size_t i = 0; i < terms.size(); ++i) parts[i % 3].add(terms[i]);
    parts[1].add(parts[2]);
    parts[0].add(parts[1]);
    RC_ASSERT(parts[0] == forward);
    for (const double x : terms) forward.add(-x);
    RC_ASSERT(forward == ExactSum{});
}

TEST(ExactSum, KeepsWhatFloatingPointLoses) {
    ExactSum sum;
    sum.add(1e20);
    sum.add(1e-15);
    sum.add(-1e20);
    EXPECT_NEAR(sum.value(), 1e-15, 1e-30);
    ExactSum negative;
    negative.add(-3.25);
    EXPECT_EQ(negative.value(), -3.25);
    negative.add(1e40);
    EXPECT_TRUE(std::isinf(negative.value()));
}

TEST(QuantileSketch, ExactUpToItsBoundThenCloseAndIndependentOfOrder) {
    std::vector<double> values;
    Random random(3, "sketch");
    for (int i = 0; i < 20000; ++i) values.push_back(5.0 * random.normal());
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    QuantileSketch exact(20000, 5), coarse(1000, 5), fine(1000, 8), halves[2] = {{1000, 5}, {1000, 5}};
    for (std::size_t i = 0; i < values.size(); ++i) {
        exact.add(values[i]);
        coarse.add(values[i]);
        fine.add(values[i]);
        halves[i < 300 ? 0 : 1].add(values[i]);
    }
    for (const double p : {0.001, 0.05, 0.25, 0.75, 0.95, 0.999}) {
        const double q = quantile_of_sorted(sorted, p);
        EXPECT_EQ(exact.quantile(p), q);
        // in the bin of the value of its rank, or of its neighbour
        const auto rank = static_cast<std::size_t>(p * 19999.0);
        const double gap = sorted[rank + 1] - sorted[rank - 1];
        EXPECT_NEAR(coarse.quantile(p), q, std::abs(q) / 32.0 + gap);
        EXPECT_NEAR(fine.quantile(p), q, std::abs(q) / 256.0 + gap);
    }
    EXPECT_TRUE(exact.exact());
    EXPECT_FALSE(coarse.exact());
    EXPECT_EQ(coarse.quantile(0.0), sorted.front());
    EXPECT_EQ(coarse.quantile(1.0), sorted.back());
    halves[0].merge(halves[1]);  // exact into histogram
    EXPECT_EQ(halves[0].content(), coarse.content());
    QuantileSketch again(1000, 5);
    again.restore(coarse.content());
    EXPECT_EQ(again.quantile(0.3), coarse.quantile(0.3));
    EXPECT_EQ(again.count(), 20000u);
    EXPECT_TRUE(std::isnan(QuantileSketch().quantile(0.5)));
}

}  // namespace
}  // namespace schuler::math
