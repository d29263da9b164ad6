// Decimation keeps what a reviewer looks for: extremes, ends, and all of a short series.
#include "schuler/report/decimate.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace {

using schuler::report::decimate;

std::vector<double> counting(std::size_t n) {
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<double>(i);
    return x;
}

TEST(Decimate, ShortSeriesStayWholeButForWhatIsNotFinite) {
    const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
    const std::vector<double> x{0, 1, 2, 3, 4, 5}, y{1, nan, 2, inf, 3, 4};
    const std::array<std::span<const double>, 2> channels{x, y};
    EXPECT_EQ(decimate(channels, 4), (std::vector<std::size_t>{0, 2, 4, 5}));
    EXPECT_TRUE(decimate({}, 10).empty());
    const std::vector<double> none;
    const std::array<std::span<const double>, 1> empty{none};
    EXPECT_TRUE(decimate(empty, 10).empty());
}

TEST(Decimate, OneSampleWideSpikesSurviveWhereverTheyAre) {
    const std::size_t n = 100000;
    const std::vector<double> x = counting(n);
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) y[i] = std::sin(1e-3 * static_cast<double>(i));
    for (std::size_t at = 17; at < n; at += 997) y[at] = at % 2 == 0 ? 5.0 : -5.0;
    const std::array<std::span<const double>, 2> channels{x, y};
    const std::vector<std::size_t> kept = decimate(channels, 2000);
    EXPECT_LE(kept.size(), 2002U);
    for (std::size_t at = 17; at < n; at += 997) EXPECT_TRUE(std::binary_search(kept.begin(), kept.end(), at)) << at;
}

RC_GTEST_PROP(Decimate, WithoutGapsTheSameAsByTheRule, ()) {
    const std::size_t n = *rc::gen::inRange<std::size_t>(1, 3000), most = *rc::gen::inRange<std::size_t>(4, 400);
    // few values: many equal ones, of which the first least and the last greatest are kept
    const std::vector<double> y =
        *rc::gen::container<std::vector<double>>(n, rc::gen::map(rc::gen::inRange(-3, 4), [](int v) { return 0.5 * v; }));
    const std::array<std::span<const double>, 1> channels{y};
    std::vector<std::size_t> expected;
    if (n <= most) {
        for (std::size_t i = 0; i < n; ++i) expected.push_back(i);
    } else {
        expected = {0, n - 1};
        const std::size_t buckets = most / 2;
        for (std::size_t b = 0; b < buckets; ++b) {
            const auto first = y.begin() + static_cast<std::ptrdiff_t>(b * n / buckets);
            const auto last = y.begin() + static_cast<std::ptrdiff_t>((b + 1) * n / buckets);
            if (first == last) continue;
            const auto [low, high] = std::minmax_element(first, last);
            expected.push_back(static_cast<std::size_t>(low - y.begin()));
            expected.push_back(static_cast<std::size_t>(high - y.begin()));
        }
        std::sort(expected.begin(), expected.end());
        expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    }
    RC_ASSERT(decimate(channels, most) == expected);
}

RC_GTEST_PROP(Decimate, KeepsEndsAndExtremesInOrder, ()) {
    const std::size_t n = *rc::gen::inRange<std::size_t>(1, 3000);
    const std::size_t most = *rc::gen::inRange<std::size_t>(4, 400);
    const std::vector<double> x = counting(n);
    std::vector<double> y = *rc::gen::container<std::vector<double>>(
        n, rc::gen::map(rc::gen::inRange(-1000, 1000), [](int v) { return v < -990 ? std::nan("") : 0.25 * v; }));
    const std::array<std::span<const double>, 2> channels{x, y};
    const std::vector<std::size_t> kept = decimate(channels, most);

    std::vector<std::size_t> finite;
    for (std::size_t i = 0; i < n; ++i) {
        if (std::isfinite(y[i])) finite.push_back(i);
    }
    RC_ASSERT(kept.empty() == finite.empty());
    if (finite.empty()) return;
    RC_ASSERT(kept.size() <= most + 2);
    RC_ASSERT(std::adjacent_find(kept.begin(), kept.end(), std::greater_equal<>()) == kept.end());
    RC_ASSERT(kept.front() == finite.front());
    RC_ASSERT(kept.back() == finite.back());
    const auto less = [&y](std::size_t i, std::size_t j) { return y[i] < y[j]; };
    const auto all = std::minmax_element(finite.begin(), finite.end(), less);
    const auto few = std::minmax_element(kept.begin(), kept.end(), less);
    RC_ASSERT(y[*all.first] == y[*few.first]);
    RC_ASSERT(y[*all.second] == y[*few.second]);
    // No finite stretch as long as two buckets goes unseen.
    const std::size_t bucket = finite.size() / std::max<std::size_t>(1, most / 4) + 1;
    for (std::size_t k = 1; k < kept.size(); ++k) {
        const auto a = std::lower_bound(finite.begin(), finite.end(), kept[k - 1]);
        const auto b = std::lower_bound(finite.begin(), finite.end(), kept[k]);
        RC_ASSERT(static_cast<std::size_t>(b - a) <= bucket);
    }
}

}  // namespace
