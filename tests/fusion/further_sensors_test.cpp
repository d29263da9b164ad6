// Odometer, heading sensor, smoother and further states in couplings that had them not: what they are worth on a simulated car.
#include "fusion/car_drive.h"
#include "fusion/range_flight.h"

#include "schuler/fusion/run_filter.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace schuler::fusion {
namespace {

using namespace testing;
using Eigen::Vector3d;

/// Forward speed and heading of the truth as instruments show them: the speed 3 % too large.
void add_instruments(Recording& recording) {
    math::Random random(5, "further sensors");
    for (std::size_t i = 0; i < recording.reference.size(); ++i) {
        const ReferenceSample& t = recording.reference[i];
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(t.rpy);
        recording.odometer.push_back({t.time, 1.03 * C_nb.col(0).dot(t.velocity_n) + 0.02 * random.normal(), 0.02});
        recording.heading.push_back({t.time, t.rpy.z() + 0.005 * random.normal(), 0.005});
    }
}

/// Largest horizontal error inside the outages, and whether north and east stayed inside three sigma.
struct OutageError {
    double most = 0.0;
    bool inside = true;
};
OutageError outage_error(const Result& result, const Recording& recording, double from, double to) {
    OutageError e;
    std::size_t k = 0;
    for (const SolutionRow& row : result.forward.rows) {
        const double t = (row.time - recording.gnss.front().time).seconds();
        if (t < from || t > to) continue;
        while (k + 1 < recording.reference.size() && recording.reference[k + 1].time <= row.time) ++k;
        if (recording.reference[k].time != row.time) continue;
        const Vector3d d = earth::ned_difference({}, row.position, recording.reference[k].position);
        e.most = std::max(e.most, d.head<2>().norm());
        e.inside = e.inside && std::abs(d.x()) < 3.0 * row.std_position.x() && std::abs(d.y()) < 3.0 * row.std_position.y();
    }
    return e;
}

TEST(FurtherSensors, OdometerAndHeadingCarryThroughAnOutage) {
    sim::Scenario scenario = town_drive(71, 1.0, 240.0);
    Recording recording = sim::simulate(scenario).recording;
    Settings settings = settings_of(scenario);
    settings.constraints.nonholonomic = true;
    settings.outages = {{150.0, 60.0}};
    WarningLog unheard;
    const OutageError without = outage_error(run_filter(recording, settings, unheard), recording, 150.0, 210.0);
    add_instruments(recording);
    const Result both = run_filter(recording, settings, unheard);
    const OutageError with = outage_error(both, recording, 150.0, 210.0);
    EXPECT_TRUE(with.inside);
    EXPECT_LT(with.most, 0.5 * without.most);
    EXPECT_LT(with.most, 3.0);
    // the scale is found, and told with its sigma
    const auto block = std::ranges::find(both.states, "odometer_scale", &LayoutBlock::name);
    ASSERT_NE(block, both.states.end());
    const auto at = static_cast<std::size_t>(block->offset - 9);
    const ParameterRow& last = both.forward.parameters.back();
    EXPECT_NEAR(last.value[at], 0.03, 3.0 * last.std[at]);
    EXPECT_LT(last.std[at], 0.005);
    EXPECT_GT(last.std[at], 0.0);
}

// From 100 s on it shows 60 deg too much: refused, but whether it or the heading is wrong it does not say.
TEST(FurtherSensors, AHeadingSensorThatIsRefusedLeavesTheHeadingInDoubt) {
    sim::Scenario scenario = town_drive(71, 1.0, 200.0);
    Recording recording = sim::simulate(scenario).recording;
    add_instruments(recording);
    recording.odometer.clear();
    const Time from = recording.gnss.front().time + Duration::from_seconds(100.0);
    for (HeadingSample& h : recording.heading)
        if (h.time > from && h.time < from + Duration::from_seconds(50.0)) h.heading += 60.0 * units::deg;
    WarningLog unheard;
    const Result result = run_filter(recording, settings_of(scenario), unheard);
    const auto sigma = [&](double t) {
        const auto row = std::ranges::lower_bound(result.forward.rows, recording.gnss.front().time + Duration::from_seconds(t),
                                                  {}, &SolutionRow::time);
        return row->std_rpy.z() / units::deg;
    };
    EXPECT_LT(sigma(99.0), 2.0);
    EXPECT_GT(sigma(140.0), 20.0);  // three of them cover both
    EXPECT_LT(sigma(160.0), 2.0);
}

TEST(FurtherSensors, ALogOfVelocityCarriesThroughAnOutageAndAGaugeKeepsTheHeight) {
    sim::Scenario scenario = town_drive(72, 1.0, 240.0);
    Recording recording = sim::simulate(scenario).recording;
    Settings settings = settings_of(scenario);
    settings.outages = {{150.0, 60.0}};
    settings.log = {.std = 0.02, .scale_std = 0.02, .misalignment_std = 0.02, .lever_arm_b = Vector3d::Zero()};
    settings.gauges = {.std = 0.05, .level_std = 10.0};
    WarningLog unheard;
    const OutageError without = outage_error(run_filter(recording, settings, unheard), recording, 150.0, 210.0);
    math::Random random(6, "log and gauge");
    const Eigen::Matrix3d turned = math::dcm_from_rpy({0.0, 0.01, -0.015});
    for (const ReferenceSample& t : recording.reference) {
        const Vector3d v_b = math::dcm_from_rpy(t.rpy).transpose() * t.velocity_n;
        recording.body_velocity.push_back({t.time, 1.01 * (turned * v_b) + 0.02 * random.normal3()});
        recording.gauges.push_back({t.time, {t.position.h + 5.0 + 0.05 * random.normal(), not_given, not_given}});
    }
    for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
        settings.mechanization = mechanization;
        const Result found = run_filter(recording, settings, unheard);
        const OutageError with = outage_error(found, recording, 150.0, 210.0);
        EXPECT_TRUE(with.inside);
        EXPECT_LT(with.most, 0.3 * without.most);
        const ParameterRow& last = found.forward.parameters.back();
        const auto expect_found = [&](std::string_view name, int i, double truth, double within) {
            const auto block = std::ranges::find(found.states, name, &LayoutBlock::name);
            ASSERT_NE(block, found.states.end()) << name;
            const auto at = static_cast<std::size_t>(block->offset - 9 + i);
            EXPECT_NEAR(last.value[at], truth, 3.5 * last.std[at]) << name;
            EXPECT_LT(last.std[at], within) << name;
        };
        expect_found("log_scale", 0, 0.01, 0.003);
        expect_found("log_misalignment", 0, 0.01, 0.01);
        expect_found("log_misalignment", 1, -0.015, 0.01);
        expect_found("gauge_level", 0, 5.0, 3.0);
    }
}

