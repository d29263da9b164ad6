// The intermediate coupling: two solutions of which each survives the loss of the other's sensor.
#include "fusion/range_flight.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::fusion {
namespace {

using namespace test;
using Eigen::Vector3d;

Flight intermediate() {
    Flight f = flight();
    f.settings.coupling = Coupling::Intermediate;
    return f;
}

/// Largest horizontal error of the rows in [from, to], m; -1 where there are none.
double error_within(const Flight& f, const Result& result, double from, double to) {
    double out = -1.0;
    for (const SolutionRow& row : result.forward.rows) {
        const double t = row.time.seconds();
        const auto k = static_cast<std::size_t>(std::llround(t));
        if (t < from || t > to || k >= f.recording.reference.size() || std::abs(t - static_cast<double>(k)) > 0.01) continue;
        out = std::max(out, earth::ned_difference(f.earth, row.position, f.recording.reference[k].position).head<2>().norm());
    }
    return out;
}

/// The receiver's filter takes nothing from the inertial unit: its rows are the same, bit for bit, whatever that says. And it is right.
TEST(IntermediateCoupling, TheReceiverIsIndependentAndConsistent) {
    const Flight f = intermediate();
    Flight other = f;
    for (ImuSample& m : other.recording.imu) m.accel += Vector3d(0.02, -0.01, 0.005);
    const Result one = run(f), two = run(other);
    ASSERT_EQ(one.receiver.rows.size(), 120U);
    ASSERT_EQ(two.receiver.rows.size(), 120U);
    double squares = 0.0;
    for (std::size_t i = 0; i < 120; ++i) {
        EXPECT_EQ(one.receiver.rows[i].position.lat, two.receiver.rows[i].position.lat);
        EXPECT_EQ(one.receiver.rows[i].v_eb_n, two.receiver.rows[i].v_eb_n);
        const SolutionRow& row = one.receiver.rows[i];
        const ReferenceSample& truth = f.recording.reference[i + 1];
        const Vector3d error = earth::ned_difference(f.earth, row.position, truth.position) -
                               math::dcm_from_rpy(truth.rpy) * f.settings.gnss.lever_arm_b;
        if (i >= 20) squares += error.cwiseQuotient(row.std_position).squaredNorm() / 3.0 / 100.0;
    }
    EXPECT_GT(squares, 0.05);  // one flight: its slow errors are the same throughout
    EXPECT_LT(squares, 3.0);
    for (const CrossCheck& c : one.cross_checks) EXPECT_TRUE(c.agrees) << c.time.seconds();
}

/// Inertial unit gone for twenty seconds of a turn, then for good: the receiver leads, and the log goes on to the end of the ranges.
TEST(IntermediateCoupling, SurvivesTheLossOfTheInertialUnit) {
    Flight f = intermediate();
    std::erase_if(f.recording.imu, [](const ImuSample& m) {
        const double t = m.time.seconds();
        return (t > 70.0 && t < 90.0) || t > 110.0;
    });
    f.settings.output_lever_arm_b = {2.0, 0.0, -1.0};
    f.settings.smooth = true;
    const Result both = run(f);
    for (const Trajectory* t : {&both.forward, &both.smoothed}) {
        ASSERT_EQ(t->rows.size(), t->point.size());
        EXPECT_EQ(t->rows.back().time, both.receiver.rows.back().time);
        EXPECT_EQ(t->point.back().time, t->rows.back().time);
        // nobody knows which way the arms from the antenna point
        EXPECT_GT(t->point.back().std_position.x(), (f.settings.output_lever_arm_b - f.settings.gnss.lever_arm_b).norm());
        EXPECT_GT(t->rows.back().std_position.x(), f.settings.gnss.lever_arm_b.norm());
    }
    f.settings.smooth = false;
    const double hole = error_within(f, both, 75.0, 89.0), after = error_within(f, both, 112.0, 121.0);
    EXPECT_GE(hole, 0.0);
    EXPECT_LT(hole, 15.0);
    EXPECT_GE(after, 0.0);
    EXPECT_LT(after, 15.0);
    EXPECT_NEAR(both.forward.rows.back().time.seconds(), 120.0, 0.01);
    EXPECT_FALSE(both.forward.rows.back().rpy.allFinite());
    f.settings.coupling = Coupling::Tight;
    EXPECT_LT(error_within(f, run(f), 112.0, 121.0), 0.0) << "tight coupling alone ends with its inertial unit";
}

/// Satellites gone: the solution is that of the tight filter.
TEST(IntermediateCoupling, SurvivesTheLossOfTheSatellites) {
    Flight f = intermediate();
    f.settings.outages = {{60.0, 40.0}};
    const Result both = run(f);
    f.settings.coupling = Coupling::Tight;
    const Result tight = run(f);
    ASSERT_EQ(both.forward.rows.size(), tight.forward.rows.size());
    for (std::size_t i = 0; i < tight.forward.rows.size(); ++i)
        EXPECT_EQ(both.forward.rows[i].position.lat, tight.forward.rows[i].position.lat);
    EXPECT_LT(error_within(f, both, 60.0, 99.0), 15.0);
}

/// An accelerometer that is off by half a metre a second squared: the two disagree, and the receiver leads.
TEST(IntermediateCoupling, NoticesAnInertialUnitThatIsWrong) {
    Flight f = intermediate();
    for (ImuSample& m : f.recording.imu)
        if (m.time.seconds() > 50.0) m.accel.x() += 2.0 * (f.settings.imu.kind == ImuKind::Increments ? 0.1 : 1.0);
    const Result both = run(f);
    const auto leading = std::ranges::count_if(both.cross_checks, &CrossCheck::receiver_leads);
    EXPECT_GT(leading, 10);
    for (const CrossCheck& c : both.cross_checks) EXPECT_FALSE(c.receiver_leads && c.time.seconds() < 50.0);
    f.settings.coupling = Coupling::Tight;
    EXPECT_LT(error_within(f, both, 80.0, 120.0), 0.5 * error_within(f, run(f), 80.0, 120.0));
}

}  // namespace
}  // namespace schuler::fusion
