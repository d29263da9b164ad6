// The state of every source over time, from records of measurements and samples as a run leaves them.
#include "schuler/solution/health.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace schuler::solution {
namespace {

using filter::MeasurementKind;
using filter::MeasurementStatus;

Time at(double t) { return Time{} + Duration::from_seconds(t); }

ImuSample imu_at(double t, double rate) {
    return {at(t), Eigen::Vector3d(rate, 0.5 * rate, 0.0), Eigen::Vector3d(0.1, rate, -9.8)};
}

filter::MeasurementRecord record(double t, MeasurementKind kind, MeasurementStatus status) {
    filter::MeasurementRecord r{};
    r.time = r.stamp = at(t);
    r.kind = kind;
    r.status = status;
    r.dof = 3;
    return r;
}

struct Span {
    SourceState state;
    double from, to;
};

void expect_spans(const std::vector<HealthInterval>& all, std::string_view source, const std::vector<Span>& wanted) {
    std::vector<HealthInterval> found;
    std::ranges::copy_if(all, std::back_inserter(found), [&](const HealthInterval& h) { return h.source == source; });
    ASSERT_EQ(found.size(), wanted.size()) << source;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_EQ(found[i].state, wanted[i].state) << source << ' ' << i;
        EXPECT_NEAR((found[i].from - Time{}).seconds(), wanted[i].from, 1e-6) << source << ' ' << i;
        EXPECT_NEAR((found[i].to - Time{}).seconds(), wanted[i].to, 1e-6) << source << ' ' << i;
    }
}

TEST(Health, FixesRefusedWithheldLeftOutAndMissing) {
    LoadedDataset data;
    fusion::Result result;
    const auto status = [](int t) {
        if (t == 7) return MeasurementStatus::Rejected;  // one alone is not a state
        if (t >= 20 && t < 30) return MeasurementStatus::Rejected;
        return t >= 40 && t < 50 ? MeasurementStatus::Withheld : MeasurementStatus::Accepted;
    };
    for (int t = 0; t <= 100; ++t) {
        if (t > 60 && t < 75) continue;  // neither a fix nor a record
        data.recording.gnss.push_back({});
        data.recording.gnss.back().time = at(t);
        if (t > 80 && t < 90) continue;  // a fix that the run never met
        result.measurements.push_back(record(t, MeasurementKind::GnssPosition, status(t)));
        result.measurements.push_back(record(t, MeasurementKind::GnssVelocity, MeasurementStatus::Accepted));
    }
    const std::vector<HealthInterval> all = health_of(data, result);
    using enum SourceState;
    expect_spans(all, "gnss_position",
                 // clang-format off
                 {{Used, 0, 19}, {Refused, 20, 29}, {Used, 30, 39}, {Withheld, 40, 49}, {Used, 50, 60}, {Silent, 60, 75}, {Used, 75, 80},
                  {LeftOut, 81, 89}, {Used, 90, 100}});
    // clang-format on
    expect_spans(all, "gnss_velocity", {{Used, 0, 60}, {Silent, 60, 75}, {Used, 75, 80}, {Silent, 80, 90}, {Used, 90, 100}});
    expect_spans(all, "baro", {});
}

/// A run from 0 to 1000 s.
fusion::Result run_of_1000_s() {
    fusion::Result result;
    result.forward.rows.resize(2);
    result.forward.rows.front().time = at(0.0);
    result.forward.rows.back().time = at(1000.0);
    return result;
}

TEST(Health, StatesThatChangeToAndFroAreOneIntervalThatSaysSo) {
    fusion::Result result;
    for (int t = 0; t < 100; ++t) {  // a fifth of a log refused, one by one; then alternating; then one among many
        const bool refused = t < 40 ? t % 5 == 4 : t < 70 ? t % 2 == 0 : t == 85;
        result.measurements.push_back(
            record(t, MeasurementKind::Baro, refused ? MeasurementStatus::Rejected : MeasurementStatus::Accepted));
        for (int k = 0; k < 10; ++k)  // ten a second: five used, two refused
            result.measurements.push_back(
                record(t + 0.1 * k, MeasurementKind::Mag,
                       (10 * t + k) % 7 > 4 ? MeasurementStatus::Rejected : MeasurementStatus::Accepted));
        result.measurements.push_back(
            record(t, MeasurementKind::Odometer, t % 20 == 3 ? MeasurementStatus::Rejected : MeasurementStatus::Accepted));
        result.measurements.push_back(
            record(t, MeasurementKind::Heading, t % 2 == 1 ? MeasurementStatus::Withheld : MeasurementStatus::Accepted));
    }
    const std::vector<HealthInterval> all = health_of({}, result);
    using enum SourceState;
    expect_spans(all, "baro", {{Used, 0, 3}, {PartlyRefused, 4, 68}, {Used, 69, 99}});
    expect_spans(all, "mag", {{Used, 0, 0.4}, {PartlyRefused, 0.5, 99.9}});
    const auto found =
        std::ranges::find_if(all, [](const HealthInterval& h) { return h.source == "mag" && h.state == PartlyRefused; });
    ASSERT_NE(found, all.end());
    EXPECT_NEAR(static_cast<double>(found->used) / static_cast<double>(found->samples), 5.0 / 7.0, 0.01);
    expect_spans(all, "odometer", {{Used, 0, 99}});
    expect_spans(all, "heading", {{PartlyUsed, 0, 99}});
}

