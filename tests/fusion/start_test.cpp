// How a run starts: from what the fixes tell of velocity, rest and heading, and what is said where they tell nothing.
#include "fusion/car_drive.h"

#include "schuler/fusion/start.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"

#include <gtest/gtest.h>

#include <limits>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

RunData data_of(const Recording& recording, const Settings& settings) {
    WarningLog unheard;
    RunData data;
    data.recording = &recording;
    data.imu = make_imu_timeline(recording.imu, settings.imu, unheard);
    set_limits(data, settings);
    data.events = make_events(recording, settings, recording.gnss.front().time, unheard);
    data.fix_noise = fix_noise(recording, settings.gnss, unheard);
    data.still = find_still(data.imu, recording, data.events, settings);
    return data;
}

Start start_of(const Recording& recording, const Settings& settings) {
    Findings findings;
    WarningLog unheard;
    return find_start(data_of(recording, settings), settings, findings, unheard);
}

const ReferenceSample& truth_at(const Recording& recording, Time t) {
    return *std::ranges::min_element(recording.reference, {},
                                     [t](const ReferenceSample& r) { return std::abs((r.time - t).seconds()); });
}

void without_velocities(Recording& recording) {
    for (GnssFix& fix : recording.gnss)
        fix.velocity_n = fix.std_velocity = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// At a steady speed from the first instant on.
sim::Scenario steady(double north, double east) {
    sim::Scenario s;
    s.duration = 60.0;
    s.origin = Time::from_seconds(1000.0);
    sim::RecordedPath path;
    for (int k = 0; k <= 70; ++k)
        path.points.push_back(
            {1.0 * k, {0.5 + north * k / 6.36e6, 1.0 + east * k / 5.6e6, 500.0}, {0.0, 0.0, std::atan2(east, north)}});
    s.path = path;
    s.imu.errors = mems();
    s.gnss.rate = 4.0;
    return s;
}

// A given velocity that rest contradicts is not used, and that is told; one within its sigma is not worth a word.
TEST(Start, RestContradictsAGivenVelocity) {
    sim::Scenario s = town_drive(1, 5.0, 40.0);
    shake(s);
    const Recording recording = sim::simulate(s).recording;
    for (const double north : {3.0, 0.1}) {
        Settings f = settings_of(s);
        give_start(f, recording, 1);
        f.initial.velocity_n = {north, 0.0, 0.0};
        Findings findings;
        WarningLog warnings;
        const Start start = find_start(data_of(recording, f), f, findings, warnings);
        ASSERT_TRUE(start.nav.v_eb_n.isZero(0.0));
        EXPECT_EQ(warnings.count("initial.velocity"), north > 1.0 ? 1u : 0u);
    }
}

// A fast receiver's fixes are metres from where their stamps say, in turns by other metres than straight on.
TEST(Start, HeadingIsFoundBesideLatenciesThatNobodyKnows) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        sim::Scenario s = town_drive(seed, 4.0, 150.0);
        s.gnss.white_position.setConstant(0.02);
        s.gnss.position_latency = 0.28;
        s.gnss.velocity_latency = 0.1;
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
        const Start start = start_of(recording, f);
        const double off =
            math::wrap_pi(math::rpy_from_quaternion(start.nav.q_nb).z() - truth_at(recording, start.nav.time).rpy.z());
        EXPECT_LT(std::abs(off), 3.0 * start.std_rpy.z()) << seed;
        EXPECT_LT(start.std_rpy.z(), 10.0 * deg) << seed;
        EXPECT_EQ(start.undecided_heading, 0.0) << seed;
    }
}

