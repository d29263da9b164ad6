// A heading that is given and wrong: the run comes back to the fixes, and what came before is put right.
#include "fusion/car_drive.h"

#include "schuler/fusion/realignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

/// One fix a second, off by `noise` m as it says.
Drive drive(std::uint64_t seed, double noise) {
    Drive d;
    d.scenario = town_drive(seed, 1.0, 240.0);
    d.scenario.gnss.white_position.setConstant(noise);
    d.scenario.gnss.white_velocity.setConstant(0.05);
    d.recording = sim::simulate(d.scenario).recording;
    for (GnssFix& f : d.recording.gnss) {
        f.std_position.setConstant(noise);
        f.std_velocity.setConstant(0.05);
    }
    d.settings = settings_of(d.scenario);
    d.settings.output_rate = 10.0;
    give_start(d.settings, d.recording, seed);
    return d;
}

TEST(Realignment, AWrongHeadingThatIsGivenIsReplaced) {
    for (const std::uint64_t seed : {61u, 64u})
        for (const double wrong : {-3.0, -0.4, 1.0})
            for (const double noise : {0.02, 1.5}) {
                Drive d = drive(seed, noise);
                d.settings.initial.rpy.z() += wrong;
                d.settings.initial.std_rpy.z() = 0.02;
                const Result result = fuse(d.recording, d.settings);
                const auto e = errors(d.settings, result.forward.rows, d.recording);
                EXPECT_LT(worst_horizontal(e, 60.0), 2.5) << seed << " " << wrong << " " << noise;
                EXPECT_LT(rms(e, 100.0).heading, 2.0 * deg) << seed << " " << wrong << " " << noise;
                EXPECT_TRUE(
                    std::ranges::is_sorted(result.forward.rows, std::ranges::less_equal{}, &SolutionRow::time));  // no time twice
            }
}

// What was found out later holds from the start: the gyros carried the error along.
TEST(Realignment, WhatCameBeforeIsPutRight) {
    Drive d = drive(66, 0.02);
    d.settings.initial.rpy.z() += 2.0;
    d.settings.initial.std_rpy.z() = 0.02;
    WarningLog warnings;
    const Result result = run_filter(d.recording, d.settings, warnings);
    EXPECT_EQ(warnings.count("navigation.realigned"), 1u);
    EXPECT_EQ(warnings.count("contradiction.initial.heading_deg"), 1u);
    EXPECT_EQ(result.legs.size(), 2u);
    EXPECT_LT(rms(errors(d.settings, result.forward.rows, d.recording), 0.0).heading, 3.0 * deg);
}

TEST(Realignment, ADriveInOrderHasNone) {
    const Drive d = drive(47, 0.02);
    WarningLog warnings;
    const Result result = run_filter(d.recording, d.settings, warnings);
    EXPECT_EQ(result.legs.size(), 1u);
    EXPECT_FALSE(diverged_at(result));
}

}  // namespace
}  // namespace schuler::fusion
