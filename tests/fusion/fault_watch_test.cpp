// What a wrong pseudorange does to the tight filter, foretold by the fault watch, against running the filter twice; repair; levels.
#include "schuler/filter/integrity/fault_watch.h"
#include "fusion/range_flight.h"
#include "schuler/fusion/run_pass.h"
#include "schuler/fusion/timeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace schuler::fusion {
namespace {

using namespace test;
using Eigen::Vector3d;

/// Runs the tight filter along a flight up to `stop` seconds and returns it.
FilterRun<GeographicFrame> run_at(const Flight& f, double stop) {
    WarningLog unheard;
    RunData data;
    data.recording = &f.recording;
    data.imu = make_imu_timeline(f.recording.imu, f.settings.imu, unheard);
    const InertialModel model = make_model(f.settings, make_layout(f.settings, {}));
    Start start;
    NavState& nav = start.nav;
    nav.time = data.imu.increments.front().time;
    nav.position = f.settings.initial.position;
    nav.v_eb_n = f.settings.initial.velocity_n;
    nav.q_nb = math::quaternion_from_rpy(f.settings.initial.rpy);
    start.std_position.setConstant(10.0);
    start.std_velocity.setConstant(2.0);
    start.std_rpy.setConstant(1e-3);
    start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-5);
    start.increment = 1;
    FilterRun<GeographicFrame> run = first_step<GeographicFrame>(model, data, f.settings, start);
    run.next_output = Time{INT64_MAX};
    PassObserver<GeographicFrame> nobody;
    const Pass<GeographicFrame> pass(model, data, f.settings);
    std::size_t last = 0;
    while (last + 1 < data.imu.increments.size() && data.imu.increments[last + 1].time.seconds() < stop + 0.01) ++last;
    pass.advance(run, last, nobody);
    pass.propagate_covariance(run, nobody);
    return run;
}

/// A metre on one satellite from the first epoch on moves the whole nonlinear filter as the hypothesis says, and the size that the
/// watch estimates by a metre: the filter run twice is the oracle.
TEST(FaultWatch, RespondsAsTheFilterRunTwice) {
    Flight clean = flight();
    clean.settings.constraints.gate_probability = 0.0;
    clean.settings.ranging.protection.use = true;
    clean.settings.ranging.protection.false_alarm = 1e-15;
    Flight spoilt = clean;
    const std::uint16_t source = 3;
    spoil(spoilt.recording.ranges, source, 0.0, 1.0);
    const FilterRun<GeographicFrame> a = run_at(clean, 45.0), b = run_at(spoilt, 45.0);
    const int clock = make_layout(clean.settings, {}).clock;
    const auto oldest = [&](const FilterRun<GeographicFrame>& w) {
        return *std::ranges::find(w.ranges.watch.all, static_cast<int>(source), &FaultHypothesis::source);
    };
    const auto of_a = oldest(a), of_b = oldest(b);
    ASSERT_LT(of_a.since.seconds(), 1.5);
    const Vector3d moved = earth::ned_difference(clean.earth, b.filter.nav.position, a.filter.nav.position);
    EXPECT_GT(moved.norm(), 0.1);
    EXPECT_LT((moved - of_a.response.head<3>()).norm(), 2e-3 * moved.norm());
    const Vector3d faster = b.filter.nav.v_eb_n - a.filter.nav.v_eb_n;
    EXPECT_LT((faster - of_a.response.segment<3>(3)).norm(), 5e-3 * faster.norm());
    EXPECT_NEAR(b.filter.parameters(clock) - a.filter.parameters(clock), of_a.response(clock), 2e-3);
    EXPECT_NEAR((of_b.evidence - of_a.evidence) / of_a.information, 1.0, 2e-3);
    EXPECT_NEAR(of_b.information, of_a.information, 1e-3 * of_a.information);
}

