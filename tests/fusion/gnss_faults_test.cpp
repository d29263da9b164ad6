// Receivers that hang, and receivers that only stand.
#include "schuler/fusion/faults/gnss_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

const Geodetic home{0.84, 0.2, 500.0};

/// Ninety seconds, 5 Hz: rest for 30 s, then 8 m/s on a slow curve; noise of metres, or digits of `digit` m and no noise at all.
std::vector<GnssFix> drive(double noise, double digit, bool velocities = true) {
    const earth::Earth earth;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Vector3d p = Vector3d::Zero();
    std::vector<GnssFix> fixes;
    for (int i = 0; i < 450; ++i) {
        const double t = 0.2 * i, speed = t < 30.0 ? 0.0 : 8.0;
        const Vector3d v(speed * std::cos(0.02 * t), speed * std::sin(0.02 * t), 0.0);
        p += 0.2 * v;
        Vector3d said = p, way = v;
        for (int k = 0; k < 3; ++k) {
            said(k) += noise * normal(random);
            way(k) += 0.02 * noise * normal(random);
            if (digit > 0.0) said(k) = digit * std::round(said(k) / digit);
        }
        GnssFix f;
        f.time = Time::from_seconds(1000.0 + t);
        f.position = earth::moved_by_ned(earth, home, said);
        if (velocities) f.velocity_n = way;
        f.std_position.setConstant(1.5);
        f.fix = FixType::Autonomous;
        fixes.push_back(f);
    }
    return fixes;
}

/// Fixes first + 1 to last repeat that of first.
void hang(std::vector<GnssFix>& fixes, std::size_t first, std::size_t last, bool position, bool velocity) {
    for (std::size_t i = first + 1; i <= last; ++i) {
        if (position) fixes[i].position = fixes[first].position;
        if (velocity) fixes[i].velocity_n = fixes[first].velocity_n;
    }
}

TEST(FrozenFixes, ReceiverThatStandsOrHasCoarseDigitsIsNotAccused) {
    const earth::Earth earth;
    EXPECT_FALSE(frozen_fixes(drive(1.0, 0.0), earth).any());
    for (const double digit : {0.01, 1.0, 11.0})
        for (const bool velocities : {true, false})
            EXPECT_FALSE(frozen_fixes(drive(0.0, digit, velocities), earth).any()) << digit;
    auto held = drive(1.0, 0.0);  // static hold: position and velocity stay while it stands, and drift is let go at the end
    hang(held, 10, 149, true, true);
    EXPECT_FALSE(frozen_fixes(held, earth).any());
    auto logger = drive(1.0, 0.0);  // a receiver of 0.25 Hz in a table of 5 Hz
    for (std::size_t i = 0; i + 20 <= logger.size(); i += 20) hang(logger, i, i + 19, true, true);
    EXPECT_FALSE(frozen_fixes(logger, earth).any());
}

TEST(FrozenFixes, WhatHangsInMotionIsNamedToTheFix) {
    const earth::Earth earth;
    for (const bool position : {true, false})
        for (const bool velocity : {true, false}) {
            if (!position && !velocity) continue;
            auto fixes = drive(1.0, 0.0);
            hang(fixes, 250, 330, position, velocity);
            const FrozenFixes found = frozen_fixes(fixes, earth);
            ASSERT_TRUE(found.any()) << position << velocity;
            EXPECT_EQ(found.positions, position ? 80u : 0u);
            EXPECT_EQ(found.velocities, velocity ? 80u : 0u);
            EXPECT_EQ(*found.first, fixes[251].time);
            const FixScreen screen{found.position, found.velocity};
            for (std::size_t i = 0; i < fixes.size(); ++i) {
                const GnssFix left = screen.without(fixes[i], i);
                const bool inside = i > 250 && i <= 330;
                EXPECT_EQ(std::isnan(left.position.lat), position && inside) << i;
                EXPECT_EQ(std::isnan(left.velocity_n.x()), velocity && inside) << i;
            }
        }
}

TEST(FrozenFixes, OneThatHangsFromRestOnShowsItByTheLeapAtItsEnd) {
    const earth::Earth earth;
    for (const bool velocities : {true, false}) {
        auto fixes = drive(1.0, 0.0, velocities);
        hang(fixes, 100, 240, true, true);  // it drove off at the 150th
        const FrozenFixes found = frozen_fixes(fixes, earth);
        EXPECT_EQ(found.positions, 140u);
        EXPECT_EQ(found.velocities, velocities ? 140u : 0u);
    }
}

/// Metres east for the fixes of [first, end): at once, and growing by the second.
void stray(std::vector<GnssFix>& fixes, std::size_t first, std::size_t end, double at_once, double rate) {
    for (std::size_t i = first; i < end; ++i)
        fixes[i].position =
            earth::moved_by_ned({}, fixes[i].position, {0.0, at_once + rate * 0.2 * static_cast<double>(i - first), 0.0});
}

std::size_t count(const std::vector<bool>& marked) { return static_cast<std::size_t>(std::ranges::count(marked, true)); }