// The antenna on a mast of which nobody spoke swings with the waves: its motion is not that of the unit with another heading.
TEST(Start, AMastInWavesIsNotTakenForTheHeading) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        sim::Scenario s;
        s.seed = seed;
        s.duration = 150.0;
        s.origin = Time::from_seconds(1000.0);
        sim::ShipPath path;
        path.start = {-15.0 * deg, -108.0 * deg, 0.0};
        path.heading = 120.0 * deg * static_cast<double>(seed);
        path.speed = 6.0;
        path.roll = {1.1 * deg, 10.8, 0.0};
        path.pitch = {3.0 * deg, 5.4, 1.0};
        path.yaw = {1.9 * deg, 7.6, 2.0};
        path.heave = {2.2, 9.3, 0.5};
        s.path = path;
        s.imu.errors = sensor::imu_grade("mems");
        s.gnss.rate = 4.0;
        s.gnss.white_position = {0.3, 0.3, 0.5};
        s.gnss.lever_arm_b = {-3.7, 1.4, -3.7};
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        f.gnss.lever_arm_b.setZero();
        f.vehicle = VehicleKind::Ship;
        const Start start = start_of(recording, f);
        const double off =
            math::wrap_pi(math::rpy_from_quaternion(start.nav.q_nb).z() - truth_at(recording, start.nav.time).rpy.z());
        const double std = std::max(start.std_rpy.z(), start.undecided_heading);
        EXPECT_LT(std::abs(off), 3.0 * std) << seed << " " << off / deg << " " << std / deg;
    }
}

TEST(Start, VelocityComesFromPositionsWhereTheReceiverTellsNone) {
    const sim::Scenario s = steady(-40.0, 30.0);
    Recording recording = sim::simulate(s).recording;
    without_velocities(recording);
    const Start start = start_of(recording, settings_of(s));
    const Vector3d off = start.nav.v_eb_n - truth_at(recording, start.nav.time).velocity_n;
    for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(off(i)), 3.0 * start.std_velocity(i)) << i;
    EXPECT_LT(start.std_velocity.maxCoeff(), 5.0);
}

// Positions of metres tell the speed of a walker worse than his kind does, but not that he walks at 130 m/s.
TEST(Start, PositionsOfMetresRefuteThatAVehicleIsSlow) {
    sim::Scenario s = steady(-130.0, 25.0);
    s.gnss.white_position = {10.0, 10.0, 15.0};
    Recording recording = sim::simulate(s).recording;
    without_velocities(recording);
    Settings f = settings_of(s);
    f.vehicle = VehicleKind::Hand;
    const Start start = start_of(recording, f);
    const Vector3d off = start.nav.v_eb_n - truth_at(recording, start.nav.time).velocity_n;
    for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(off(i)), 3.0 * start.std_velocity(i)) << i;
    EXPECT_LT(start.std_velocity.head<2>().maxCoeff(), 10.0);
}

// Steadily straight on a MEMS unit feels nothing of where it points: any heading fits, and that is what is reported to the end.
TEST(Start, HeadingThatNothingTellsStaysUndecided) {
    const sim::Scenario s = steady(5.0, 3.0);
    const Recording recording = sim::simulate(s).recording;
    Settings f = settings_of(s);
    f.vehicle = VehicleKind::Ship;
    const Result result = fuse(recording, f);
    const SolutionRow& last = result.forward.rows.back();
    EXPECT_GT(last.std_rpy.z(), 40.0 * deg);
    const double off = math::wrap_pi(last.rpy.z() - truth_at(recording, last.time).rpy.z());
    EXPECT_LT(std::abs(off), 3.0 * last.std_rpy.z());
}

/// Standstill found in the first `seconds`, s; none of it anywhere may be motion.
double rest_found(const RunData& data, Time origin, double seconds) {
    double rest = 0.0;
    for (const StillWindow& w : data.still.windows) {
        if ((w.end - origin).seconds() < seconds) rest += w.length;
        EXPECT_LT(truth_at(*data.recording, w.end).velocity_n.norm(), 0.5) << (w.end - origin).seconds();
    }
    return rest;
}

TEST(Start, RestIsSeenInPositionsOfMetres) {
    sim::Scenario s = town_drive(4, 5.0, 150.0);
    shake(s);
    std::get<sim::RoutePath>(s.path).standstill = 40.0;
    Recording recording = sim::simulate(s).recording;
    without_velocities(recording);
    const RunData data = data_of(recording, settings_of(s));
    EXPECT_GT(rest_found(data, s.origin, 38.0), 25.0);
}

// What a velocity is later than it is told is a state: estimated, and its error covered.
TEST(Latency, OfTheVelocityIsAStateOfItsOwn) {
    int inside = 0;
    constexpr int runs = 4;
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        sim::Scenario s = town_drive(seed, 5.0, 150.0);
        s.gnss.velocity_latency = 0.12;
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        give_start(f, recording, seed);
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
        const Result result = fuse(recording, f);
        const auto block = std::ranges::find(result.states, "gnss_velocity_latency_error", &LayoutBlock::name);
        ASSERT_NE(block, result.states.end());
        const ParameterRow& last = result.forward.parameters.back();
        const auto k = static_cast<std::size_t>(block->offset - 9);
        inside += std::abs(last.value[k] - 0.12) < 3.0 * last.std[k] ? 1 : 0;
        EXPECT_LT(last.std[k], 0.03);
        EXPECT_NEAR(last.value[k], 0.12, 0.05);
    }
    EXPECT_EQ(inside, runs);
}

