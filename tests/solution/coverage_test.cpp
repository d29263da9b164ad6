// Windows without fixes, what is counted in them, and noise that is missing by a known factor.
#include "schuler/solution/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace schuler::solution {
namespace {

std::vector<CheckFix> fixes_every(double step, double length) {
    std::vector<CheckFix> fixes;
    for (double t = 0.0; t <= length; t += step) fixes.push_back({t, true, true});
    return fixes;
}

bool overlap(const fusion::Outage& a, const fusion::Outage& b) {
    return a.start < b.start + b.duration && b.start < a.start + a.duration;
}

// The length follows the log: eight windows of the longest that gives them, with a pause of a window's length between two.
TEST(Coverage, WindowsFitTheLog) {
    struct Case {
        double length, window;
    };
    for (const Case c : {Case{40.0, 0.0}, Case{150.0, 5.0}, Case{400.0, 15.0}, Case{1500.0, 60.0}}) {
        const CheckWindows w = check_windows(fixes_every(1.0, c.length), 20.0, c.length, {});
        ASSERT_EQ(w.why_none.empty(), c.window > 0.0) << c.length << ": " << w.why_none;
        if (c.window == 0.0) continue;
        EXPECT_EQ(w.length, c.window) << c.length;
        EXPECT_GE(w.windows.size(), 4U);
        EXPECT_GE(w.windows.front().start, 20.0);
        for (std::size_t i = 1; i < w.windows.size(); ++i) EXPECT_GE(w.windows[i].start - w.windows[i - 1].start, 2.0 * w.length);
    }
    EXPECT_FALSE(check_windows({}, 0.0, 1000.0, {}).why_none.empty());
}

TEST(Coverage, FixesOfVagueSigmasJudgeNothing) {
    std::vector<CheckFix> fixes = fixes_every(1.0, 9.0);
    leave_out_vague(fixes, {0.02, 0.02, 2.0, 29.0, 31.0, 0.02, NAN, 3e4, 0.02, 0.02});
    for (std::size_t i = 0; i < fixes.size(); ++i) EXPECT_EQ(fixes[i].good, i != 4 && i != 7) << i;
    // a receiver that is usually vague, and states no sigma now and then
    fixes = fixes_every(1.0, 6.0);
    leave_out_vague(fixes, {NAN, 10.0, 99.0, 101.0, 10.0, NAN, 10.0});
    for (std::size_t i = 0; i < fixes.size(); ++i) EXPECT_EQ(fixes[i].good, i != 3) << i;
    fixes = fixes_every(1.0, 1.0);
    leave_out_vague(fixes, {NAN, NAN});
    EXPECT_TRUE(fixes[0].good && fixes[1].good);
}

TEST(Coverage, WindowsAvoidOutagesAndBadFixes) {
    std::vector<CheckFix> fixes = fixes_every(0.5, 600.0);
    for (CheckFix& f : fixes) f.good = std::fmod(f.t, 37.0) < 24.0;
    const std::vector<fusion::Outage> outages{{100.0, 30.0}};
    const CheckWindows w = check_windows(fixes, 20.0, 600.0, outages);
    ASSERT_GE(w.windows.size(), 8U);
    for (const fusion::Outage& o : w.windows) {
        EXPECT_FALSE(overlap(o, {97.0, 36.0})) << o.start;  // with three seconds of fixes before and after
        const auto good = std::ranges::count_if(
            fixes, [&](const CheckFix& f) { return f.good && f.t > o.start && f.t < o.start + o.duration; });
        EXPECT_GT(static_cast<double>(good), o.duration) << o.start;  // of two fixes a second
    }
    std::erase_if(fixes, [](const CheckFix& f) { return f.t > 60.0; });  // a receiver that falls silent
    EXPECT_FALSE(check_windows(fixes, 20.0, 600.0, {}).why_none.empty());
}

// Standing still is known: where there are windows enough in motion, it is motion that is judged.
TEST(Coverage, WindowsAreInMotionWhereThereIsEnoughOfIt) {
    std::vector<CheckFix> fixes = fixes_every(1.0, 1000.0);
    for (CheckFix& f : fixes) f.moving = f.t > 600.0;
    const CheckWindows some = check_windows(fixes, 20.0, 1000.0, {});
    EXPECT_EQ(some.length, 15.0);
    EXPECT_GT(some.windows.front().start, 590.0);
    for (CheckFix& f : fixes) f.moving = f.t > 970.0;
    const CheckWindows none = check_windows(fixes, 20.0, 1000.0, {});
    EXPECT_EQ(none.length, 60.0);
    EXPECT_LT(none.windows.front().start, 60.0);
}

TEST(Coverage, CountsByHand) {
    // two windows of two fixes; the first leaves three sigma in height once, the second in east at its end
    const auto epoch = [](std::size_t window, double since, Eigen::Vector3d error) {
        return WithheldEpoch{window, since, Regime::Turning, error, {1.0, 1.0, 2.0}, {0.5, 0.5, 1.0}};
    };
    const std::vector<WithheldEpoch> epochs{epoch(0, 1.0, {0.0, 0.0, 6.5}), epoch(0, 5.0, {3.0, -2.9, 0.0}),
                                            epoch(1, 1.0, {0.1, 0.1, 0.1}), epoch(1, 5.0, {0.0, 4.0, 0.0})};
    const Coverage c = coverage_of(epochs, 5.0);
    EXPECT_EQ(c.epochs.epochs, 4U);
    EXPECT_EQ(c.epochs.inside, 2U);
    EXPECT_EQ(c.horizontal.inside, 3U);
    EXPECT_EQ(c.vertical.inside, 3U);
    EXPECT_EQ(c.windows.epochs, 2U);
    EXPECT_EQ(c.windows.inside, 1U);
    EXPECT_NEAR(c.end_rms, std::sqrt((9.0 + 2.9 * 2.9 + 16.0) / 2.0), 1e-12);
    EXPECT_NEAR(c.sigma_rms, std::sqrt(2.0), 1e-12);
    ASSERT_EQ(c.growth.size(), 2U);
    EXPECT_NEAR(c.growth[1].since, 5.0, 1e-12);
    EXPECT_EQ(c.by_regime[static_cast<std::size_t>(Regime::Turning)].epochs, 4U);
    EXPECT_FALSE(covers(c));
}

/// Free inertial errors in many windows, drawn with variance growth accel * t^3 / 3 + gyro * g^2 t^5 / 20 and a fix of 0.3 m, of which the
/// filter says `told` of each.
std::vector<WithheldEpoch> drawn(double accel, double gyro, double told_accel, double told_gyro, std::size_t windows = 60) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::vector<WithheldEpoch> epochs;
    for (std::size_t w = 0; w < windows; ++w) {
        const Eigen::Vector2d a(normal(random), normal(random)), b(normal(random), normal(random));
        for (double t = 1.0; t <= 15.0; t += 1.0) {
            const double from_accel = std::sqrt(t * t * t / 3.0), from_gyro = 9.8 * std::sqrt(std::pow(t, 5) / 20.0);
            WithheldEpoch e{w, t, Regime::Straight, {}, {}, {}};
            e.error.setZero();
            for (int i = 0; i < 2; ++i) e.error(i) = accel * from_accel * a(i) + gyro * from_gyro * b(i) + 0.3 * normal(random);
            const double own = std::hypot(told_accel * from_accel, told_gyro * from_gyro);
            e.sigma_state = {own, own, 0.0};
            e.sigma = {std::hypot(own, 0.3), std::hypot(own, 0.3), 0.0};
            epochs.push_back(e);
        }
    }
    return epochs;
}