TEST(StrayedPositions, OnesThatComeBackToTheWayOfTheVelocitiesAreNamed) {
    const earth::Earth earth;
    auto ramp = drive(0.5, 0.0);
    stray(ramp, 200, 300, 0.0, 2.0);  // 40 m in the end
    const auto ramped = strayed_positions(ramp, earth);
    for (std::size_t i = 225; i < 300; ++i) EXPECT_TRUE(ramped[i]) << i;
    for (std::size_t i = 300; i < ramp.size(); ++i) EXPECT_FALSE(ramped[i]) << i;
}

TEST(StrayedPositions, NobodyIsNamedWhereTheWayDoesNotClose) {
    const earth::Earth earth;
    EXPECT_EQ(count(strayed_positions(drive(1.0, 0.0), earth)), 0u);
    EXPECT_EQ(count(strayed_positions(drive(0.0, 11.0), earth)), 0u);
    EXPECT_EQ(count(strayed_positions(drive(1.0, 0.0, false), earth)), 0u);
    auto stays = drive(0.5, 0.0);
    stray(stays, 200, stays.size(), 40.0, 0.0);
    EXPECT_EQ(count(strayed_positions(stays, earth)), 0u);
    auto level = drive(0.5, 0.0);  // a jump and a jump back
    stray(level, 200, 300, 40.0, 0.0);
    EXPECT_EQ(count(strayed_positions(level, earth)), 0u);
    auto velocities = drive(0.5, 0.0);  // wrong ones
    for (std::size_t i = 200; i < 300; ++i) velocities[i].velocity_n.y() += 3.0;
    EXPECT_EQ(count(strayed_positions(velocities, earth)), 0u);
}

TEST(DisplacedPositions, StringsOfOnesThatComeBackAreNamed) {
    const earth::Earth earth;
    EXPECT_EQ(count(displaced_positions(drive(1.0, 0.0), earth)), 0u);
    EXPECT_EQ(count(displaced_positions(drive(1.0, 0.0, false), earth)), 0u);
    auto level = drive(0.5, 0.0);
    stray(level, 200, 300, 40.0, 0.0);
    auto height = drive(0.5, 0.0);
    for (std::size_t i = 200; i < 300; ++i) height[i].position.h += 40.0;
    for (const auto& fixes : {level, height}) {
        const auto found = displaced_positions(fixes, earth);
        for (std::size_t i = 0; i < fixes.size(); ++i) EXPECT_EQ(found[i], i >= 200 && i < 300) << i;
    }
    auto stays = drive(0.5, 0.0);
    for (std::size_t i = 200; i < stays.size(); ++i) stays[i].position.h += 40.0;
    auto single = drive(0.5, 0.0);  // the tails of the noise
    for (std::size_t i = 20; i < single.size(); i += 50) single[i].position.h += 40.0;
    for (const auto& fixes : {stays, single}) EXPECT_EQ(count(displaced_positions(fixes, earth)), 0u);
}

TEST(IdleHeights, OneNumberBesideVerticalVelocitiesIsNoHeight) {
    const earth::Earth earth;
    auto fixes = drive(1.0, 0.0);
    for (GnssFix& fix : fixes) fix.position.h = 0.0;
    EXPECT_FALSE(has_idle_heights(fixes, earth)) << "it does not move vertically";
    for (std::size_t i = 0; i < fixes.size(); ++i) fixes[i].velocity_n.z() = i % 40 < 20 ? 0.5 : -0.5;
    EXPECT_TRUE(has_idle_heights(fixes, earth));
    WarningLog heard;
    const FixScreen screen = screen_fixes(fixes, {}, fixes.front().time, heard);
    EXPECT_TRUE(std::isnan(screen.without(fixes[3], 3).position.h));
    EXPECT_EQ(screen.without(fixes[3], 3).velocity_n.z(), fixes[3].velocity_n.z());
    EXPECT_EQ(heard.topics(), std::vector<std::string>{"gnss.idle_height"});
    fixes[7].position.h = 0.01;
    EXPECT_FALSE(has_idle_heights(fixes, earth));
}

TEST(FixScreen, FollowsTheSettings) {
    auto hung = drive(1.0, 0.0), ramp = drive(0.5, 0.0);
    hang(hung, 250, 330, true, false);
    stray(ramp, 200, 300, 0.0, 2.0);
    Settings settings;
    WarningLog heard;
    EXPECT_EQ(count(screen_fixes(hung, settings, hung.front().time, heard).position), 80u);
    EXPECT_GE(count(screen_fixes(ramp, settings, ramp.front().time, heard).position), 75u);
    EXPECT_EQ(heard.topics(), (std::vector<std::string>{"gnss.frozen", "gnss.strayed"}));
    Settings integrity = settings, ungated = settings, positions_only = settings;
    integrity.integrity.use = true;
    ungated.constraints.gate_probability = 0.0;
    positions_only.gnss.use_velocity = false;
    for (const Settings& s : {integrity, ungated, positions_only}) {
        WarningLog none;
        EXPECT_TRUE(screen_fixes(ramp, s, ramp.front().time, none).position.empty());
        EXPECT_TRUE(none.empty());
    }
}

}  // namespace
}  // namespace schuler::fusion