/// The value of a state at the end of a run, and its sigma.
std::pair<double, double> last_of(const Result& result, const char* name) {
    const auto block = std::ranges::find(result.states, name, &LayoutBlock::name);
    if (block == result.states.end()) return {NAN, NAN};
    const ParameterRow& last = result.forward.parameters.back();
    const auto k = static_cast<std::size_t>(block->offset - 9);
    return {last.value[k], last.std[k]};
}

// An antenna that is shaken through a whole period within the error of the latency: its velocity at one instant tells no latency.
TEST(Latency, IsNotLearntFromAVibration) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        sim::Scenario s = town_drive(seed, 5.0, 400.0);
        std::get<sim::RoutePath>(s.path).vibration = {13.3, 0.05 * deg, 0.5};
        s.imu.rate = 200.0;
        s.gnss.lever_arm_b = {-1.5, -0.4, -0.3};
        s.gnss.white_position = {0.3, 0.3, 0.45};
        s.gnss.white_velocity.setConstant(0.05);
        s.gnss.position_latency = s.gnss.velocity_latency = 0.03;
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        give_start(f, recording, seed);
        f.gnss.latency = f.gnss.velocity_latency.emplace(0.11);
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.08;
        const auto [off, std] = last_of(fuse(recording, f), "gnss_velocity_latency_error");
        EXPECT_LT(std::abs(off + 0.08), 1.5 * std) << seed << ": " << off << " +- " << std;
        EXPECT_LT(std, 0.03) << seed;
    }
}

// At a constant velocity nothing shows the latency of positions. A filter that takes the corrections of its velocity for motion learns one
// all the same, further from the truth the longer it flies, and surer.
TEST(Latency, OfPositionsIsNotLearntStraightOn) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        sim::Scenario s = steady(100.0, 0.0);
        std::get<sim::RecordedPath>(s.path).points.resize(2);
        std::get<sim::RecordedPath>(s.path).points[1] = {1010.0, {0.5 + 101000.0 / 6.36e6, 1.0, 500.0}, {0.0, 0.0, 0.0}};
        s.duration = 1000.0;
        s.imu.errors = sensor::imu_grade("consumer");
        s.gnss.white_position.setConstant(0.3);
        s.gnss.position_latency = 0.1;
        s.seed = seed;
        Recording recording = sim::simulate(s).recording;
        without_velocities(recording);
        Settings f = settings_of(s);
        f.initial.rpy = recording.reference.front().rpy;
        f.initial.std_rpy = Vector3d(0.5, 0.5, 3.0) * deg;
        f.vehicle = VehicleKind::Air;
        f.gnss.latency = 0.0;
        f.gnss.latency_std = 0.1;
        const auto [off, std] = last_of(fuse(recording, f), "gnss_latency_error");
        EXPECT_LT(std::abs(off), 0.1) << seed;
        EXPECT_GT(std, 0.08) << seed;
        EXPECT_LE(std, 0.1001) << seed;
    }
}

// Over a fifth of a second the motion is not what its acceleration at one instant says: the run starts from the latency that a trial found.
TEST(Latency, ThatIsFoundIsTheOneAboutWhichTheFilterIsLinear) {
    const sim::Scenario s = flight_in_curves(3, 0.22);
    const Recording recording = sim::simulate(s).recording;
    Settings f = settings_of(s);
    f.vehicle = VehicleKind::Air;
    f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
    const Result as_given = fuse(recording, f);
    EXPECT_NEAR(last_of(as_given, "gnss_velocity_latency_error").first, 0.22, 0.03);
    EXPECT_EQ(as_given.findings.velocity_latency, 0.0);
    f.gnss.latency_found = true;
    const Result corrected = fuse(recording, f);
    EXPECT_NEAR(corrected.findings.velocity_latency, 0.22, 0.03);
    EXPECT_NEAR(corrected.findings.position_latency, 0.22, 0.03);
    EXPECT_LT(std::abs(last_of(corrected, "gnss_velocity_latency_error").first), 0.01);
    EXPECT_FALSE(corrected.findings.in_force->gnss.latency_found);
    EXPECT_EQ(corrected.findings.in_force->gnss.latency_std, 0.15);  // what the trial found is not used twice
    const auto told = std::ranges::find(corrected.findings.tuned, "gnss.velocity_latency_s", &TunedSetting::key);
    ASSERT_NE(told, corrected.findings.tuned.end());
    EXPECT_LT(told->sigma, 0.05);
    // given again, the same
    const Result again = fuse(recording, *corrected.findings.in_force);
    EXPECT_EQ(again.forward.rows.back().v_eb_n, corrected.forward.rows.back().v_eb_n);
}

