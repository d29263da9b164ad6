// Steps of a clock are taken out of the log that made them and of those that share its clock.
#include "schuler/dataset/clock_steps.h"

#include <gtest/gtest.h>

#include <vector>

namespace schuler::dataset {
namespace {

template <class Sample>
void put(std::vector<Sample>& log, double rate, double from_step, double step) {
    for (int i = 0; i < static_cast<int>(100.0 * rate); ++i) {
        Sample s;
        const double t = i / rate;
        s.time = Time::from_seconds(500.0 + t + (t >= from_step ? step : 0.0));
        log.push_back(s);
    }
}

template <class Sample>
double last(const std::vector<Sample>& log) {
    return log.back().time.seconds() - 500.0;
}

TEST(ClockSteps, GoWithTheLogsThatShareTheClock) {
    for (const double step : {1.0, 3600.0}) {
        Recording r;
        put(r.imu, 50.0, 40.0, step);
        put(r.gnss, 5.0, 200.0, 0.0);
        put(r.baro, 20.0, 40.0, step);  // of the same logger
        put(r.mag, 20.0, 200.0, 0.0);   // of another one
        const Recording before = r;
        put_clock_steps_back(r, {{.imu = true, .after = 39.98, .hole = step + 0.02, .seconds = step, .evidence = {}}});
        EXPECT_NEAR(last(r.imu), 99.98, 1e-6);
        EXPECT_NEAR(last(r.baro), 99.95, 1e-6);
        EXPECT_NEAR(last(r.mag), 99.95, 1e-6);
        EXPECT_NEAR(last(r.gnss), 99.8, 1e-6);
        for (std::size_t i = 1; i < r.imu.size(); ++i) ASSERT_NEAR((r.imu[i].time - r.imu[i - 1].time).seconds(), 0.02, 1e-6);
        Recording other = before;
        put_clock_steps_back(other, {{.imu = true, .after = 39.98, .hole = step + 7.0, .seconds = step, .evidence = {}}});
        EXPECT_EQ(last(other.imu), last(before.imu));
    }
}

TEST(ClockSteps, OfTheReceiverLeaveTheOthers) {
    Recording r;
    put(r.imu, 50.0, 200.0, 0.0);
    put(r.gnss, 5.0, 40.0, 1.0);
    put_clock_steps_back(r, {{.imu = false, .after = 39.8, .hole = 1.2, .seconds = 1.0, .evidence = {}}});
    EXPECT_NEAR(last(r.gnss), 99.8, 1e-6);
    EXPECT_NEAR(last(r.imu), 99.98, 1e-6);
}

}  // namespace
}  // namespace schuler::dataset
