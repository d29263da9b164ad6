// A receiver's heights beside a barometer's, with the inertial unit as the witness.
#include "schuler/fusion/faults/height_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace schuler::fusion::testing {
namespace {

struct Flight {
    Recording recording;
    filter::ImuTimeline imu;
};

/// Five minutes up and down by 8 m, level: receiver at 5 Hz, barometer at 10 Hz, unit at 50 Hz; each height with an error by time.
Flight hover(const std::function<double(double)>& of_receiver, const std::function<double(double)>& of_barometer) {
    std::mt19937 random(8);
    std::normal_distribution<double> normal;
    Flight f;
    f.imu.median_dt = 0.02;
    constexpr double w = 0.25, size = 8.0;
    const auto height = [](double t) { return 300.0 + size * std::sin(w * t); };
    for (int i = 0; i < 15000; ++i) {
        const double t = 0.02 * i, up = -size * w * w * std::sin(w * t);
        ImuIncrement increment;
        increment.time = Time::from_seconds(t + 0.02);
        increment.dt = 0.02;
        increment.dv = 0.02 * Eigen::Vector3d(0.2 * normal(random), 0.2 * normal(random), -9.81 - up + 0.5 * normal(random));
        f.imu.increments.push_back(increment);
        if (i % 10 == 0) {
            GnssFix fix;
            fix.time = Time::from_seconds(t);
            fix.position = {0.8, 0.1, height(t) + 0.3 * normal(random) + of_receiver(t)};
            fix.fix = FixType::Autonomous;
            f.recording.gnss.push_back(fix);
        }
        if (i % 5 == 0)
            f.recording.baro.push_back({Time::from_seconds(t), height(t) + 0.4 * normal(random) + of_barometer(t), not_given});
    }
    return f;
}

std::size_t left_out(const Flight& f) {
    const std::vector<bool> off = heights_off_barometer(f.recording, f.imu, earth::Earth{});
    return static_cast<std::size_t>(std::ranges::count(off, true));
}

/// 40 m down and back within 40 s, as multipath makes it.
double glitch(double t) { return t > 150.0 && t < 190.0 ? -40.0 * std::pow(std::sin((t - 150.0) / 40.0 * M_PI), 2) : 0.0; }
double none(double) { return 0.0; }

TEST(HeightFaults, AGlitchOfTheReceiverIsLeftOutAndNothingElse) {
    const Flight f = hover(glitch, none);
    const std::vector<bool> off = heights_off_barometer(f.recording, f.imu, earth::Earth{});
    ASSERT_EQ(off.size(), f.recording.gnss.size());
    for (std::size_t i = 0; i < off.size(); ++i) {
        const double error = std::abs(glitch(f.recording.gnss[i].time.seconds()));
        EXPECT_TRUE(off[i] || error < 10.5) << i;
        EXPECT_FALSE(off[i] && error == 0.0) << i;
    }
}

TEST(HeightFaults, ABarometersOwnFaultsAccuseNobody) {
    EXPECT_EQ(left_out(hover(none, none)), 0u);
    EXPECT_EQ(left_out(hover(none, glitch)), 0u);
    EXPECT_EQ(left_out(hover(none, [](double t) { return 0.03 * t; })), 0u);  // weather
    EXPECT_EQ(left_out(hover([](double t) { return 0.08 * t; }, none)), 0u);  // nothing tells which of the two it is
}

}  // namespace
}  // namespace schuler::fusion::testing