// A start by fixes is as late as they are. Were it taken for on time, all that follows would agree with a latency of nothing.
TEST(Latency, OfTheFixesThatARunStartsFromIsNotTakenForNothing) {
    int inside = 0, epochs = 0;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const sim::Scenario s = flight_in_curves(seed, 0.22);
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        f.vehicle = VehicleKind::Air;
        f.scale_factors = f.misalignments = true;
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
        for (const analysis::ErrorRow& e : errors(f, fuse(recording, f).forward.rows, recording)) {
            inside += (e.position.array().abs() < 3.0 * e.std_position.array()).all() ? 1 : 0;
            ++epochs;
        }
    }
    EXPECT_GT(inside, 0.97 * epochs);
}

// A start by the magnetometer has its constant error in it: the samples that follow have it too and tell nothing new.
TEST(Start, WhatTheMagnetometerShowedIsNotUsedTwice) {
    sim::Scenario scenario;
    scenario.seed = 12;
    scenario.duration = 120.0;
    scenario.origin = Time::from_seconds(1000.0);
    scenario.path = sim::StaticPath{{0.9, 0.5, 100.0}, {0.0, 0.0, 1.0}};
    scenario.imu.errors = mems();
    Recording recording = sim::simulate(scenario).recording;
    constexpr double wrong = 0.3;  // rad
    for (std::size_t i = 0; i < recording.imu.size(); i += 10)
        recording.mag.push_back(
            {recording.imu[i].time, math::dcm_from_rpy({0.0, 0.0, 1.0 + wrong}).transpose() * Vector3d(2e-5, 0.0, 4e-5)});
    Settings f = settings_of(scenario);
    f.vehicle = VehicleKind::Static;
    f.mag.declination = 0.0;
    const Result r = fuse(recording, f);
    const SolutionRow &first = r.forward.rows.front(), &last = r.forward.rows.back();
    // of the offset and of the hard iron, both of which the next samples have too
    EXPECT_NEAR(first.std_rpy.z(), f.mag.bias_std, 0.05);
    EXPECT_GT(last.std_rpy.z(), 0.9 * f.mag.bias_std);  // 0.7 of it where two sources seem to agree
    EXPECT_NEAR(math::wrap_pi(last.rpy.z() - 1.0), wrong, 0.05);

    // A sensor of the heading is asked as well, and is believed by its sigma.
    for (std::size_t i = 0; i < recording.imu.size(); i += 100) recording.heading.push_back({recording.imu[i].time, 1.0, 0.01});
    const Result sensed = fuse(recording, f);
    EXPECT_LT(sensed.findings.std_heading, 0.05);
    EXPECT_NEAR(math::wrap_pi(sensed.forward.rows.back().rpy.z() - 1.0), 0.0, 0.02);
}

// Velocities made of range rates err by a decimetre a second, and a car that nothing shakes is as calm in motion: their means tell rest.
TEST(Still, IsFoundFromTheMeansOfTheRangesOwnVelocities) {
    sim::Scenario scenario = town_drive(5, 1.0, 200.0);
    std::get<sim::RoutePath>(scenario.path).standstill = 40.0;
    scenario.gnss.white_velocity.setConstant(0.1);
    Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    EXPECT_TRUE(data_of(recording, f).still.windows.empty());
    f.coupling = Coupling::Tight;
    recording.ranges.samples.emplace_back();
    recording.ranges.epochs.push_back({recording.gnss.front().time, 0, 1});
    const std::vector<StillWindow> windows = data_of(recording, f).still.windows;
    EXPECT_GT(windows.size(), 100u);  // of 200 in 40 s
    for (const StillWindow& w : windows) EXPECT_LT(truth_at(recording, w.end).velocity_n.norm(), 0.01) << w.end.seconds();
}

