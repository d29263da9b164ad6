// Which solution a campaign evaluates: at the antenna, smoothed, with the warnings of its runs.
#include "schuler/math/rotation.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_campaign.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* car =
    "name = \"car\"\nseed = 3\nduration_s = 120\nreference_rate_hz = 5\n[trajectory]\ntype = \"car\"\nstart = { lat_deg = 48.137, "
    "lon_deg = 11.575, height_m = 520 }\nstandstill_s = 20\n[imu]\nrate_hz = 50\ngrade = \"mems\"\n[gnss]\nrate_hz = 1\n"
    "lever_arm_m = [6, 2, -8]\n[run]\nsettle_s = 20\n"
    "[filter]\ninitial_error = { level_deg = 1, heading_deg = 10, velocity_m_s = 0.1, position_m = 10 }\n";

settings::ProcessRequest car_request(const std::string& text, const std::string& name) {
    const fs::path file = fs::path(testing::TempDir()) / ("schuler_car_" + name + ".toml");
    std::ofstream(file) << text;
    settings::ProcessRequest request;
    request.input = file;
    return request;
}

/// The receiver's own solution is the motion of its antenna and is compared with that: ten metres of lever arm are not its error.
TEST(CampaignSolution, TheReceiverAloneIsComparedAtItsAntenna) {
    std::string text = car;
    text.insert(text.find("[run]"), "white_m = [0.01, 0.01, 0.01]\nwhite_velocity_m_s = [0.01, 0.01, 0.01]\n");
    const settings::ScenarioConfig scenario =
        settings::scenario_from(settings::scenario_settings(car_request(text, "antenna").input, {}));
    WarningLog unheard, warnings;
    const auto run = [&](bool attitude) {
        solution::ResultBundle bundle =
            solution::simulated_bundle(scenario, {settings::setting_from_text("filter.scheme=gnss")}, unheard);
        if (!attitude)
            for (ReferenceSample& s : bundle.data.recording.reference) s.rpy = not_given3();
        solution::fuse_and_evaluate(bundle, warnings, scenario.sim.reference_rate, {});
        EXPECT_TRUE(bundle.at_antenna());
        const std::vector<ReferenceSample>& shown = bundle.reference();
        EXPECT_EQ(shown.size(), bundle.data.recording.reference.size());
        const Eigen::Vector3d moved = earth::ned_difference(bundle.data.config.filter.earth, shown.front().position,
                                                            bundle.data.recording.reference.front().position);
        EXPECT_NEAR(moved.norm(), attitude ? Eigen::Vector3d(6.0, 2.0, -8.0).norm() : 0.0, 1e-3);
        return bundle.evaluation;
    };
    const solution::Evaluation own = run(true);
    EXPECT_LT(own.summary.three_d.max, 0.1);  // six sigma of three components
    EXPECT_LT(own.summary.v_east.rms, 0.03);  // the rate of turn is that of attitudes 0.2 s apart
    EXPECT_LT(own.summary.v_north.rms, 0.03);
    EXPECT_TRUE(warnings.empty());
    // without attitude the reference stays that of the IMU, and that is told
    const solution::Evaluation other = run(false);
    EXPECT_NEAR(other.summary.three_d.rms, Eigen::Vector3d(6.0, 2.0, -8.0).norm(), 0.05);
    EXPECT_EQ(warnings.topics(), std::vector<std::string>{"reference.point"});
}

/// Schemes without a smoother are compared without it, and that is told once; what a comparison does not show is told by key.
TEST(CampaignSolution, ComparedSchemesWithoutASmootherGoOnWithoutIt) {
    std::string text = car;
    text.insert(text.find("[trajectory]"), "[compare]\nschemes = [\"gnss\", \"separate\", \"loose\", \"loose-aggressive\"]\n");
    settings::ProcessRequest request = car_request(text, "unsmoothed");
    const CompareCampaign plain = compare_campaign(request, 2, 1);
    request.above.push_back(settings::setting_from_text("filter.smooth=true"));
    request.above.push_back(settings::setting_from_text("filter.backward=true"));
    const CompareCampaign smoothed = compare_campaign(request, 2, 1);
    for (const SchemeCampaign& s : smoothed.schemes) EXPECT_TRUE(s.failures.empty()) << s.failures.front();
    for (const std::size_t same : {0u, 1u, 3u})
        EXPECT_EQ(smoothed.schemes[same].run_nees[0][0], plain.schemes[same].run_nees[0][0]) << same;
    EXPECT_LT(smoothed.schemes[2].numbers[0][4], plain.schemes[2].numbers[0][4]);  // heading: found late, smoothed to the start
    EXPECT_THAT(smoothed.warnings(),
                testing::Contains("filter.smooth: there is no smoother for gnss, separate, loose-aggressive, "
                                  "which are compared without it"));
    ASSERT_EQ(smoothed.ignored.size(), 1u);
    EXPECT_EQ(smoothed.ignored.front().key, "filter.backward");
    EXPECT_EQ(smoothed.ignored.front().reason, "a campaign keeps no solution of its runs");

    request.output = fs::path(testing::TempDir()) / "schuler_unsmoothed";
    fs::remove_all(request.output);
    const report::Outcome one = compare_schemes(request);
    EXPECT_THAT(one.warnings, testing::Contains(testing::HasSubstr("no smoother for gnss, separate, loose-aggressive")));
    EXPECT_THAT(one.warnings, testing::Contains(testing::StartsWith("filter.backward is given and has no effect")));
}

