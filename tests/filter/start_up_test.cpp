// Alignment without looking ahead: the phases it passes through, and whether the start it finds is as good as it says.
#include "filter/stream_drive.h"

#include "schuler/filter/navigator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace schuler::fusion {
namespace {

using namespace testing;
using Eigen::Vector3d;

/// What the first state and the last say against the truth.
struct Alignment {
    std::vector<Phase> phases;
    double began = -1.0;                        ///< s after the first sample
    double heading = 0.0, std_heading = 0.0;    ///< rad, error and sigma of the first state
    double tilt = 0.0, std_tilt = 0.0;          ///< rad, of the vertical; sigma about north
    double position = 0.0, std_position = 0.0;  ///< horizontal
    double last_heading = 0.0, most = 0.0;      ///< error at the end, rad; largest heading error over its sigma
};

Alignment align(const Recording& recording, const NavigatorSettings& settings) {
    NavigatorMade made = Navigator::make(settings);
    EXPECT_TRUE(made) << made.reason;
    Navigator& navigator = *made.navigator;
    Alignment a;
    std::size_t k = 0;
    const std::vector<Sample> samples = samples_of(recording);
    for (const Sample& s : samples) {
        (void)feed(navigator, s, {});
        while (const std::optional<NavigatorEvent> e = navigator.poll())
            if (e->kind == NavigatorEvent::Kind::Phase) a.phases.push_back(e->phase);
        const std::optional<NavigatorState> state = navigator.lagged();
        if (!state) continue;
        while (k + 1 < recording.reference.size() && recording.reference[k + 1].time <= state->nav.time) ++k;
        const ReferenceSample& truth = recording.reference[k];
        if (truth.time != state->nav.time) continue;
        const Eigen::Matrix3d turn = state->nav.q_nb.toRotationMatrix() * math::dcm_from_rpy(truth.rpy).transpose();
        const double heading = std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1)),
                     std = std::sqrt(state->covariance(8, 8));
        if (a.began < 0.0) {
            a.began = (state->nav.time - recording.imu.front().time).seconds();
            a.heading = heading;
            a.std_heading = std;
            a.tilt = 0.5 * std::hypot(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0));
            a.std_tilt = std::sqrt(state->covariance(6, 6));
            a.position = earth::ned_difference({}, state->nav.position, truth.position).head<2>().norm();
            a.std_position = std::sqrt(state->covariance(0, 0));
        }
        a.last_heading = heading;
        a.most = std::max(a.most, std::abs(heading) / std);
    }
    return a;
}

struct Car {
    Recording recording;
    NavigatorSettings settings;
};
Car car(std::uint64_t seed, double standstill, const sensor::ImuErrorModel& imu, double drives = 70.0) {
    sim::Scenario scenario = town_drive(seed, 5.0, standstill + drives);
    shake(scenario);
    std::get<sim::RoutePath>(scenario.path).standstill = standstill;
    scenario.imu.errors = imu;
    Car c{sim::simulate(scenario).recording, {}};
    c.settings.filter = settings_of(scenario);
    c.settings.filter.gnss.estimate_std = false;
    c.settings.imu_interval = 0.01;
    c.settings.rates.gnss = 10.0;
    return c;
}

TEST(StartUp, StandsThenDrives) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        Car c = car(seed, 12.0, mems());
        std::erase_if(c.recording.gnss, [](const GnssFix& f) { return f.time.seconds() < 1002.0; });
        const Alignment a = align(c.recording, c.settings);
        EXPECT_EQ(a.phases, (std::vector{Phase::WaitingForPosition, Phase::Levelling, Phase::FindingHeading, Phase::Navigating}))
            << seed;
        EXPECT_GT(a.began, 12.0);
        EXPECT_LT(a.began, 30.0);
        EXPECT_LT(std::abs(a.heading), 3.0 * a.std_heading);
        EXPECT_LT(a.std_heading, 15.0 * deg);
        EXPECT_LT(a.tilt, 3.0 * a.std_tilt);
        EXPECT_LT(a.position, 3.0 * a.std_position);
        EXPECT_LT(a.most, 4.0);
        EXPECT_LT(std::abs(a.last_heading), 0.4 * deg);
    }
}