// Ten velocities a second, each of which errs by as much as a slow walk: their means over a second tell rest.
TEST(Still, IsFoundFromTheMeansOfNoisyVelocities) {
    sim::Scenario scenario = town_drive(5, 10.0, 150.0);
    shake(scenario);
    std::get<sim::RoutePath>(scenario.path).standstill = 20.0;
    scenario.gnss.white_velocity.setConstant(0.1);
    const Recording recording = sim::simulate(scenario).recording;
    const RunData data = data_of(recording, settings_of(scenario));
    EXPECT_GT(rest_found(data, scenario.origin, 20.0), 15.0);
}

// A walker's antenna swings: a velocity that is late by a seventh of a period looks like a heading that is wrong by a seventh of a turn.
TEST(Latency, OfASwingingAntennaIsNotTakenForTheHeading) {
    for (const std::uint64_t seed : {1u, 2u}) {
        sim::Scenario s = town_drive(seed, 10.0, 200.0);
        sim::RoutePath route;
        route.start = {14.1 * deg, 76.8 * deg, 950.0};
        route.waypoints = {{30.0, -25.0, 0.0, 1.4},
                           {20.0, -70.0, 0.0, 1.2},
                           {-20.0, -80.0, 0.0, 1.3},
                           {-60.0, -50.0, 0.0, 1.1},
                           {-110.0, -60.0, 0.0, 1.4}};
        route.knot_spacing = 1.0;
        route.standstill = 15.0;
        route.corner_radius = 3.0;
        route.lateral_accel = 1.0;
        route.longitudinal_accel = 0.6;
        route.vibration = {1.5, 4.5 * deg, 1.4};
        s.path = route;
        s.imu.errors = sensor::imu_grade("consumer");
        s.gnss.white_position = {0.4, 0.4, 0.6};
        s.gnss.white_velocity = {0.05, 0.05, 0.08};
        s.gnss.velocity_latency = 0.1;
        s.gnss.lever_arm_b = {0.1, 0.0, -0.5};
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        f.vehicle = VehicleKind::Hand;
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
        const Result result = fuse(recording, f);
        const SolutionRow &first = result.forward.rows.front(), &last = result.forward.rows.back();
        for (const SolutionRow* row : {&first, &last}) {
            const double off = math::wrap_pi(row->rpy.z() - truth_at(recording, row->time).rpy.z());
            EXPECT_LT(std::abs(off), std::max(4.0 * row->std_rpy.z(), 5.0 * deg)) << seed << " " << off / deg;
            EXPECT_LT(row->std_rpy.z(), 15.0 * deg) << seed;
        }
    }
}

// A unit that is shaken up and down by half a period within the latency: linear in it, the velocities would be refused.
TEST(Latency, OfAShakenUnitIsFoundWithoutRefusals) {
    for (const std::uint64_t seed : {1u, 2u}) {
        sim::Scenario s = town_drive(seed, 10.0, 100.0);
        std::get<sim::RoutePath>(s.path).vibration = {1.5, 0.0, 3.0};
        s.gnss.lever_arm_b.setZero();
        s.gnss.white_velocity.setConstant(0.02);
        s.gnss.velocity_latency = 0.2;
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        give_start(f, recording, seed);
        f.gnss.latency_std = f.gnss.velocity_latency_std = 0.15;
        const Result result = fuse(recording, f);
        int refused = 0;
        for (const MeasurementRecord& a : result.measurements)
            refused += a.kind == MeasurementKind::GnssVelocity && a.status == MeasurementStatus::Rejected ? 1 : 0;
        const auto block = std::ranges::find(result.states, "gnss_velocity_latency_error", &LayoutBlock::name);
        ASSERT_NE(block, result.states.end());
        const ParameterRow& last = result.forward.parameters.back();
        const auto k = static_cast<std::size_t>(block->offset - 9);
        EXPECT_EQ(refused, 0) << seed;
        EXPECT_LT(std::abs(last.value[k] - 0.2), 3.0 * last.std[k]) << seed;
    }
}

}  // namespace
}  // namespace schuler::fusion
