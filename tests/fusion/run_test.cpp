// Whole runs over a simulated town drive: both mechanizations, repeatability, gaps, outliers, outages.
#include "fusion/car_drive.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

/// A drive with a given start, which saves the search for the heading.
Drive recorded_drive(std::uint64_t seed, double gnss_rate = 1.0, bool shaking = true) {
    Drive d;
    d.scenario = town_drive(seed, gnss_rate);
    if (shaking) shake(d.scenario);
    d.recording = sim::simulate(d.scenario).recording;
    d.settings = settings_of(d.scenario);
    give_start(d.settings, d.recording, seed);
    return d;
}

/// Rows of two solutions compared, equal times asked for.
struct Difference {
    double position = 0.0, velocity = 0.0, attitude = 0.0, sigma = 0.0;  ///< largest, m, m/s, rad, relative
};
Difference difference(const earth::Earth& earth, const std::vector<SolutionRow>& a, const std::vector<SolutionRow>& b) {
    Difference d;
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        EXPECT_EQ(a[i].time, b[i].time);
        d.position = std::max(d.position, earth::ned_difference(earth, a[i].position, b[i].position).norm());
        d.velocity = std::max(d.velocity, (a[i].v_eb_n - b[i].v_eb_n).norm());
        const Eigen::Matrix3d turn = math::dcm_from_rpy(a[i].rpy) * math::dcm_from_rpy(b[i].rpy).transpose();
        d.attitude = std::max(d.attitude, Eigen::AngleAxisd(turn).angle());
        for (const auto& [x, y] : {std::pair{a[i].std_position, b[i].std_position},
                                   {a[i].std_velocity, b[i].std_velocity},
                                   {a[i].std_rpy, b[i].std_rpy}})
            d.sigma = std::max(d.sigma, (x - y).cwiseQuotient(x).cwiseAbs().maxCoeff());
    }
    return d;
}

bool same_bits(const std::vector<SolutionRow>& a, const std::vector<SolutionRow>& b) {
    const auto numbers = [](const SolutionRow& r) {
        std::array<double, 18> x{r.position.lat, r.position.lon, r.position.h};
        std::size_t n = 3;
        for (const Vector3d& v : {r.v_eb_n, r.rpy, r.std_position, r.std_velocity, r.std_rpy})
            for (int i = 0; i < 3; ++i) x[n++] = v(i);
        return x;
    };
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const SolutionRow& x, const SolutionRow& y) {
        const std::array<double, 18> p = numbers(x), q = numbers(y);
        return x.time == y.time && std::memcmp(p.data(), q.data(), sizeof p) == 0;
    });
}

TEST(Run, FramesAgree) {
    Drive d = recorded_drive(1);
    d.settings.smooth = true;
    d.settings.scale_factors = true;
    d.settings.constraints.nonholonomic = true;
    const Result n = fuse(d.recording, d.settings);
    d.settings.mechanization = Mechanization::Ecef;
    const Result e = fuse(d.recording, d.settings);
    ASSERT_GT(n.forward.rows.size(), 1990u);
    const Difference forward = difference(d.settings.earth, n.forward.rows, e.forward.rows);
    const Difference smoothed = difference(d.settings.earth, n.smoothed.rows, e.smoothed.rows);
    for (const Difference& x : {forward, smoothed}) {
        EXPECT_LT(x.position, 1e-4);
        EXPECT_LT(x.velocity, 1e-4);
        EXPECT_LT(x.attitude, 0.001 * deg);
        EXPECT_LT(x.sigma, 1e-4);
    }
    std::array<int, 7> kinds{};
    for (const MeasurementRecord& a : n.measurements)
        kinds[static_cast<std::size_t>(a.kind)] += a.status == MeasurementStatus::Accepted ? 1 : 0;
    for (const MeasurementKind kind : {MeasurementKind::GnssPosition, MeasurementKind::GnssVelocity,
                                       MeasurementKind::ZeroVelocity, MeasurementKind::ZeroRate, MeasurementKind::Nonholonomic})
        EXPECT_GT(kinds[static_cast<std::size_t>(kind)], 20) << static_cast<int>(kind);
    EXPECT_EQ(n.counters.gnss_accepted, e.counters.gnss_accepted);
    EXPECT_EQ(n.forward.rows.size(), n.smoothed.rows.size());
}