/// Without the test of single epochs a fault of 60 m is found, named, and what it did is undone; with neither it stays.
TEST(FaultWatch, FindsNamesAndRepairs) {
    for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
        Flight f = flight();
        f.settings.mechanization = mechanization;
        f.settings.constraints.gate_probability = 0.0;
        const double healthy = largest_error(f, run(f), 60.0);
        spoil(f.recording.ranges, 2, 60.0, 60.0);
        EXPECT_GT(largest_error(f, run(f), 70.0), healthy + 3.0);
        f.settings.ranging.protection.use = true;
        const Result watched = run(f);
        EXPECT_LT(largest_error(f, watched, 70.0), healthy + 3.0);
        int alarms = 0;
        ASSERT_EQ(watched.forward.protection.size(), 120U);
        for (const ProtectionRow& row : watched.forward.protection) {
            if (row.alarm < 0) continue;
            ++alarms;
            EXPECT_EQ(row.alarm, 2);
            EXPECT_GE(row.time.seconds(), 60.0 - 1e-3);
            EXPECT_LT(row.time.seconds(), 64.0);
        }
        EXPECT_EQ(alarms, 1);
    }
}

/// Without one source: what the watch keeps as a difference is the filter that was never given it, the filter run without it is the oracle.
TEST(FaultWatch, KeepsTheFilterWithoutASource) {
    Flight with = flight();
    with.settings.constraints.gate_probability = 0.0;
    with.settings.ranging.protection.use = true;
    with.settings.ranging.protection.false_alarm = 1e-15;
    const std::uint16_t source = 3;
    Flight without = with;
    for (RangeSample& m : without.recording.ranges.samples)
        if (m.source == source) m.tx.r.setConstant(std::numeric_limits<double>::quiet_NaN());
    const FilterRun<GeographicFrame> a = run_at(with, 45.0), b = run_at(without, 45.0);
    const auto w = std::ranges::find(a.ranges.watch.without, static_cast<int>(source), &WithoutSource::source);
    ASSERT_NE(w, a.ranges.watch.without.end());
    const Vector3d apart = earth::ned_difference(with.earth, b.filter.nav.position, a.filter.nav.position);
    EXPECT_GT(apart.norm(), 0.1);
    EXPECT_LT((apart - w->offset.head<3>()).norm(), 2e-3 * apart.norm());
    const Matrix9 more = b.filter.P.topLeftCorner<9, 9>() - a.filter.P.topLeftCorner<9, 9>(),
                  kept = w->excess.topLeftCorner<9, 9>();
    EXPECT_GT(more(0, 0), 0.01);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(kept(i, i), more(i, i), 2e-3 * more(i, i)) << i;
}

/// A range that grows wrong so slowly that its slow error learns it at each epoch: found, named, and what it did is undone.
TEST(FaultWatch, FreesTheSolutionOfASlowRamp) {
    for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
        Flight f = flight();
        f.settings.mechanization = mechanization;
        const double healthy = largest_error(f, run(f), 30.0);
        RangingLog& log = f.recording.ranges;
        for (const RangeEpoch& e : log.epochs)
            for (std::size_t i = e.first; e.time.seconds() > 30.0 && i < e.first + e.count; ++i) {
                if (log.samples[i].source != 2) continue;
                log.samples[i].pseudorange += 0.2 * (e.time.seconds() - 30.0);
                log.samples[i].range_rate += 0.2;
            }
        f.settings.ranging.protection.use = true;
        WarningLog heard;
        const Result watched = run_filter(f.recording, f.settings, heard);
        EXPECT_LT(largest_error(f, watched, 30.0), healthy + 3.0);
        int alarms = 0;
        for (const ProtectionRow& row : watched.forward.protection) {
            if (row.alarm < 0) continue;
            ++alarms;
            EXPECT_EQ(row.alarm, 2);
        }
        EXPECT_EQ(alarms, 1);
        EXPECT_TRUE(std::ranges::any_of(heard.topics(), [](const std::string& t) { return t.starts_with("ranges.fault."); }));
    }
}