TEST(Health, WhatWasNeverUsedIsNotPartlySo) {
    fusion::Result result;
    for (int t = 0; t < 100; ++t)
        result.measurements.push_back(record(t, MeasurementKind::Baro,
                                             t == 50   ? MeasurementStatus::Rejected
                                             : t == 51 ? MeasurementStatus::Withheld
                                                       : MeasurementStatus::Accepted));
    using enum SourceState;
    expect_spans(health_of({}, result), "baro", {{Used, 0, 49}, {Refused, 50, 51}, {Used, 52, 99}});
}

TEST(Health, OneFixInALongSilenceIsSeen) {
    fusion::Result result = run_of_1000_s();
    for (int t = 100; t <= 900; t += t == 300 || t == 600 ? 300 : 1)  // fixes up to 300, one at 600, and from 900 on none
        result.measurements.push_back(record(t, MeasurementKind::GnssVelocity, MeasurementStatus::Accepted));
    using enum SourceState;
    expect_spans(health_of({}, result), "gnss_velocity",
                 {{Silent, 0, 100},
                  {Used, 100, 300},
                  {Silent, 300, 600},
                  {Used, 600, 600},
                  {Silent, 600, 900},
                  {Used, 900, 900},
                  {Silent, 900, 1000}});
}

TEST(Health, FixesLeftOutAtTheEndsOfTheRunAreShown) {
    LoadedDataset data;
    fusion::Result result = run_of_1000_s();
    for (int t = -50; t <= 1100; ++t) {
        data.recording.gnss.push_back({});
        data.recording.gnss.back().time = at(t);
        if (t >= 200 && t <= 700)
            result.measurements.push_back(record(t, MeasurementKind::GnssPosition, MeasurementStatus::Accepted));
    }
    using enum SourceState;
    expect_spans(health_of(data, result), "gnss_position", {{LeftOut, 0, 199}, {Used, 200, 700}, {LeftOut, 701, 1000}});
    result.forward.rows.front().time = at(199.0);  // the fix of the start itself has no record
    result.forward.rows.back().time = at(700.5);
    expect_spans(health_of(data, result), "gnss_position", {{Used, 200, 700}});
}

TEST(Health, TheEndIsThatOfTheInertialLogWhereNoRowsWereKept) {
    LoadedDataset data;
    fusion::Result result;
    for (int i = 0; i <= 1000; ++i) data.recording.imu.push_back(imu_at(0.1 * i, 0.01 * std::sin(1.7 * i)));
    result.findings.started_at = at(10.0);
    for (int t = 10; t <= 40; ++t) result.measurements.push_back(record(t, MeasurementKind::Baro, MeasurementStatus::Accepted));
    using enum SourceState;
    expect_spans(health_of(data, result), "baro", {{Used, 10, 40}, {Silent, 40, 100}});
}

TEST(Health, PartsOfAFixOfDifferentAgesAreOneSample) {
    LoadedDataset data;
    fusion::Result result;
    for (int t = 0; t < 10; ++t) {
        result.measurements.push_back(record(t, MeasurementKind::GnssPosition, MeasurementStatus::Accepted));
        result.measurements.push_back(
            record(t, MeasurementKind::GnssPosition, t < 5 ? MeasurementStatus::Accepted : MeasurementStatus::Rejected));
    }
    const std::vector<HealthInterval> all = health_of(data, result);
    expect_spans(all, "gnss_position", {{SourceState::Used, 0, 4}, {SourceState::Refused, 5, 9}});
    EXPECT_EQ(all.front().samples, 5U);
}

TEST(Health, InertialUnitThatHasGapsAndHangs) {
    LoadedDataset data;
    for (int i = 0; i < 1000; ++i) {
        const double t = 0.01 * i;
        if (t > 3.0 && t < 4.0) continue;
        const double rate = i >= 600 && i < 700 ? 0.25 : 0.01 * std::sin(1.7 * i);
        data.recording.imu.push_back(imu_at(t, rate));
    }
    const std::vector<HealthInterval> all = health_of(data, {});
    using enum SourceState;
    ASSERT_EQ(all.size(), 5U);
    const std::array<SourceState, 5> states{Used, Silent, Used, Hanging, Used};
    for (std::size_t i = 0; i < states.size(); ++i) EXPECT_EQ(all[i].state, states[i]) << i;
    EXPECT_NEAR((all[1].from - Time{}).seconds(), 3.0, 0.011);
    EXPECT_NEAR((all[1].to - Time{}).seconds(), 4.0, 0.011);
    EXPECT_NEAR((all[3].from - Time{}).seconds(), 6.0, 0.15) << "known after a tenth of a second";
    EXPECT_NEAR((all[3].to - Time{}).seconds(), 6.99, 0.02);
}

TEST(Health, AReceiverIsInDisputeWhereItsVelocitiesAreRefusedForSeconds) {
    const auto disputes = [](int until) {
        fusion::Result result;
        for (int k = 0; k < 600; ++k) {
            const double t = 0.5 * k;
            const bool briefly = t > 40.2 && t<42.3, for_a_while = t> 200.2 && t < until;
            result.measurements.push_back(record(t, MeasurementKind::GnssPosition, MeasurementStatus::Accepted));
            result.measurements.push_back(
                record(t, MeasurementKind::GnssVelocity,
                       briefly || for_a_while ? MeasurementStatus::Rejected : MeasurementStatus::Accepted));
        }
        return disputes_of(health_of({}, result));
    };
    const std::vector<HealthInterval> found = disputes(206);
    ASSERT_EQ(found.size(), 1u);
    expect_spans(found, "gnss_velocity", {{SourceState::Refused, 200.5, 205.5}});
    EXPECT_TRUE(disputes(290).empty());  // velocities that say nothing about the positions
}

}  // namespace
}  // namespace schuler::solution
