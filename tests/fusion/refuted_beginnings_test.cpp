// Positions after an interruption that the jump of a smoothed trajectory refutes.
#include "schuler/fusion/faults/refuted_beginnings.h"

#include "schuler/core/units.h"

#include <gtest/gtest.h>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

const earth::Earth the_earth = earth::Earth(earth::wgs84);
const Geodetic origin{50.0 * units::deg, 30.0 * units::deg, 200.0};
const Vector3d velocity{20.0, 10.0, 0.0};

Time at(double t) { return Time::from_gps(2300, 1000.0 + t); }
Geodetic place(double t, const Vector3d& off = Vector3d::Zero()) {
    return earth::moved_by_ned(the_earth, origin, t * velocity + off);
}

struct Logs {
    std::vector<SolutionRow> smoothed;
    std::vector<GnssFix> fixes;
};

/// Silent from 20 to 40 s, then `off` until 44 s; the trajectory follows at 47 s. The receiver jumps only if `receiver`.
Logs logs(const Vector3d& off, bool receiver = true, double silent_until = 40.0) {
    Logs out;
    for (int i = 0; i < 800; ++i) {
        SolutionRow row{};
        const double t = 0.1 * i;
        row.time = at(t);
        row.position = place(t, t >= 20.0 && t < 47.0 ? off : Vector3d::Zero());
        row.v_eb_n = velocity;
        out.smoothed.push_back(row);
    }
    for (int i = 0; i < 80; ++i) {
        const double t = i;
        if (t > 20.0 && t < silent_until) continue;
        GnssFix fix{};
        fix.time = at(t);
        fix.position = place(t, receiver && t > 20.0 && t < 44.0 ? off : Vector3d::Zero());
        fix.std_position = Vector3d::Constant(0.5);
        out.fixes.push_back(fix);
    }
    return out;
}

TEST(RefutedBeginnings, FromTheInterruptionToTheJump) {
    const Logs l = logs({12.0, -16.0, 0.0});
    const auto found = refuted_beginnings(l.smoothed, l.fixes, the_earth);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].first, at(40.0));
    EXPECT_EQ(found[0].end, at(44.0));
    EXPECT_NEAR(found[0].jump.norm(), 20.0, 0.01);
    std::vector<filter::Event> events;
    for (const filter::MeasurementKind kind : {filter::MeasurementKind::GnssPosition, filter::MeasurementKind::GnssVelocity})
        for (const GnssFix& fix : l.fixes) {
            filter::Event e{};
            e.stamp = e.valid = fix.time;
            e.kind = kind;
            events.push_back(e);
        }
    EXPECT_EQ(withhold(events, found), 4U);  // the positions of 40 to 43 s, not the velocities
    EXPECT_EQ(withhold(events, found), 0U);
}

TEST(RefutedBeginnings, NotWhereTheReceiverDidNotJumpOrWasNotSilent) {
    const auto none = [](const Logs& l) { return refuted_beginnings(l.smoothed, l.fixes, the_earth).empty(); };
    EXPECT_TRUE(none(logs({12.0, -16.0, 0.0}, false)));  // the navigation was wrong and was corrected
    EXPECT_TRUE(none(logs({0.5, -0.5, 0.0})));           // less than anybody can tell
    EXPECT_TRUE(none(logs({1.0, -1.0, 0.0})));           // noise of the receiver
    EXPECT_FALSE(none(logs({2.0, -2.0, 0.0})));
    const Logs began = logs({12.0, -16.0, 0.0}, true, 21.0);  // the wrong ones are the first of the log
    Logs late = began;
    std::erase_if(late.fixes, [](const GnssFix& f) { return f.time < at(21.0); });
    ASSERT_EQ(refuted_beginnings(late.smoothed, late.fixes, the_earth).size(), 1U);
    EXPECT_EQ(refuted_beginnings(late.smoothed, late.fixes, the_earth)[0].first, at(21.0));
}

}  // namespace
}  // namespace schuler::fusion
