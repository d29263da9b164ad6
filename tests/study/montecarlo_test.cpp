// A campaign repeats single runs, whatever the number of threads; what varies is drawn from its distribution.
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/provenance.h"
#include "schuler/study/comparison/compare_campaign.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* short_flight =
    "name = \"short\"\nseed = 7\nduration_s = 40\nreference_rate_hz = 5\n[trajectory]\ntype = \"paper_a\"\nstart = { lat_deg = 55, "
    "lon_deg = 30, height_m = 5000 }\nlat_amplitude_rad = 0.004\nlon_rate_rad_s = 4e-5\n[imu]\nrate_hz = 20\ngrade = \"tactical\"\n"
    "[gnss]\nreceiver = \"autonomous\"\n[baro]\nrate_hz = 1\nbias_m = 3\n[[outage]]\nstart_s = 20\nduration_s = 10\n"
    "[filter]\ninitial_error = { level_deg = 0.05, heading_deg = 0.5, velocity_m_s = 0.1, position_m = 5 }\n"
    "[montecarlo]\nruns = 6\nvary = { \"trajectory.start.lat_deg\" = { uniform = [0, 60] }, \"baro.white_m\" = { normal = [1, 0.01] } "
    "}\n";

settings::ProcessRequest request_of(const std::string& text, const std::string& name) {
    const fs::path file = fs::path(testing::TempDir()) / ("schuler_montecarlo_" + name + ".toml");
    std::ofstream(file) << text;
    settings::ProcessRequest request;
    request.input = file;
    request.above = {{"run.settle_s", {5.0}, {}}};
    return request;
}

TEST(MonteCarloThreads, TheSameNumbersWhateverTheJobs) {
    const settings::ProcessRequest request = request_of(short_flight, "jobs");
    MonteCarlo one = montecarlo(request, std::nullopt, 1), three = montecarlo(request, std::nullopt, 3);
    ASSERT_EQ(one.runs.size(), 6u);
    EXPECT_EQ(one.failed(), 0u);
    EXPECT_EQ(epochs_csv(one), epochs_csv(three));
    EXPECT_EQ(runs_csv(one), runs_csv(three));
    one.wall_s = three.wall_s = 1.0;
    EXPECT_EQ(summary_json(one), summary_json(three));
    for (std::size_t k = 0; k < 6; ++k) {
        ASSERT_EQ(one.runs[k].drawn.size(), 2u);
        const double white = one.runs[k].drawn[0].value.number(), lat = one.runs[k].drawn[1].value.number();
        EXPECT_TRUE(lat >= 0.0 && lat <= 60.0);
        EXPECT_NEAR(white, 1.0, 0.05);
        EXPECT_NE(lat, one.runs[(k + 1) % 6].drawn[1].value.number());
    }
}

TEST(MonteCarlo, RunKIsTheRunWithItsSeed) {
    std::string text = short_flight;
    text.resize(text.find("vary"));
    settings::ProcessRequest request = request_of(text, "seed");
    const MonteCarlo campaign = montecarlo(request, 3, 1);
    request.seed = 9;
    const MonteCarlo third = montecarlo(request, 1, 1);
    EXPECT_EQ(campaign.runs[2].seed, 9u);
    EXPECT_EQ(campaign.runs[2].summary.horizontal.rms, third.runs[0].summary.horizontal.rms);
    EXPECT_EQ(campaign.runs[2].outages[0].growth_horizontal, third.runs[0].outages[0].growth_horizontal);

    // The pooled rms is the root of the mean square; the quantiles are those of the runs.
    const auto json = nlohmann::json::parse(summary_json(campaign));
    double square = 0.0;
    for (const MonteCarloRun& r : campaign.runs) square += r.summary.north.rms * r.summary.north.rms / 3.0;
    EXPECT_NEAR(json["errors"]["position_m"]["north"]["rms"].get<double>(), std::sqrt(square), 1e-12);
    EXPECT_EQ(json["montecarlo"]["runs"], 3);
    EXPECT_EQ(json["montecarlo"]["failed"], 0);
    const double median = json["errors"]["position_m"]["north"]["median"];
    int below = 0;
    for (const MonteCarloRun& r : campaign.runs) below += r.summary.north.rms < median - 1e-12 ? 1 : 0;
    EXPECT_EQ(below, 1);
    EXPECT_GT(json["consistency"]["nees_baro_bias"]["mean"].get<double>(), 0.0);
}

