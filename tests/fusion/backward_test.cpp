// The filter backward in time: the same motion, a solution of its own, a difference that says what both are worth.
#include "fusion/car_drive.h"
#include "fusion/range_flight.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

/// Forward minus backward over its sigma at the times of both, in [from, to] s of the log: one column a time.
Eigen::Matrix<double, 7, Eigen::Dynamic> standardised(const earth::Earth& earth, const Result& r, double from, double to) {
    std::vector<Eigen::Matrix<double, 7, 1>> all;
    std::size_t i = 0;
    for (const SolutionRow& b : r.backward) {
        while (i < r.forward.rows.size() && r.forward.rows[i].time < b.time) ++i;
        if (i == r.forward.rows.size()) break;
        const SolutionRow& f = r.forward.rows[i];
        const double t = b.time.seconds();
        if (f.time != b.time || t < from || t > to) continue;
        Eigen::Matrix<double, 7, 1> z;
        z.head<3>() = earth::ned_difference(earth, f.position, b.position)
                          .cwiseQuotient((f.std_position.cwiseAbs2() + b.std_position.cwiseAbs2()).cwiseSqrt());
        z.segment<3>(3) =
            (f.v_eb_n - b.v_eb_n).cwiseQuotient((f.std_velocity.cwiseAbs2() + b.std_velocity.cwiseAbs2()).cwiseSqrt());
        z(6) = math::wrap_pi(f.rpy.z() - b.rpy.z()) / std::hypot(f.std_rpy.z(), b.std_rpy.z());
        all.push_back(z);
    }
    Eigen::Matrix<double, 7, Eigen::Dynamic> out(7, static_cast<Eigen::Index>(all.size()));
    for (std::size_t k = 0; k < all.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = all[k];
    return out;
}

/// A drive with shaking off, filtered both ways; `recording` is what was filtered.
Result both_ways(std::uint64_t seed, Settings& settings, Recording& recording,
                 const std::function<void(Recording&)>& change = {}) {
    const sim::Scenario scenario = town_drive(seed);
    recording = sim::simulate(scenario).recording;
    settings = settings_of(scenario);
    give_start(settings, recording, seed);
    settings.constraints.zero_velocity = false;  // its pseudo-measurements have no noise of their own to be judged by
    settings.backward = true;
    if (change) change(recording);
    return fuse(recording, settings);
}

// Without fixes and sensor errors both ways are one path: signs of rates, velocity, the Earth's turn and the order of the increments.
TEST(Backward, InertialNavigationComesBackTheWayItWent) {
    sim::Scenario scenario = town_drive(1);
    scenario.imu.errors = {};
    Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    f.imu.errors = sensor::imu_grade("tactical");
    const ReferenceSample& truth = recording.reference.front();
    f.initial = {truth.time,
                 truth.position,
                 truth.velocity_n,
                 truth.rpy,
                 Vector3d::Ones(),
                 Vector3d::Constant(0.1),
                 Vector3d::Constant(0.1 * deg),
                 Vector3d::Zero(),
                 Vector3d::Zero()};
    f.constraints.zero_velocity = false;
    f.outages = {{-100.0, 1000.0}};
    f.backward = true;
    for (const Mechanization m : {Mechanization::Geographic, Mechanization::Ecef}) {
        f.mechanization = m;
        const Result r = fuse(recording, f);
        ASSERT_GT(r.backward.size(), 1900u);
        const SolutionRow& b = r.backward.front();
        const SolutionRow& a = *std::ranges::find(r.forward.rows, b.time, &SolutionRow::time);
        ASSERT_LT(a.time.seconds(), 1000.2);
        // the turn of the Earth with the wrong sign would be 2 * 7.3e-5 rad/s * 200 s = 29 mrad and 300 m
        EXPECT_LT(earth::ned_difference(f.earth, a.position, b.position).norm(), 0.05);
        EXPECT_LT((a.v_eb_n - b.v_eb_n).norm(), 1e-3);
        EXPECT_LT(std::abs(math::wrap_pi(a.rpy.z() - b.rpy.z())), 1e-5);
        EXPECT_GT(b.std_position.x(), r.backward.back().std_position.x());
    }
}

// Twelve runs of 160 s are worth some sixty independent epochs in position, two hundred in velocity (consistency_test.cpp), each of three
// axes, and eighty in heading: the bounds are three sigma of the mean squares.
TEST(Backward, SeparationHasTheSigmaThatBothStateAndTheErrorsAreIndependent) {
    double position = 0.0, velocity = 0.0, heading = 0.0, product = 0.0, square = 0.0;
    constexpr int seeds = 12;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        Settings f;
        Recording recording;
        const Result r = both_ways(seed, f, recording);
        const auto z = standardised(f.earth, r, 1020.0, 1180.0);
        ASSERT_GT(z.cols(), 1500);
        const double k = 1.0 / static_cast<double>(z.cols()) / seeds;
        position += k * z.topRows<3>().squaredNorm() / 3.0;
        velocity += k * z.middleRows<3>(3).squaredNorm() / 3.0;
        heading += k * z.row(6).squaredNorm();
        const auto forward = errors(f, r.forward.rows, recording), backward = errors(f, r.backward, recording);
        std::size_t i = 0;
        for (const analysis::ErrorRow& e : backward) {
            while (i < forward.size() && forward[i].time < e.time) ++i;
            if (i == forward.size() || forward[i].time != e.time) continue;
            const Vector3d ahead = forward[i].position.cwiseQuotient(forward[i].std_position),
                           back = e.position.cwiseQuotient(e.std_position);
            product += ahead.dot(back);
            square += 0.5 * (ahead.squaredNorm() + back.squaredNorm());
        }
    }
    EXPECT_NEAR(position, 1.0, 0.3);
    EXPECT_NEAR(velocity, 1.0, 0.18);
    EXPECT_NEAR(heading, 1.0, 0.45);
    EXPECT_LT(std::abs(product / square), 0.15);
}