/// States and NEES of a smoothed run are those of the solution whose errors are given, not of the filter before it.
TEST(CampaignSolution, StatesOfASmoothedRunAreSmoothed) {
    const settings::ScenarioConfig scenario =
        settings::scenario_from(settings::scenario_settings(car_request(car, "smoothed").input, {}));
    WarningLog unheard;
    solution::ResultBundle bundle =
        solution::simulated_bundle(scenario, {settings::setting_from_text("filter.smooth=true")}, unheard);
    solution::fuse_and_evaluate(bundle, unheard, scenario.sim.reference_rate, {});
    std::vector<fusion::StateRow> rows;  // the same by the solution's rows
    for (const SolutionRow& row : bundle.result.smoothed.rows) {
        fusion::StateRow& state = rows.emplace_back();
        state.time = row.time;
        state.nav.position = row.position;
        state.nav.v_eb_n = row.v_eb_n;
        state.nav.q_nb = math::quaternion_from_rpy(row.rpy);
        state.P_position = row.std_position.cwiseAbs2().asDiagonal();
        state.P_velocity = row.std_velocity.cwiseAbs2().asDiagonal();
        state.P_attitude.setIdentity();
    }
    const std::vector<solution::StateErrors> own =
        solution::state_errors(rows, bundle.data.config.filter.earth, bundle.data.recording.reference, bundle.truth);
    const std::vector<solution::StateErrors>& told = bundle.evaluation.states;
    ASSERT_GT(told.size(), 110u);
    for (const solution::StateErrors& e : told) {
        const auto same = std::ranges::find(own, e.time, &solution::StateErrors::time);
        ASSERT_NE(same, own.end());
        for (std::size_t b = 0; b < 2; ++b) {
            EXPECT_LT((e.error[b] - same->error[b]).norm(), 1e-6);
            EXPECT_NEAR(e.nees[b], same->nees[b], 1e-6 * (1.0 + e.nees[b]));
        }
        EXPECT_LT((e.error[2] - same->error[2]).norm(), 1e-6 + 0.05 * e.error[2].norm());  // of the second order
        EXPECT_GT(e.nees[3], 0.0);
    }
    ASSERT_TRUE(bundle.evaluation.gyro_bias_error);
    EXPECT_LT((told.back().error[3] - *bundle.evaluation.gyro_bias_error).norm(), 1e-12);
}

/// What a single run warns of, a campaign tells once, with the number of runs; a comparison also of which scheme.
TEST(CampaignSolution, WarningsOfTheRunsAreTold) {
    settings::ProcessRequest request = car_request(car, "warned");
    request.above.push_back(settings::setting_from_text("filter.loop=open"));
    CampaignRequest campaign;
    campaign.common = request;
    campaign.common.output = fs::path(testing::TempDir()) / "schuler_campaign_warned";
    fs::remove_all(campaign.common.output);
    campaign.runs = 2;
    campaign.jobs = 1;
    const report::Outcome alone = run_montecarlo(campaign);
    const auto told =
        testing::Contains(testing::AllOf(testing::StartsWith("the loop is open"), testing::HasSubstr("2 of 2 runs")));
    EXPECT_THAT(alone.warnings, told);
    EXPECT_THAT(nlohmann::json::parse(alone.json)["warnings"].get<std::vector<std::string>>(), told);

    std::string text = car;
    text.insert(text.find("[trajectory]"), "[compare]\nschemes = [\"gnss\", \"loose\"]\n");
    request = car_request(text, "warned_schemes");
    request.above.push_back(settings::setting_from_text("filter.loop=open"));
    const CompareCampaign both = compare_campaign(request, 2, 1);
    EXPECT_THAT(both.warnings(), testing::ElementsAre(testing::StartsWith("loose: the loop is open")));
    EXPECT_EQ(nlohmann::json::parse(campaign_json(both))["warnings"].size(), 1u);
}

TEST(RunWarnings, TheTextIsThatOfTheFirstRunWhateverTheOrder) {
    WarningLog fifth, second;
    fifth.add("a", "five");
    second.add("a", "two", 3);
    second.add("b", "other");
    RunWarnings one, other;
    one.add(5, 105, fifth);
    other.add(2, 102, second);
    RunWarnings forwards = one, backwards = other;
    forwards.merge(other);
    backwards.merge(one);
    const std::vector<std::string> lines{"two (3 times) (seed 102; 2 of 4 runs)", "other (seed 102; 1 of 4 runs)"};
    EXPECT_EQ(forwards.lines(4), lines);
    EXPECT_EQ(backwards.lines(4), lines);
}

}  // namespace
}  // namespace schuler::study
