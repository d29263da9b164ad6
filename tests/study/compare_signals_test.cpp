// What a receiver's channels did in a jammed, against patterns of lock that tell it by themselves.
#include "schuler/study/comparison/compare.h"

#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/study/comparison/compare_windows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace schuler::study {
namespace {

// 115 s in whole nanoseconds are more than 115 by the last digit: an end that rows hit as well as they can.
constexpr double begin = 94.7;
const settings::CompareWindow jammed{"jammed", begin + 10.1, 115.0};

/// From begin on the strength falls by 1 dB a second from 45 dB-Hz, for 30 s; `code`: how many are followed then, of `heard`.
WindowStatistics of(const std::function<int(double)>& code, int heard = 6, double end = 30.0) {
    const Time origin = Time::from_gps(2300, 345600.123456789);
    std::vector<scenario::ReceiverRow> rows;
    for (int i = 0; i <= std::lround(10.0 * end); ++i) {
        const double t = i / 10.0;
        rows.push_back({origin + Duration::from_seconds(begin + t), 45.0 - t, not_given, heard, code(t + 1e-9), 0});
    }
    WindowStatistics out;
    add_signal_statistics(out, jammed, rows, origin);
    return out;
}

TEST(CompareSignals, ItHeldDownToTheLowestStrengthWithFourFollowed) {
    EXPECT_NEAR(of([](double t) { return t < 14.35 || t > 16.0 ? 4 : 3; }).held, 45.0 - 20.3, 1e-9);  // the end belongs to it
    EXPECT_NEAR(of([](double t) { return t < 14.35 ? 4 : 3; }).held, 45.0 - 14.3, 1e-9);
    EXPECT_NEAR(of([](double t) { return t < 10.15 ? 4 : 3; }).held, 45.0 - 10.1, 1e-9);  // and the beginning
    EXPECT_TRUE(std::isnan(of([](double t) { return t < 10.05 || t > 20.35 ? 6 : 3; }).held));
    EXPECT_TRUE(std::isnan(of([](double) { return 4; }, 3).held));  // a channel without a signal does not count
}

TEST(CompareSignals, ItIsBackWhenFourOrAllThereAreStayForASecond) {
    const auto from = [](double start, int many) { return [=](double t) { return t < start ? many - 1 : many; }; };
    EXPECT_NEAR(of(from(22.35, 4)).back, 2.1, 1e-9);
    EXPECT_EQ(of(from(20.25, 4)).back, 0.0);
    EXPECT_EQ(of(from(0.0, 4)).back, 0.0);
    // 0.9 s is too short
    EXPECT_NEAR(of([](double t) { return (t > 20.85 && t < 21.85) || t > 23.75 ? 4 : 3; }).back, 3.5, 1e-9);
    EXPECT_NEAR(of([](double t) { return (t > 20.85 && t < 21.95) || t > 23.75 ? 4 : 3; }).back, 0.6, 1e-9);
    EXPECT_NEAR(of(from(22.35, 2), 2).back, 2.1, 1e-9);
    EXPECT_TRUE(std::isnan(of(from(22.35, 0), 0).back));
    EXPECT_TRUE(std::isnan(of(from(29.05, 4)).back));
    EXPECT_NEAR(of(from(28.95, 4)).back, 8.7, 1e-9);  // the last second of the flight
}

}  // namespace
}  // namespace schuler::study