TEST(MonteCarloThreads, ComparedSchemesFlyTheSameFlightsWhateverTheJobs) {
    std::string text = short_flight;
    text.insert(text.find("[trajectory]"), "[compare]\nschemes = [\"gnss\", \"loose\"]\n[[compare.window]]\nname = \"end\"\nstart_s = 30\nend_s = 40\n");
    const settings::ProcessRequest request = request_of(text, "compared");
    CompareCampaign one = compare_campaign(request, 3, 1), three = compare_campaign(request, 3, 3);
    one.wall_s = three.wall_s = 1.0;
    EXPECT_EQ(campaign_json(one), campaign_json(three));
    EXPECT_EQ(campaign_runs_csv(one), campaign_runs_csv(three));

    // the same as a campaign of the scheme alone
    const MonteCarlo alone = montecarlo(request_of(short_flight, "alone"), 3, 1);
    const auto json = nlohmann::json::parse(campaign_json(one));
    ASSERT_EQ(json["schemes"].size(), 2u);
    const auto& loose = json["schemes"][1];
    EXPECT_EQ(loose["scheme"], "loose");
    double square = 0.0;
    for (const MonteCarloRun& r : alone.runs) square += r.summary.horizontal.rms * r.summary.horizontal.rms / 3.0;
    EXPECT_NEAR(loose["horizontal_m"].get<double>(), std::sqrt(square), 1e-9);
    const auto told = nlohmann::json::parse(summary_json(alone));
    EXPECT_NEAR(loose["nees_attitude"]["mean"].get<double>(), told["consistency"]["nees_attitude"]["mean"].get<double>(), 1e-9);
    EXPECT_TRUE(json["schemes"][0]["nees_position"].is_null());
    EXPECT_GT(loose["windows"][0]["horizontal_max_m"].get<double>(), loose["windows"][0]["horizontal_rms_m"].get<double>());
    EXPECT_EQ(json["montecarlo"]["runs"], 3);
}

constexpr const char* ranges_flight =
    "name = \"ranges\"\nseed = 3\nduration_s = 400\nreference_rate_hz = 1\n[compare]\nschemes = [\"loose-15\", \"loose\"]\n"
    "[trajectory]\ntype = \"weave\"\nstart = { lat_deg = 52, lon_deg = 104, height_m = 9000 }\nspeed_m_s = 230\n"
    "[imu]\nrate_hz = 10\ngrade = \"tactical\"\n[gnss]\nrate_hz = 0\n[baro]\nrate_hz = 1\nwhite_m = 1\nbias_m = 30\nbias_time_s = 2000\n"
    "[ranges]\nrate_hz = 1\nsystems = \"G\"\ngps_week = 2300\ngps_second = 0\nelevation_mask_deg = 7.5\n"
    "[run]\nsettle_s = 60\n"
    "[filter]\ninitial_error = { level_deg = 0.05, heading_deg = 0.1, velocity_m_s = 0.1, position_m = 10 }\n";

/// Fixes made of ranges have their slow errors, by the geometry: who does not know that takes them for noise (NEES of 300 here).
TEST(MonteCarlo, FixesOfRangesAreToldTheirSlowErrors) {
    const CompareCampaign campaign = compare_campaign(request_of(ranges_flight, "ranges"), 8, 1);
    const auto json = nlohmann::json::parse(campaign_json(campaign));
    for (const auto& scheme : json["schemes"]) {
        // 8 runs of 3 degrees of freedom, 99.9 % bounds
        EXPECT_GT(scheme["nees_position"]["mean"].get<double>(), 0.9) << scheme["scheme"];
        EXPECT_LT(scheme["nees_position"]["mean"].get<double>(), 6.4) << scheme["scheme"];
        EXPECT_LT(scheme["nees_velocity"]["mean"].get<double>(), 6.4) << scheme["scheme"];
    }
}