TEST(MissingNoise, OfAnHonestFilterIsNone) {
    const std::vector<WithheldEpoch> honest = drawn(0.05, 0.002, 0.05, 0.002), modest = drawn(0.05, 0.002, 0.15, 0.006);
    EXPECT_TRUE(covers(coverage_of(honest, 15.0)));
    const NoiseScale none = missing_noise(honest), modest_one = missing_noise(modest);
    EXPECT_LT(none.gyro, 1.25);
    EXPECT_LT(none.accel, 1.25);
    EXPECT_TRUE(modest_one.is_one());
}

TEST(MissingNoise, IsFoundInSize) {
    for (const double k : {2.0, 4.0}) {
        const std::vector<WithheldEpoch> epochs = drawn(0.05, 0.002, 0.05 / k, 0.002 / k);
        EXPECT_LT(coverage_of(epochs, 15.0).epochs.share(), wanted_coverage);
        const NoiseScale found = missing_noise(epochs);
        EXPECT_NEAR(std::log(found.gyro), std::log(std::pow(k, 1.0 / 0.85)), 0.3) << k;  // larger by a sigma and rounding up
        EXPECT_GE(found.gyro, 0.9 * k);
        EXPECT_NEAR(std::log(found.accel), std::log(std::pow(k, 1.0 / 0.85)), 0.5) << k;
    }
    EXPECT_LE(missing_noise(drawn(0.05, 0.002, 0.05 / 100.0, 0.002 / 100.0)).gyro, NoiseScale::most);
}

// Only the gyros are worse than told: the growth shows it.
TEST(MissingNoise, TellsGyrosFromAccelerometers) {
    const NoiseScale found = missing_noise(drawn(0.2, 0.004, 0.2, 0.001, 200));
    EXPECT_TRUE(found.apart);
    EXPECT_GT(found.gyro, 3.0);
    EXPECT_LT(found.accel, 0.5 * found.gyro);
}

// An increase is adopted where it makes the sigmas truer, and never where the filter diverges with it in any of the windows.
TEST(Coverage, AnIncreaseThatHarmsAnyWindowsIsNotAdopted) {
    const auto windows = [](std::size_t inside, double end) {
        Coverage c;
        c.epochs = c.horizontal = c.vertical = {100, inside};
        c.held = {10, inside / 10};
        c.end_rms = end;
        return c;
    };
    const Coverage poor = windows(90, 3.0), good = windows(100, 3.5), far = windows(100, 40.0);
    EXPECT_TRUE(was_missing({poor, good}, {poor, good}));
    EXPECT_FALSE(was_missing({good, poor}, {poor, good}));
    EXPECT_FALSE(was_missing({poor, far}, {poor, good}));
    EXPECT_FALSE(was_missing({poor, good}, {poor, far}));
    EXPECT_FALSE(was_missing({poor, good}, {poor, windows(100, std::nan(""))}));
    EXPECT_TRUE(was_missing({good, good}, {poor, good}));  // the manoeuvre was in the other windows
    EXPECT_FALSE(was_missing({good, good}, {good, good}));
    // Few windows may have twice the errors by chance: that is no harm where the sigmas cover them.
    const Coverage twice = windows(100, 7.0), half_lost = windows(50, 7.0);
    EXPECT_TRUE(was_missing({good, twice}, {poor, good}));
    EXPECT_FALSE(was_missing({windows(40, 3.5), half_lost}, {poor, good}));
    EXPECT_FALSE(was_missing({poor, good}, {poor, twice}));
    // Heights that a barometer supports are not what the noise is for, neither for it nor against it.
    Coverage before = good, after = good;
    before.epochs = after.epochs = before.vertical = after.vertical = {100, 85};
    EXPECT_FALSE(was_missing({before, after}, {poor, good}));
    EXPECT_TRUE(was_missing({before, after, 2}, {poor, good, 2}));
}

}  // namespace
}  // namespace schuler::solution
