// Positions after an interruption that a jump refutes: which of them a smoother has to do without.
#include "schuler/fusion/faults/abandoned_levels.h"

#include <gtest/gtest.h>

namespace schuler::fusion {
namespace {

using namespace filter;
using Eigen::Vector3d;

/// A pass with fixes every second until 100 s and from 120 s on; the first ones after the gap lie `off` m north, until 125 s.
Result pass(double off, double known) {
    Result r;
    const auto at = [](double t) { return Time::from_gps(2300, t); };
    const auto fix = [&](double t, AidStatus status, double innovation, double sigma) {
        AidRecord a{at(t), at(t), AidKind::GnssPosition, status, 3};
        a.innovation = {innovation, 0.0, 0.0};
        a.sigma = Vector3d::Constant(sigma);
        r.aids.push_back(a);
    };
    for (double t = 0.0; t <= 100.0; t += 1.0) fix(t, AidStatus::Accepted, 0.0, 1.5);
    fix(120.0, AidStatus::Accepted, -off, known);
    for (double t = 121.0; t < 125.0; t += 1.0) fix(t, AidStatus::Accepted, 0.0, 1.5);
    for (double t = 125.0; t < 127.0; t += 1.0) fix(t, AidStatus::Rejected, off, 1.5);
    r.alerts.push_back({at(127.0), AidKind::GnssPosition, IntegrityTest::Jump, off});
    for (double t = 127.0; t < 140.0; t += 1.0) fix(t, AidStatus::Accepted, 0.0, 1.5);
    r.alerts.push_back({at(132.0), AidKind::GnssPosition, IntegrityTest::OtherLevel, off});
    return r;
}

TEST(AbandonedLevels, TheFirstFixesAfterAnInterruption) {
    const auto levels = abandoned_levels(pass(20.0, 9.0));
    ASSERT_EQ(levels.size(), 1U);
    EXPECT_DOUBLE_EQ((levels[0].last - levels[0].first).seconds(), 4.0);
    EXPECT_DOUBLE_EQ(levels[0].size, 20.0);
    std::vector<Event> events;
    for (const AidKind kind : {AidKind::GnssPosition, AidKind::GnssVelocity})
        for (double t = 118.0; t < 130.0; t += 1.0) {
            Event e{};
            e.stamp = e.valid = Time::from_gps(2300, t);
            e.kind = kind;
            events.push_back(e);
        }
    EXPECT_EQ(withhold(events, levels), 5U);  // the positions of 120 to 124 s, not the velocities
    EXPECT_TRUE(events[2].withheld);
    EXPECT_FALSE(events[7].withheld);
    EXPECT_EQ(withhold(events, levels), 0U);
}

TEST(AbandonedLevels, NotWhereItCannotBeSaid) {
    Result twice = pass(20.0, 9.0);  // it also left the second one
    twice.alerts.push_back({Time::from_gps(2300, 138.0), AidKind::GnssPosition, IntegrityTest::OtherLevel, 20.0});
    EXPECT_TRUE(abandoned_levels(twice).empty());
    Result foretold = pass(20.0, 3.0);  // the position of before is that of the first ones
    foretold.aids[101].innovation.setZero();
    EXPECT_TRUE(abandoned_levels(foretold).empty());
    Result stays = pass(20.0, 9.0);  // the filter did not follow
    stays.alerts.pop_back();
    EXPECT_TRUE(abandoned_levels(stays).empty());
}

}  // namespace
}  // namespace schuler::fusion
