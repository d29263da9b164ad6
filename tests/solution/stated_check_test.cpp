// A lever arm that is given, or none, judged by a simulated drive.
#include "schuler/solution/stated_check.h"

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include "fusion/car_drive.h"

#include <gtest/gtest.h>

namespace schuler::solution {
namespace {

using Eigen::Vector3d;
using namespace fusion::testing;

struct Case {
    Vector3d said = Vector3d::Zero(), true_b{0.4, -0.2, -1.1};  ///< m
    bool given = true;
    bool straight = false;
    bool aloft = false;   ///< an aircraft
    bool tight = false;   ///< the fixes are of carrier phases, which the filter itself uses
    bool shaken = false;  ///< engine, quick fixes of the velocity
    std::uint64_t seed = 21;
};

/// What is doubted of the lever arm of a drive.
std::optional<LeverArmDoubt> doubt_of(const Case& c) {
    sim::Scenario scenario = town_drive(c.seed, c.shaken ? 10.0 : 2.0, 200.0);
    if (c.shaken) {
        std::get<sim::RoutePath>(scenario.path).vibration = {9.0, 2e-3, 0.5};
        scenario.gnss.position_latency = scenario.gnss.velocity_latency = 0.03;
    }
    scenario.gnss.lever_arm_b = c.true_b;
    if (c.straight) scenario.path = sim::GreatCirclePath{{50.4 * deg, 30.5 * deg, 150.0}, 1.3, 8.0};
    if (c.aloft) scenario.path = sim::FigureEightPath{.start = {50.4 * deg, 30.5 * deg, 900.0}, .heading = 0.3};
    Recording recording = sim::simulate(scenario).recording;
    recording.reference.clear();
    settings::Config config;
    config.filter = settings_of(scenario);
    give_start(config.filter, recording, c.seed);
    if (c.straight) config.filter.initial.std_rpy.z() = 0.7;
    if (c.aloft) config.filter.constraints.nonholonomic = config.filter.constraints.nonholonomic_auto = false;
    config.filter.gnss.lever_arm_b = c.said;
    if (c.shaken) {
        config.filter.gnss.latency = 0.0;
        config.filter.gnss.latency_std = config.filter.gnss.velocity_latency_std = 0.05;
    }
    WarningLog warnings;
    LoadedDataset data = settled_dataset(recording, config, warnings);
    if (c.given) data.given = {"gnss.lever_arm_m"};
    const fusion::Result result = fusion::run_filter(data.recording, data.config.filter, warnings);
    if (c.tight) {
        data.config.scheme = settings::Scheme::Tight;
        data.recording.ranges.carriers.emplace_back();
    }
    return doubt_of_lever_arm(data, result);
}

TEST(StatedLeverArm, TheTrueOneIsNotDoubted) { EXPECT_FALSE(doubt_of({.said = {0.4, -0.2, -1.1}})); }

TEST(StatedLeverArm, AWrongOneIsRefutedAndFound) {
    for (const Vector3d& wrong : {Vector3d(3.4, -0.2, -1.1), Vector3d(0.4, 4.8, -1.1)}) {
        const std::optional<LeverArmDoubt> doubt = doubt_of({.said = wrong});
        ASSERT_TRUE(doubt);
        EXPECT_TRUE(doubt->refuted);
        EXPECT_LT((doubt->found_b - Vector3d(0.4, -0.2, -1.1)).head<2>().norm(), 0.3) << doubt->text();
        EXPECT_TRUE(doubt->settings.estimate_lever_arm);
    }
}

/// Phases are too exact for a lever arm as a state.
TEST(StatedLeverArm, AWrongOneIsOnlyToldInTightCouplingWithABase) {
    const std::optional<LeverArmDoubt> doubt = doubt_of({.said = {3.4, -0.2, -1.1}, .tight = true});
    ASSERT_TRUE(doubt);
    EXPECT_TRUE(doubt->told_only && !doubt->refuted);
    EXPECT_LT((doubt->found_b - Vector3d(0.4, -0.2, -1.1)).head<2>().norm(), 0.3) << doubt->text();
    EXPECT_NE(doubt->text().find("the given one is used"), std::string::npos) << doubt->text();
    EXPECT_FALSE(doubt_of({.said = {0.4, -0.2, -1.1}, .tight = true}));
}

TEST(LeverArm, OfAnAntennaAsideIsFoundWhereNoneIsGiven) {
    const std::optional<LeverArmDoubt> doubt = doubt_of({.true_b = {1.4, 0.9, -1.2}, .given = false});
    ASSERT_TRUE(doubt);
    EXPECT_TRUE(doubt->refuted && !doubt->given);
    const Vector3d off = doubt->found_b - Vector3d(1.4, 0.9, -1.2);
    for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(off(i)), 3.5 * doubt->std_b(i)) << doubt->text();
    EXPECT_LT(off.head<2>().norm(), 0.3) << doubt->text();
}

TEST(LeverArm, OfAnAntennaAtTheUnitIsNotInvented) { EXPECT_FALSE(doubt_of({.true_b = Vector3d::Zero(), .given = false})); }

/// The noise of the gyros, and vibration whose phase the time of a velocity does not keep, are no turns of the antenna.
TEST(LeverArm, IsNotShortenedByVibration) {
    for (const std::uint64_t seed : {3U, 4U, 5U})
        EXPECT_FALSE(doubt_of({.said = {0.7, -0.4, -1.5}, .true_b = {0.7, -0.4, -1.5}, .shaken = true, .seed = seed}));
}

/// At the speed of an aircraft a latency acts as a lever arm does; the antenna moves against the unit faster than the velocities are
/// uncertain.
TEST(LeverArm, OfUnknownSizeLeavesTheSolutionToTheAntenna) {
    const std::optional<LeverArmDoubt> doubt = doubt_of({.true_b = {-1.0, 0.5, -4.0}, .given = false, .aloft = true});
    ASSERT_TRUE(doubt);
    EXPECT_TRUE(doubt->unknown);
    EXPECT_TRUE(doubt->settings.output_at_antenna);
    EXPECT_FALSE(doubt_of({.said = {-1.0, 0.5, -4.0}, .true_b = {-1.0, 0.5, -4.0}, .aloft = true}));
}

/// Where the heading is unknown, no direction of the lever arm can be.
TEST(LeverArm, IsNotJudgedByStraightMotion) { EXPECT_FALSE(doubt_of({.said = {0.4, 0.8, -1.1}, .straight = true})); }

}  // namespace
}  // namespace schuler::solution