/// The smoother cannot take a fault out of the past: the source is left out of the run.
TEST(FaultWatch, IsAskedBeforeSmoothing) {
    Flight f = flight();
    f.settings.smooth = true;
    const auto error = [&](WarningLog& heard) {
        const Result result = run_filter(f.recording, f.settings, heard);
        double out = 0.0;
        for (const SolutionRow& row : result.smoothed.rows) {
            const auto k = static_cast<std::size_t>(std::llround(row.time.seconds()));
            if (k < f.recording.reference.size() && std::abs(row.time.seconds() - static_cast<double>(k)) < 1e-6)
                out = std::max(out,
                               earth::ned_difference(f.earth, row.position, f.recording.reference[k].position).head<2>().norm());
        }
        EXPECT_GT(result.smoothed.rows.size(), 100U);
        return out;
    };
    WarningLog unheard, heard, again;
    const double healthy = error(unheard);
    for (const RangeEpoch& e : f.recording.ranges.epochs)
        for (std::size_t i = e.first; e.time.seconds() > 30.0 && i < e.first + e.count; ++i)
            if (RangeSample& m = f.recording.ranges.samples[i]; m.source == 2) {
                m.pseudorange += 0.3 * (e.time.seconds() - 30.0);
                m.range_rate += 0.3;
            }
    const double spoilt = error(unheard);
    f.settings.ranging.protection.use = true;
    EXPECT_LT(error(heard), healthy + 2.0);
    EXPECT_GT(spoilt, healthy + 5.0) << "a fault that does no harm proves nothing";
    EXPECT_EQ(std::ranges::count_if(heard.topics(), [](const std::string& t) { return t.starts_with("ranges.fault."); }), 1);
    f.recording.ranges = flight().recording.ranges;
    EXPECT_NEAR(error(again), healthy, 1e-9) << "of healthy ranges all are used";
}

/// One state measured once: levels in closed form.
TEST(FaultWatch, LevelsOfOneScalar) {
    FaultWatch watch;
    StateMatrix P = StateMatrix::Zero(16, 16);
    P(0, 0) = 9.0;
    estim::Row row;
    row.head(0) = 1.0;
    watch.begin(7, Time{}, P.rows());
    const WatchedScalar scalar{&row, 2.0, 16.0, 7, false};
    watch.follow(P, {&scalar, 1}, Time{}, 16);
    ASSERT_EQ(watch.all.size(), 1U);
    EXPECT_NEAR(watch.all[0].information, 1.0 / 25.0, 1e-15);
    EXPECT_NEAR(watch.all[0].evidence / watch.all[0].information, -2.0, 1e-12);
    EXPECT_NEAR(watch.all[0].response(0), 9.0 / 25.0, 1e-15);
    ProtectionSettings settings;
    settings.missed_detection = 1e-3;
    settings.false_alarm = 1e-7;
    settings.fault_free = 1e-7;
    const ProtectionLimits limits(settings);
    EXPECT_NEAR(limits.test, 5.326724, 1e-5);  // quantiles of the normal distribution
    EXPECT_NEAR(limits.bias, 3.090232, 1e-5);
    EXPECT_NEAR(limits.vertical, 3.290527, 1e-5);
    Eigen::Matrix<double, 3, 9> T = Eigen::Matrix<double, 3, 9>::Zero();
    T(0, 0) = 1.0;
    Eigen::Matrix3d after = Eigen::Matrix3d::Zero();
    after(0, 0) = 9.0 * 16.0 / 25.0;
    after(2, 2) = 1.0;
    const ProtectionLevels l = watch.levels(limits, after, T);
    EXPECT_NEAR(l.horizontal, (limits.test + limits.bias) * 5.0 * 9.0 / 25.0 + std::sqrt(-2.0 * std::log(1e-3)) * 2.4, 1e-9);
    EXPECT_NEAR(l.vertical, limits.vertical_free, 1e-9);
}

/// Starts are kept at ages that about double, the first and the last always.
TEST(FaultWatch, KeepsYoungAndOldStarts) {
    FaultWatch watch;
    for (int t = 1; t <= 1000; ++t) watch.begin(1, Time::from_seconds(t), 16);
    ASSERT_EQ(watch.all.size(), watch.most_ages);
    EXPECT_EQ(watch.all.front().since, Time::from_seconds(1));
    EXPECT_EQ(watch.all.back().since, Time::from_seconds(1000));
    for (std::size_t i = 0; i + 2 < watch.all.size(); ++i) {
        const double older = 1000.0 - watch.all[i].since.seconds(), younger = 1000.0 - watch.all[i + 1].since.seconds();
        EXPECT_GT(older, younger);
        EXPECT_LT(older, 6.0 * younger);
    }
}

}  // namespace
}  // namespace schuler::fusion
