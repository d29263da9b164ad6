#include "schuler/solution/bundle.h"
#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outputs.h"
#include "schuler/report/summary.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace schuler::report {
namespace {

using Json = nlohmann::json;

/// A solution that is 3 m north, 4 m east and 1 m below of the truth for 200 s at 10 Hz, with an outage of 10 s.
solution::ResultBundle hand_made(bool smoothed) {
    solution::ResultBundle b;
    b.command = "process";
    b.version = "1.2.3";
    b.name = "hand made";
    b.data.config.filter.smooth = smoothed;
    b.data.config.filter.outages = {{100.0, 10.0}};
    const Geodetic place{0.8, 0.2, 100.0};
    for (int i = 0; i <= 2000; ++i) {
        SolutionRow row{Time::from_seconds(0.1 * i),
                        earth::moved_by_ned(b.data.config.filter.earth, place, {3.0, 4.0, 1.0}),
                        {0.3, 0.4, 0.0},
                        {0.0, 0.0, 359.5 * units::deg},
                        Eigen::Vector3d::Constant(2.0),
                        Eigen::Vector3d::Constant(0.5),
                        Eigen::Vector3d::Constant(0.01)};
        b.result.forward.rows.push_back(row);
        row.position = earth::moved_by_ned(b.data.config.filter.earth, place, {0.3, 0.4, 0.1});
        if (smoothed) b.result.smoothed.rows.push_back(row);
        b.data.recording.reference.push_back({row.time, place, Eigen::Vector3d::Zero(), {0.0, 0.0, 0.5 * units::deg}, true});
    }
    for (int i = 0; i < 50; ++i) {
        fusion::MeasurementRecord r{};
        r.time = r.stamp = Time::from_seconds(3.0 * i + 50.0);
        r.kind = fusion::MeasurementKind::GnssPosition;
        r.status = i % 10 == 0 ? fusion::MeasurementStatus::Rejected : fusion::MeasurementStatus::Accepted;
        r.dof = 3;
        r.innovation.setConstant(i % 2 == 0 ? 1.0 : -1.0);
        r.sigma.setConstant(1.0);
        r.nis = 3.0;
        b.result.measurements.push_back(r);
    }
    b.result.counters.imu_epochs = 20000;
    b.result.counters.imu_rate = 100.0;
    b.result.counters.imu_gaps = 2;
    b.result.counters.gnss_epochs = 50;
    b.result.filter_seconds = 0.02;
    b.result.findings.aligned_at = Time::from_seconds(5.0);
    b.warnings = {"one \"quoted\" warning"};
    b.evaluation = solution::evaluate(b.data, b.result, {});
    return b;
}

TEST(Summary, HasEveryFieldOfTheContract) {
    const Json s = Json::parse(summary_json(hand_made(true)));
    for (const char* key : {"name",        "command",    "scheme",  "mechanization", "loop",      "smoothed", "seed",
                            "version",     "duration_s", "imu",     "gnss",          "reference", "errors",   "settled_after_s",
                            "consistency", "outages",    "gravity", "montecarlo",    "timing",    "warnings"}) {
        EXPECT_TRUE(s.contains(key)) << key;
    }
    EXPECT_EQ(s["scheme"], "loose");
    EXPECT_EQ(s["mechanization"], "geographic");
    EXPECT_EQ(s["loop"], "closed");
    EXPECT_EQ(s["smoothed"], true);
    EXPECT_EQ(s["point"], "imu");
    solution::ResultBundle receiver = hand_made(true);
    receiver.data.config.scheme = settings::Scheme::Gnss;
    EXPECT_EQ(Json::parse(summary_json(receiver))["point"], "antenna");
    EXPECT_TRUE(s["seed"].is_null());
    EXPECT_EQ(s["imu"]["epochs"], 20000);
    EXPECT_EQ(s["imu"]["gaps"], 2);
    EXPECT_NEAR(s["duration_s"].get<double>(), 200.0, 1e-9);
    EXPECT_EQ(s["reference"], "file");
    EXPECT_NEAR(s["settled_after_s"].get<double>(), 65.0, 1e-9);
    for (const char* axis : {"east", "north", "up", "horizontal", "three_d"}) {
        for (const char* what : {"rms", "p95", "max"}) {
            EXPECT_TRUE(s["errors"]["position_m"][axis][what].is_number()) << axis;
            EXPECT_TRUE(s["errors"]["position_m_forward"][axis][what].is_number()) << axis;
        }
    }
    EXPECT_NEAR(s["errors"]["position_m"]["horizontal"]["rms"].get<double>(), 0.5, 1e-5);
    EXPECT_NEAR(s["errors"]["position_m_forward"]["horizontal"]["rms"].get<double>(), 5.0, 1e-4);
    EXPECT_NEAR(s["errors"]["position_m_forward"]["up"]["max"].get<double>(), 1.0, 1e-4);
    EXPECT_NEAR(s["errors"]["velocity_m_s"]["east"]["p95"].get<double>(), 0.4, 1e-9);
    EXPECT_NEAR(s["errors"]["attitude_deg"]["heading"]["rms"].get<double>(), 1.0, 1e-9);  // across north
    EXPECT_TRUE(s["errors"]["gyro_bias_deg_h"].is_null());
    for (const char* block : {"nees_position", "nees_velocity", "nees_attitude"}) {
        for (const char* what : {"mean", "expected", "low95", "high95"})
            EXPECT_TRUE(s["consistency"][block].contains(what)) << block;
    }
    const Json& nis = s["consistency"]["nis"];
    EXPECT_EQ(nis["gnss_position"]["dof"], 3);
    EXPECT_EQ(nis["gnss_position"]["accepted"].get<int>() + nis["gnss_position"]["rejected"].get<int>(), 45);  // from 65 s on
    EXPECT_TRUE(nis["gnss_position"].contains("lag1"));
    EXPECT_TRUE(nis["pseudorange"].is_null());
    ASSERT_EQ(s["outages"].size(), 1u);
    EXPECT_NEAR(s["outages"][0]["start_s"].get<double>(), 100.0, 1e-9);
    EXPECT_NEAR(s["outages"][0]["end_horizontal_m"].get<double>(), 0.5, 1e-4);
    // at its end the forward solution is the row before, 0.1 s earlier, carried on by its 0.5 m/s along the error
    EXPECT_NEAR(s["outages_forward"][0]["max_3d_m"].get<double>(), std::sqrt(5.05 * 5.05 + 1.0), 1e-3);
    EXPECT_EQ(s["outages"][0]["inside_3sigma"], true);
    EXPECT_NEAR(s["timing"]["imu_epochs_per_s"].get<double>(), 1e6, 1e-3);
    EXPECT_EQ(s["warnings"][0], "one \"quoted\" warning");
}

TEST(Summary, NothingToCompareIsNull) {
    solution::ResultBundle b = hand_made(false);
    b.data.recording.reference.clear();
    b.data.config.filter.outages.clear();
    b.evaluation = solution::evaluate(b.data, b.result, {});
    const Json s = Json::parse(summary_json(b));
    EXPECT_TRUE(s["reference"].is_null());
    EXPECT_TRUE(s["errors"].is_null());
    EXPECT_TRUE(s["outages"].empty());
    EXPECT_TRUE(s["outages_forward"].is_null());
    EXPECT_TRUE(s["consistency"]["nees_position"].is_null());
}

TEST(Evaluation, WithheldFixesAreTheReferenceWhereThereIsNoOther) {
    solution::ResultBundle b = hand_made(false);
    b.data.recording.reference.clear();
    for (int i = 1; i <= 11; ++i) {
        b.result.forward.outage_epochs.push_back({0,
                                                  Time::from_seconds(100.0 + i),
                                                  i == 11,
                                                  {0.1 * i, 0.0, -0.05 * i},
                                                  Eigen::Vector3d::Constant(i == 11 ? 0.3 : 1.0)});
    }
    const solution::Evaluation e = solution::evaluate(b.data, b.result, {});
    EXPECT_EQ(e.reference, "gnss");
    ASSERT_EQ(e.outages.size(), 1u);
    EXPECT_NEAR(e.outages[0].end_horizontal, 1.1, 1e-12);
    EXPECT_NEAR(e.outages[0].end_vertical, 0.55, 1e-12);
    EXPECT_FALSE(e.outages[0].inside_3sigma);  // 1.1 m against 0.3 m at the end
}

TEST(Evaluation, OnlyTheRowsOfTheSolutionAreComparedWhereEpochsCoincide) {
    // a body that rolls 1 deg at 5 Hz: interpolation between 10 Hz rows would invent errors
    std::vector<SolutionRow> rows;
    std::vector<ReferenceSample> truth;
    for (int i = 0; i <= 20000; ++i) {
        const double t = 0.005 * i;
        ReferenceSample s;
        s.time = Time{i * std::int64_t{5'000'000}};
        s.position = {0.8, 0.2, 0.0};
        s.velocity_n.setZero();
        s.rpy = {units::deg * std::sin(2 * M_PI * 5 * t + 0.3), 0.0, 1.0};
        truth.push_back(s);
        if (i % 20 == 0) rows.push_back({s.time, s.position, s.velocity_n, s.rpy, not_given3(), not_given3(), not_given3()});
    }
    const solution::Evaluation e = solution::compare(earth::Earth{}, rows, truth, 0.0);
    EXPECT_EQ(e.summary.epochs, rows.size());
    EXPECT_LT(e.summary.roll.max, 1e-12);
    for (SolutionRow& r : rows) r.time.ns += 1'000'000'000'000;
    EXPECT_THROW((void)solution::compare(earth::Earth{}, rows, truth, 0.0), Error);
}

TEST(Thinned, OneRowAPeriodOnTheGridOfTheAxis) {
    std::vector<SolutionRow> rows;
    for (int i = 1; i <= 1000; ++i)
        rows.push_back({Time{i * std::int64_t{5'000'000} - (i % 3) * 50'000}, {}, {}, {}, {}, {}, {}});
    const std::vector<SolutionRow> out = decimated(rows, 10.0);
    ASSERT_EQ(out.size(), 51u);
    for (std::size_t i = 1; i < out.size(); ++i) EXPECT_NEAR(out[i].time.seconds(), 0.1 * static_cast<double>(i), 1.01e-4);
    EXPECT_EQ(decimated(rows, 0.0).size(), rows.size());
}

}  // namespace
}  // namespace schuler::report