/// The tight coupling's smoother: better than its filter, and as good as it says.
TEST(FurtherSensors, TheTightFilterIsSmoothed) {
    test::Flight f = test::flight();
    f.settings.smooth = true;
    WarningLog unheard;
    for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
        f.settings.mechanization = mechanization;
        const Result result = run_filter(f.recording, f.settings, unheard);
        ASSERT_EQ(result.smoothed.rows.size(), result.forward.rows.size());
        double forward = 0.0, smoothed = 0.0, nees = 0.0, n = 0.0;
        std::size_t k = 0;
        for (std::size_t i = 0; i < result.smoothed.rows.size(); ++i) {
            const SolutionRow &s = result.smoothed.rows[i], &w = result.forward.rows[i];
            while (k + 1 < f.recording.reference.size() && f.recording.reference[k + 1].time <= s.time) ++k;
            if (f.recording.reference[k].time != s.time) continue;
            const Vector3d d = earth::ned_difference(f.earth, s.position, f.recording.reference[k].position);
            smoothed += d.squaredNorm();
            forward += earth::ned_difference(f.earth, w.position, f.recording.reference[k].position).squaredNorm();
            nees += d.cwiseQuotient(s.std_position).squaredNorm() / 3.0;
            n += 1.0;
            for (int axis = 0; axis < 3; ++axis) EXPECT_LE(s.std_position(axis), w.std_position(axis) * (1.0 + 1e-9));
        }
        ASSERT_GT(n, 20.0);
        EXPECT_LT(smoothed, 0.8 * forward);
        EXPECT_LT(nees / n, 4.0);
    }
}

}  // namespace
}  // namespace schuler::fusion