TEST(Run, RepeatsBitByBit) {
    Drive d = recorded_drive(2);
    d.settings.smooth = true;
    const Result first = fuse(d.recording, d.settings), second = fuse(d.recording, d.settings);
    EXPECT_TRUE(same_bits(first.forward.rows, second.forward.rows));
    EXPECT_TRUE(same_bits(first.smoothed.rows, second.smoothed.rows));
    EXPECT_FALSE(same_bits(first.forward.rows, first.smoothed.rows));
}

TEST(Run, TwoThreadsGiveTheSame) {
    Drive d = recorded_drive(3);
    d.settings.smooth = true;
    const Result alone = fuse(d.recording, d.settings);
    std::array<Result, 2> results;
    {
        std::vector<std::jthread> threads;
        for (Result& r : results) threads.emplace_back([&r, &d] { r = fuse(d.recording, d.settings); });
    }
    for (const Result& r : results) {
        EXPECT_TRUE(same_bits(alone.forward.rows, r.forward.rows));
        EXPECT_TRUE(same_bits(alone.smoothed.rows, r.smoothed.rows));
    }
}

TEST(Run, ShortImuGapsCostLittle) {
    const Drive whole = recorded_drive(4, 5.0);
    const Result reference = fuse(whole.recording, whole.settings);
    for (const double at : {40.0, 75.0, 110.0, 150.0}) {
        Drive d = whole;
        const double from = d.scenario.origin.seconds() + at;
        std::erase_if(d.recording.imu, [from](const ImuSample& s) {
            return s.time.seconds() > from + 1e-6 && s.time.seconds() < from + 0.5 + 1e-6;
        });
        ASSERT_EQ(d.recording.imu.size() + 50, whole.recording.imu.size());
        const Result r = fuse(d.recording, d.settings);
        EXPECT_EQ(r.counters.imu_gaps, 1u);
        double cost = 0.0;
        const auto a = errors(d.settings, reference.forward.rows, d.recording);
        const auto b = errors(d.settings, r.forward.rows, d.recording);
        for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
            if (a[i].time.seconds() > from && a[i].time.seconds() < from + 0.5) continue;
            cost = std::max(cost, (a[i].position - b[i].position).norm());
        }
        EXPECT_LT(cost, 0.2) << at;
        EXPECT_GT(cost, 1e-6) << at;
    }
}

