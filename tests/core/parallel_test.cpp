// Work shared out over threads: every piece once, failures handed on.
#include "schuler/core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <vector>

namespace schuler {
namespace {

TEST(CampaignThreads, EveryPieceOnceAndProgressGrows) {
    for (const int jobs : {0, 1, 3, 64}) {
        std::vector<int> times(50, 0);
        std::vector<double> shares;
        for_each_run(
            times.size(), jobs, [&](std::size_t k) { ++times[k]; }, [&](double share) { shares.push_back(share); });
        EXPECT_EQ(times, std::vector<int>(50, 1)) << jobs;
        ASSERT_EQ(shares.size(), 50u);
        EXPECT_TRUE(std::ranges::is_sorted(shares));
        EXPECT_EQ(shares.back(), 1.0);
    }
    for_each_run(0, 2, [](std::size_t) { FAIL(); }, {});
}

TEST(CampaignThreads, AFailureEndsTheCampaignAndReachesTheCaller) {
    std::atomic<int> done{0};
    const auto work = [&](std::size_t k) {
        if (k == 3) throw std::runtime_error("run 3");
        ++done;
    };
    try {
        for_each_run(1000000, 3, work, {});
        FAIL();
    } catch (const std::runtime_error& e) {
        EXPECT_STREQ(e.what(), "run 3");
    }
    EXPECT_LT(done, 1000000);
    EXPECT_GE(done, 3);
}

}  // namespace
}  // namespace schuler