TEST(StartUp, BeginsInMotion) {
    double tilt2 = 0.0;
    for (const auto& [seed, from] : {std::pair{4u, 1016.0}, {5u, 1020.0}, {6u, 1025.0}}) {
        Car c = car(seed, 8.0, mems(), 112.0);
        std::erase_if(c.recording.imu, [&](const ImuSample& s) { return s.time.seconds() < from; });
        const Alignment a = align(c.recording, c.settings);
        EXPECT_EQ(a.phases, (std::vector{Phase::Levelling, Phase::FindingHeading, Phase::Navigating})) << seed;
        EXPECT_LT(std::abs(a.heading), 3.0 * a.std_heading);
        EXPECT_LT(a.tilt, 3.0 * a.std_tilt);
        tilt2 += a.tilt * a.tilt / 3.0;
        EXPECT_LT(a.most, 4.0);
        EXPECT_LT(std::abs(a.last_heading), 0.4 * deg);
    }
    EXPECT_LT(std::sqrt(tilt2), 0.8 * deg);  // moving, it levels by what the fit says of the vertical
}

TEST(StartUp, GyrocompassesWhereTheGradePermits) {
    Car c = car(7, 65.0, sensor::imu_grade("navigation"));
    const Alignment a = align(c.recording, c.settings);
    EXPECT_EQ(a.phases, (std::vector{Phase::Levelling, Phase::Gyrocompassing, Phase::Navigating}));
    EXPECT_NEAR(a.began, 60.0, 1.0);
    EXPECT_LT(a.std_heading, 0.5 * deg);
    EXPECT_LT(std::abs(a.heading), 3.0 * a.std_heading);
    EXPECT_LT(a.most, 4.0);
}

TEST(StartUp, TakesAHeadingFromTheSensorsThatThereAre) {
    Car c = car(8, 12.0, mems());
    for (const ReferenceSample& t : c.recording.reference)
        c.recording.mag.push_back({t.time, math::dcm_from_rpy(t.rpy).transpose() * Vector3d(2e-5, 0.0, 4e-5)});
    c.settings.rates.mag = 20.0;
    c.settings.filter.mag.declination = 0.0;
    Alignment a = align(c.recording, c.settings);
    EXPECT_LT(a.began, 2.0);
    EXPECT_LT(std::abs(a.heading), 2.0 * deg);
    EXPECT_NEAR(a.std_heading, c.settings.filter.mag.bias_std, 0.05);
    math::Random random(8, "two antennas");
    for (const ReferenceSample& t : c.recording.reference)
        c.recording.heading.push_back({t.time, t.rpy.z() + 0.01 * random.normal(), 0.01});
    c.settings.rates.heading = 20.0;
    a = align(c.recording, c.settings);
    EXPECT_LT(a.began, 2.0);
    EXPECT_LT(std::abs(a.heading), 3.0 * a.std_heading);
    EXPECT_LT(a.std_heading, 1.0 * deg);
    EXPECT_LT(a.most, 4.5);
}

TEST(StartUp, TakesWhatIsGiven) {
    Car c = car(9, 12.0, mems());
    const ReferenceSample& truth = c.recording.reference.front();
    c.settings.filter.initial.position = truth.position;
    c.settings.filter.initial.rpy = truth.rpy;
    c.settings.filter.initial.std_rpy = Vector3d::Constant(1.0 * deg);
    c.settings.filter.initial.velocity_n = truth.velocity_n;
    const Alignment a = align(c.recording, c.settings);
    EXPECT_EQ(a.phases, std::vector{Phase::Navigating});
    EXPECT_LT(a.began, 0.1);
    EXPECT_LT(std::abs(a.last_heading), 0.6 * deg);
}

}  // namespace
}  // namespace schuler::fusion