TEST(Run, OutliersAreRejected) {
    Drive d = recorded_drive(5);
    const Result clean = fuse(d.recording, d.settings);
    const std::array<std::size_t, 5> outliers{30, 62, 95, 131, 170};
    double angle = 0.3;
    for (const std::size_t k : outliers) {
        GnssFix& fix = d.recording.gnss[k];
        const Vector3d far(10.0 * std::cos(angle), 10.0 * std::sin(angle), 0.0);
        fix.position = earth::moved_by_ned(d.settings.earth, fix.position, far);
        angle += 1.7;
    }
    const Result r = fuse(d.recording, d.settings);
    std::size_t wrong = 0, lost = 0;
    for (const MeasurementRecord& a : r.measurements) {
        if (a.kind != MeasurementKind::GnssPosition) continue;
        const auto k = static_cast<std::size_t>(std::lround((a.stamp - d.scenario.origin).seconds()));
        const bool outlier = std::find(outliers.begin(), outliers.end(), k) != outliers.end();
        wrong += outlier && a.status != MeasurementStatus::Rejected ? 1 : 0;
        lost += !outlier && a.status == MeasurementStatus::Rejected ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(lost, 0u);
    EXPECT_EQ(r.counters.gnss_rejected, clean.counters.gnss_rejected + outliers.size());
    EXPECT_LT(difference(d.settings.earth, clean.forward.rows, r.forward.rows).position, 0.3);
}

// Five seconds of fixes 60 m beside the road, right when the filter is least certain: with true velocities and with false ones.
TEST(Run, ClusterAfterAnOutageDoesNotCaptureTheFilter) {
    for (const bool false_velocity : {false, true}) {
        Drive d = recorded_drive(6, 1.0, false);  // without zero-velocity updates
        d.settings.outages = {{70.0, 60.0}};
        const Result clean = fuse(d.recording, d.settings);
        const auto clean_errors = errors(d.settings, clean.forward.rows, d.recording);
        for (std::size_t k = 130; k < 135; ++k) {
            GnssFix& fix = d.recording.gnss[k];
            fix.position = earth::moved_by_ned(d.settings.earth, fix.position, Vector3d(40.0, -45.0, 0.0));
            if (false_velocity) fix.velocity_n += Vector3d(-4.0, 3.0, 0.0);
        }
        const Result r = fuse(d.recording, d.settings);
        const auto bad = errors(d.settings, r.forward.rows, d.recording);
        EXPECT_EQ(r.counters.gnss_withheld, 59u);
        EXPECT_GT(worst_horizontal(clean_errors, 70.0), 30.0);
        EXPECT_LT(worst_horizontal(bad, 160.0), 5.0);
        std::size_t late = 0;
        for (const MeasurementRecord& a : r.measurements)
            late +=
                a.kind == MeasurementKind::GnssPosition && a.status == MeasurementStatus::Rejected && a.stamp.seconds() > 1160.0
                    ? 1
                    : 0;
        EXPECT_EQ(late, 0u);
    }
}

// Heights with an age of their own are measurements of their own: good ones must not keep the filter from a position that is right.
TEST(Run, AGoodHeightDoesNotExcuseABadPosition) {
    Drive d = recorded_drive(12);
    d.settings.gnss.height_latency = 0.02;
    for (GnssFix& fix : d.recording.gnss) {
        if ((fix.time - d.scenario.origin).seconds() > 100.0)
            fix.position = earth::moved_by_ned(d.settings.earth, fix.position, Vector3d(30.0, -20.0, 0.0));
        fix.velocity_n.setConstant(not_given);
    }
    const Result r = fuse(d.recording, d.settings);
    const auto e = errors(d.settings, r.forward.rows, d.recording);
    EXPECT_NEAR(e.back().position.head<2>().norm(), std::hypot(30.0, 20.0), 1.0);  // the shift is the receiver's truth
    EXPECT_LT(r.counters.gnss_rejected, 15u);
}

TEST(Run, OutageTableIsAtTheAntenna) {
    Drive d = recorded_drive(8);
    d.settings.outages = {{60.0, 30.0}};
    d.settings.smooth = true;
    const Result r = fuse(d.recording, d.settings);
    ASSERT_EQ(r.forward.outage_epochs.size(), 30u);
    ASSERT_EQ(r.smoothed.outage_epochs.size(), 30u);
    for (std::size_t i = 0; i < 30; ++i) {
        const OutageEpoch& e = r.forward.outage_epochs[i];
        const auto k = static_cast<std::size_t>(61 + i);
        EXPECT_EQ(e.time, d.recording.gnss[k].time);
        EXPECT_EQ(e.end, i == 29);
        EXPECT_EQ(r.smoothed.outage_epochs[i].time, e.time);
        // The same from the solution's row of that time, turned and moved to the antenna. An end row is after its update.
        if (e.end) continue;
        for (const auto& [rows, epoch, tolerance] :
             {std::tuple{&r.forward.rows, e, 1e-5}, {&r.smoothed.rows, r.smoothed.outage_epochs[i], 1e-2}}) {
            const auto row = std::find_if(rows->begin(), rows->end(), [&](const SolutionRow& x) { return x.time == e.time; });
            ASSERT_NE(row, rows->end());
            const Vector3d arm = math::dcm_from_rpy(row->rpy) * d.settings.gnss.lever_arm_b;
            const Vector3d error = earth::ned_difference(d.settings.earth, row->position, d.recording.gnss[k].position) + arm;
            EXPECT_LT((error - epoch.error).norm(), tolerance);
        }
    }
    for (std::size_t i = 10; i < 29; ++i)
        EXPECT_GT(r.forward.outage_epochs[i].sigma.norm(), r.smoothed.outage_epochs[i].sigma.norm());
}

TEST(Run, RefusesDataWithoutOverlap) {
    Drive d = recorded_drive(9);
    for (GnssFix& fix : d.recording.gnss) fix.time = fix.time + Duration::from_seconds(1e5);
    // A complete initial state is a start of its own: inertial navigation alone, and a warning.
    WarningLog warnings;
    EXPECT_NO_THROW((void)run_filter(d.recording, d.settings, warnings));
    EXPECT_EQ(warnings.count("time.overlap"), 1u);
    d.settings.initial = {};
    EXPECT_THROW((void)fuse(d.recording, d.settings), Error);
    d.recording.imu.clear();
    EXPECT_THROW((void)fuse(d.recording, d.settings), Error);
}

}  // namespace
}  // namespace schuler::fusion