TEST(MonteCarlo, GivenSlowErrorsOfFixesAreKept) {
    WarningLog unheard;
    const auto bundle_of = [&](const std::string& text) {
        return solution::simulated_bundle(settings::scenario_from(settings::scenario_settings(request_of(text, "slow").input, {})), {}, unheard);
    };
    std::string text = ranges_flight;
    const solution::ResultBundle derived = bundle_of(text);
    const sensor::GnssErrorModel& found = derived.data.config.filter.gnss.errors;
    EXPECT_GT(found.correlated_position.x(), 0.5);   // of 2 m each range
    EXPECT_LT(found.correlated_position.z(), 8.0);
    EXPECT_EQ(found.correlated_time, 600.0);
    const std::vector<Fact> facts = solution::facts_of(derived);
    const auto fact = std::ranges::find(facts, "gnss.correlated_m", &Fact::key);
    ASSERT_NE(fact, facts.end());
    EXPECT_EQ(fact->how, Known::Found);
    EXPECT_THAT(fact->note, testing::HasSubstr("ranges.correlated_m"));

    text.insert(text.find("[baro]"), "correlated_m = 0.25\n");
    const solution::ResultBundle given = bundle_of(text);
    EXPECT_EQ(given.data.config.filter.gnss.errors.correlated_position, Eigen::Vector3d::Constant(0.25));
    EXPECT_TRUE(given.data.given.contains("gnss.correlated_m"));
}

// What the report draws: squares of errors and of sigmas side by side in equal spans, rows without a sigma left out.
TEST(SquaredCourse, RowsFallIntoTheirSpans) {
    analysis::ErrorRow row;
    row.position = {3.0, 4.0, -2.0};
    row.velocity = {0.0, 0.6, 0.8};
    row.rpy = {0.0, 0.0, 0.1};
    row.std_position = {1.0, 2.0, 0.5};
    row.std_velocity.setConstant(2.0);
    row.std_rpy = {9.0, 9.0, 0.2};
    const Time origin = Time::from_seconds(50.0);
    const auto at = [&](double t) {
        row.time = Time::from_seconds(50.0 + t);
        return row;
    };
    std::vector<analysis::ErrorRow> rows{at(0.0), at(299.0), at(300.0), at(600.0), at(-1.0)};
    row.std_position.z() = std::nan("");
    rows.push_back(at(0.5));
    SquaredCourse course;
    course.add(rows, origin, 600.0);
    const auto sums = [&](std::size_t quantity, std::size_t span) {
        return std::array{course.count[quantity][span], course.square[quantity][span], course.variance[quantity][span]};
    };
    EXPECT_EQ(sums(0, 0), (std::array{2.0, 50.0, 10.0}));
    EXPECT_EQ(sums(1, 0), (std::array{1.0, 4.0, 0.25}));      // one has no sigma of its height
    EXPECT_EQ(sums(0, 149), (std::array{1.0, 25.0, 5.0}));
    EXPECT_EQ(sums(0, 150), (std::array{1.0, 25.0, 5.0}));
    EXPECT_EQ(sums(2, 299), (std::array{1.0, 1.0, 12.0}));    // the last instant belongs to the last span
    EXPECT_NEAR(course.square[3][0], 0.02, 1e-15);
    EXPECT_NEAR(course.variance[3][0], 0.08, 1e-15);
    SquaredCourse both = course;
    both.add(course);
    EXPECT_EQ(both.count[0][0], 4.0);
    EXPECT_EQ(both.square[0][150], 50.0);
    EXPECT_EQ(both.variance[0][150], 10.0);
}

std::string message_of(const std::string& vary) {
    std::string text = short_flight;
    text.resize(text.find("vary"));
    try {
        (void)montecarlo(request_of(text + vary + "\n", "bad"), 1, 1);
    } catch (const Error& e) {
        return e.kind() == ErrorKind::Input ? e.what() : "no input error";
    }
    return "no error";
}

TEST(MonteCarlo, WrongVariationsAreNamedWithTheirLine) {
    EXPECT_THAT(message_of("vary = { \"gnss.white_mm\" = { uniform = [0, 1] } }"),
                testing::AllOf(testing::HasSubstr(":25:"), testing::HasSubstr("gnss.white_m")));
    EXPECT_THAT(message_of("vary = { \"baro.white_m\" = { uniform = [2, 1] } }"), testing::HasSubstr("wrong order"));
    EXPECT_THAT(message_of("vary = { \"baro.white_m\" = { gamma = [2, 1] } }"), testing::HasSubstr("unknown distribution"));
    EXPECT_THAT(message_of("vary = { \"baro.white_m\" = { normal = [-5, 0] } }"), testing::HasSubstr("baro.white_m"));
}

}  // namespace
}  // namespace schuler::study