TEST(Backward, ARowIsOfBeforeTheFixOfItsTime) {
    Settings f;
    Recording recording;
    const Result r = both_ways(1, f, recording);
    const auto sigma_at = [&](double t) {
        return std::ranges::find(r.backward, Time::from_seconds(t), &SolutionRow::time)->std_position.norm();
    };
    for (const double fix : {1050.0, 1100.0, 1150.0}) {
        EXPECT_GT(sigma_at(fix), 1.02 * sigma_at(fix - 0.1));  // which has used it
        EXPECT_GT(sigma_at(fix), sigma_at(fix + 0.1));
    }
}

TEST(Backward, FaultsShow) {
    Settings f;
    Recording recording;
    const auto outside = [&](const Result& r) -> Eigen::Matrix<double, 7, 1> {
        return (standardised(f.earth, r, 1030.0, 1170.0).array().abs() > 3.0).cast<double>().rowwise().mean();
    };
    EXPECT_LT(outside(both_ways(3, f, recording)).maxCoeff(), 0.02);
    const Result ramp = both_ways(3, f, recording, [](Recording& r) {
        for (GnssFix& s : r.gnss)
            if (const double since = s.time.seconds() - 1080.0; since > 0.0 && since <= 40.0) s.position.h += 0.3 * since;
    });
    EXPECT_GT(outside(ramp)(2), 0.15);  // the height, of which a fifth of the time is wrong
    EXPECT_LT(outside(ramp)(0), 0.02);
    const Result turning = both_ways(3, f, recording, [](Recording& r) {  // 0.2 deg/s for ten seconds; the log has increments
        for (ImuSample& s : r.imu)
            if (s.time.seconds() > 1100.0 && s.time.seconds() <= 1110.0) s.gyro.z() += 0.2 * deg * 0.01;
    });
    EXPECT_GT(outside(turning)(6), 0.15);
}

// Gauges and a log carry both ways through a gap of the fixes; a velocity of the log that keeps its sign would be refused.
TEST(Backward, GaugesAndLogAreUsedInTheirOwnTime) {
    Settings f;
    Recording recording;
    const Result r = both_ways(4, f, recording, [&](Recording& log) {
        math::Random random(4, "log and gauges");
        for (const ReferenceSample& t : log.reference) {
            log.body_velocity.push_back({t.time, math::dcm_from_rpy(t.rpy).transpose() * t.velocity_n + 0.02 * random.normal3()});
            log.gauges.push_back({t.time, Vector3d(t.position.h + 0.05 * random.normal(), not_given, not_given)});
        }
        f.outages = {{60.0, 80.0}};
    });
    const auto z = standardised(f.earth, r, 1020.0, 1180.0);
    ASSERT_GT(z.cols(), 1500);
    EXPECT_LT(z.rowwise().norm().maxCoeff() / std::sqrt(static_cast<double>(z.cols())), 1.8);
    const SolutionRow& inside = *std::ranges::find(r.backward, Time::from_seconds(1100.0), &SolutionRow::time);
    EXPECT_LT(inside.std_velocity.norm(), 0.1);  // with the unit alone 0.5 m/s after 40 s
    EXPECT_LT(inside.std_position.z(), 0.3);
}

// Ranges: their rows are made in the time of the log, with the Earth's turn while the signal travels and the clock as it runs.
TEST(Backward, RangesAreUsedInTheirOwnTime) {
    for (const Mechanization m : {Mechanization::Geographic, Mechanization::Ecef}) {
        test::Flight flight = test::flight();
        flight.settings.backward = true;
        flight.settings.mechanization = m;
        const Result r = test::run(flight);
        const auto z = standardised(flight.earth, r, 20.0, 100.0);
        ASSERT_GT(z.cols(), 70);
        EXPECT_LT(z.rowwise().norm().maxCoeff() / std::sqrt(static_cast<double>(z.cols())), 1.8);
        EXPECT_LT(r.backward[10].std_position.norm(), 6.0);
    }
}

TEST(Backward, WhatCannotGoBackIsRefusedByKey) {
    Settings f;
    Recording recording = sim::simulate(town_drive(1, 1.0, 30.0)).recording;
    f = settings_of(town_drive(1));
    f.backward = true;
    f.coupling = Coupling::Separate;
    try {
        (void)fuse(recording, f);
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("filter.backward"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace schuler::fusion
