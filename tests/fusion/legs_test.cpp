// Logs with pauses: each leg is navigated by itself, begun from the last one.
#include "schuler/fusion/legs.h"

#include "fusion/car_drive.h"

#include <gtest/gtest.h>

namespace schuler::fusion::testing {
namespace {

/// The drive, with everything from `at` on (s of the scenario) later by `pause`.
Recording paused(Recording r, double at, double pause) {
    const auto later = [&](auto& log) {
        for (auto& s : log)
            if (s.time.seconds() >= 1000.0 + at) s.time = s.time + Duration::from_seconds(pause);
    };
    later(r.imu);
    later(r.gnss);
    later(r.reference);
    return r;
}

/// The drive, with nothing logged for some time.
Recording without(Recording r, double at, double seconds) {
    const auto lose = [&](auto& log) {
        std::erase_if(log,
                      [&](const auto& s) { return s.time.seconds() >= 1000.0 + at && s.time.seconds() < 1000.0 + at + seconds; });
    };
    lose(r.imu);
    lose(r.gnss);
    return r;
}

class Legs : public ::testing::Test {
protected:
    sim::Scenario scenario = town_drive(11, 2.0, 200.0);
    Recording whole = sim::simulate(scenario).recording;
    Settings settings = settings_of(scenario);

    void SetUp() override {
        give_start(settings, whole, 11);
        settings.smooth = true;
    }
};

TEST_F(Legs, BeginAfterPausesOnly) {
    EXPECT_EQ(leg_starts(whole).size(), 1u);
    for (const double seconds : {1.0, 60.0}) EXPECT_EQ(leg_starts(without(whole, 100.0, seconds)).size(), 1u) << seconds;
    const Recording r = paused(whole, 100.0, 604800.0);
    const std::vector<Time> starts = leg_starts(r);
    ASSERT_EQ(starts.size(), 2u);
    const Recording first = leg_of(r, starts, 0), second = leg_of(r, starts, 1);
    EXPECT_EQ(first.imu.size() + second.imu.size(), r.imu.size());
    EXPECT_EQ(first.gnss.size() + second.gnss.size(), r.gnss.size());
    EXPECT_EQ(second.imu.front().time, starts[1]);
}

TEST_F(Legs, AnHoursPauseIsNotBridged) {
    const Recording r = paused(whole, 100.0, 3600.0);
    WarningLog warnings;
    const Result result = run_filter(r, settings, warnings);
    ASSERT_EQ(result.legs.size(), 2u);
    EXPECT_EQ(result.counters.imu_epochs, r.imu.size());
    for (const auto* rows : {&result.forward.rows, &result.smoothed.rows}) {
        const auto e = errors(settings, *rows, r);
        EXPECT_LT(rms(e, 15.0).position, 3.0);
        double outside = 0.0, n = 0.0;
        for (const analysis::ErrorRow& row : e) {
            n += 1.0;
            outside += (row.position.array().abs() > 3.5 * row.std_position.array()).any() ? 1.0 : 0.0;
        }
        EXPECT_LT(outside / n, 0.03);
    }
    // no row in between
    for (const SolutionRow& row : result.forward.rows)
        EXPECT_TRUE(row.time.seconds() < 1101.0 || row.time >= result.legs[1]) << row.time.seconds();
}

/// The clock of both logs is set under way: what lies between is no time, which a bridge would drive on through.
TEST_F(Legs, AClockThatIsSetBeginsOneWithTheAttitudeOfTheLast) {
    settings.smooth = false;
    const double usual = rms(errors(settings, fuse(whole, settings).forward.rows, whole), 15.0).position;
    const auto fastest =
        std::ranges::max_element(whole.reference, {}, [](const ReferenceSample& s) { return s.velocity_n.norm(); });
    for (const double step : {1.0, 20.0}) {
        const Recording r = paused(whole, fastest->time.seconds() - 1000.0, step);
        const Result result = fuse(r, settings);
        ASSERT_EQ(result.legs.size(), 2u);
        const auto e = errors(settings, result.forward.rows, r);
        EXPECT_LT(rms(e, 15.0).position, 1.5 * usual) << step;
        for (const analysis::ErrorRow& row : e)
            EXPECT_TRUE((row.position.array().abs() < 5.0 * row.std_position.array()).all()) << row.time.seconds();
    }
}

TEST_F(Legs, OutagesKeepTheirTimes) {
    const Recording r = paused(whole, 100.0, 3600.0);
    settings.smooth = false;
    settings.outages = {{3600.0 + 150.0, 10.0}};
    const Result result = fuse(r, settings);
    EXPECT_EQ(result.counters.gnss_withheld, 19u);  // the ends of an outage are used
    ASSERT_FALSE(result.forward.outage_epochs.empty());
    EXPECT_NEAR((result.forward.outage_epochs.front().time - r.gnss.front().time).seconds(), 3750.0, 0.6);
}

TEST_F(Legs, OneWithoutFixesIsLeftOut) {
    Recording r = paused(whole, 100.0, 3600.0);
    std::erase_if(r.gnss, [](const GnssFix& f) { return f.time.seconds() > 2000.0; });
    settings.smooth = false;
    WarningLog warnings;
    const Result result = run_filter(r, settings, warnings);
    EXPECT_EQ(result.legs.size(), 1u);
    EXPECT_LT(result.forward.rows.back().time.seconds(), 1200.0);
    EXPECT_EQ(warnings.count("legs.left_out"), 1u);
}

}  // namespace
}  // namespace schuler::fusion::testing
