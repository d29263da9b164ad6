// A campaign repeats single runs, whatever the number of threads; what varies is drawn from its distribution.
#include "schuler/study/montecarlo/montecarlo.h"
#include "schuler/math/random.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/provenance.h"
#include "schuler/study/comparison/compare_campaign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

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

/// A campaign in a folder of its own, which is begun anew.
CampaignRequest campaign_of(const settings::ProcessRequest& common, const std::string& name, std::optional<std::size_t> runs,
                            int jobs) {
    CampaignRequest request;
    request.common = common;
    request.common.output = fs::path(testing::TempDir()) / ("schuler_campaign_" + name);
    fs::remove_all(request.common.output);
    request.runs = runs;
    request.jobs = jobs;
    return request;
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The lines of a CSV file in cells.
std::vector<std::vector<std::string>> cells_of(const fs::path& file) {
    std::vector<std::vector<std::string>> out;
    std::istringstream lines(text_of(file));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream cells(line + ",");
        for (std::string cell; std::getline(cells, cell, ',');) {
            if (out.empty() || cells.tellg() == static_cast<std::streamoff>(cell.size() + 1)) out.emplace_back();
            out.back().push_back(cell);
        }
    }
    return out;
}

/// summary.json without the speed.
nlohmann::json timeless(const fs::path& folder) {
    auto json = nlohmann::json::parse(text_of(folder / "summary.json"));
    json.erase("timing");
    json["montecarlo"].erase("runs_per_s");
    return json;
}

void expect_same_files(const fs::path& a, const fs::path& b) {
    for (const char* name : {"runs.csv", "epochs.csv", "sweep.csv"}) {
        EXPECT_EQ(fs::exists(a / name), fs::exists(b / name)) << name;
        EXPECT_EQ(text_of(a / name), text_of(b / name)) << name;
    }
    EXPECT_EQ(timeless(a), timeless(b));
}

TEST(MonteCarloThreads, TheSameFilesWhateverTheJobs) {
    const settings::ProcessRequest request = request_of(short_flight, "jobs");
    const fs::path one = run_montecarlo(campaign_of(request, "one", std::nullopt, 1)).folder;
    const fs::path three = run_montecarlo(campaign_of(request, "three", std::nullopt, 3)).folder;
    expect_same_files(one, three);
    const auto rows = cells_of(one / "runs.csv");
    ASSERT_EQ(rows.size(), 7u);
    EXPECT_EQ(rows[0][3], "baro.white_m");
    EXPECT_EQ(rows[0][4], "trajectory.start.lat_deg");
    for (std::size_t k = 1; k < 7; ++k) {
        EXPECT_EQ(rows[k][2], "0");
        EXPECT_NEAR(std::stod(rows[k][3]), 1.0, 0.05);
        const double lat = std::stod(rows[k][4]);
        EXPECT_TRUE(lat >= 0.0 && lat <= 60.0);
        EXPECT_NE(rows[k][4], rows[1 + k % 6][4]);
    }
}

TEST(MonteCarlo, RunKIsTheRunWithItsSeed) {
    std::string text = short_flight;
    text.resize(text.find("vary"));
    settings::ProcessRequest request = request_of(text, "seed");
    const fs::path all = run_montecarlo(campaign_of(request, "all", 3, 1)).folder;
    request.seed = 9;
    const fs::path third = run_montecarlo(campaign_of(request, "third", 1, 1)).folder;
    auto rows = cells_of(all / "runs.csv"), own = cells_of(third / "runs.csv");
    EXPECT_EQ(rows[3][1], "9");
    EXPECT_EQ(std::vector(rows[3].begin() + 1, rows[3].end()), std::vector(own[1].begin() + 1, own[1].end()));

    // The pooled rms is the root of the mean square; the quantiles are those of the runs.
    const auto json = timeless(all);
    const auto column = static_cast<std::size_t>(std::ranges::find(rows[0], "position_m_north_rms") - rows[0].begin());
    std::vector<double> north;
    for (std::size_t k = 1; k < 4; ++k) north.push_back(std::stod(rows[k][column]));
    const double square = north[0] * north[0] + north[1] * north[1] + north[2] * north[2];
    EXPECT_NEAR(json["errors"]["position_m"]["north"]["rms"].get<double>(), std::sqrt(square / 3.0), 1e-8);
    std::ranges::sort(north);
    EXPECT_NEAR(json["errors"]["position_m"]["north"]["median"].get<double>(), north[1], 1e-8);
    EXPECT_EQ(json["montecarlo"]["runs"], 3);
    EXPECT_EQ(json["montecarlo"]["failed"], 0);
    EXPECT_GT(json["consistency"]["nees_baro_bias"]["mean"].get<double>(), 0.0);
}

/// Runs of random numbers: what statistics are made of.
std::vector<MonteCarloRun> invented_runs(std::size_t count) {
    std::vector<MonteCarloRun> out(count);
    for (std::size_t k = 0; k < count; ++k) {
        math::Random random(k, "invented");
        MonteCarloRun& run = out[k];
        run.run = k;
        run.seed = 100 + k;
        run.point = k % 3;
        if (k % 7 == 5) {
            run.failure = fmt::format("run {} has failed", k);
            continue;
        }
        run.scheme = "loose";
        run.settled_s = 2.0;
        run.summary.epochs = 5 + k % 4;
        for (const ErrorField& f : error_fields()) {
            const double rms = std::abs(random.normal()) * 1e-3;
            run.summary.*f.of_run = {rms, 2.0 * rms, 3.0 * rms};
        }
        for (int t = 0; t < 6; ++t) {
            analysis::ErrorRow row{};
            row.time = Time::from_seconds(t);
            row.position = random.normal3();
            row.velocity = row.rpy = 1e-9 * random.normal3();
            run.errors.push_back(row);
            solution::StateErrors state{};
            state.time = row.time;
            for (std::size_t b = 0; b < solution::state_blocks; ++b) {
                state.error[b] = random.normal3() * 1e-7;
                state.nees[b] = b == 5 ? std::nan("") : std::abs(random.normal());
            }
            run.states.push_back(state);
        }
        analysis::NisStatistics nis{};
        nis.mean = random.uniform();
        nis.dof = 3.0;
        nis.accepted = 10 + k;
        nis.rejected = k % 2;
        run.measurements.push_back({"baro", nis});
        if (k % 4 == 1) run.warnings.add("topic", fmt::format("run {} is odd", k));
        analysis::OutageStatistics outage{};
        outage.end_horizontal = std::abs(random.normal());
        run.outages.push_back(outage);
    }
    return out;
}

std::string bytes_of(const CampaignStatistics& statistics) {
    Packer to;
    statistics.pack(to);
    return to.take();
}

// Sums are exact and histograms fixed: any partition, merged in any order, is the whole, to the last bit; also after bytes and back.
TEST(CampaignStatistics, MergedInAnyPartitionTheyAreThoseAtOnce) {
    const std::vector<MonteCarloRun> runs = invented_runs(600);  // more than the values that an epoch keeps
    CampaignStatistics empty;
    empty.swept = true;
    CampaignStatistics whole = empty;
    for (const MonteCarloRun& run : runs) whole.add(run);
    EXPECT_EQ(whole.runs, 600u);
    EXPECT_FALSE(whole.epochs.at(3).block[0].front().error[0].sketch.exact());
    math::Random random(5, "partition");
    for (int trial = 0; trial < 5; ++trial) {
        std::vector<CampaignStatistics> parts(1 + static_cast<std::size_t>(random.uniform() * 9.0), empty);
        std::vector<MonteCarloRun> shuffled = runs;
        for (std::size_t i = shuffled.size(); i-- > 1;)
            std::swap(shuffled[i], shuffled[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
        for (const MonteCarloRun& run : shuffled)
            parts[static_cast<std::size_t>(random.uniform() * static_cast<double>(parts.size()))].add(run);
        CampaignStatistics merged = empty;
        for (const CampaignStatistics& part : parts) {
            const std::string bytes = bytes_of(part);
            Unpacker from(bytes);
            CampaignStatistics again = empty;
            again.unpack(from);
            EXPECT_TRUE(from.at_end());
            merged.merge(again);
        }
        EXPECT_EQ(bytes_of(merged), bytes_of(whole)) << parts.size() << " parts";
    }
}

TEST(CampaignStatistics, DamagedBytesAreRefused) {
    CampaignStatistics statistics;
    for (const MonteCarloRun& run : invented_runs(20)) statistics.add(run);
    const std::string bytes = bytes_of(statistics);
    for (std::size_t size = 0; size < bytes.size(); size += 997) {
        Unpacker from(std::string_view(bytes).substr(0, size));
        CampaignStatistics again;
        EXPECT_THROW(again.unpack(from), Error) << size;
    }
}

// Every point of the grid in turn, and a list at random, of any kind of value.
TEST(MonteCarlo, SweepsAndLists) {
    std::string text = short_flight;
    text.resize(text.find("runs = 6"));
    const settings::ProcessRequest request = request_of(
        text +
            "vary = { \"imu.rate_hz\" = { sweep = [10, 20] }, \"gnss.receiver\" = { list = [\"autonomous\", \"rtk\"] }, "
            "\"imu.gyro_bias_deg_h\" = { sweep = { from = 1, to = 100, steps = 3, log = true } } }\n",
        "sweep");
    const report::Outcome out = run_montecarlo(campaign_of(request, "sweep", std::nullopt, 2));
    const auto rows = cells_of(out.folder / "runs.csv"), points = cells_of(out.folder / "sweep.csv");
    ASSERT_EQ(rows.size(), 7u);  // once each
    ASSERT_EQ(points.size(), 7u);
    std::set<std::string> receivers, grid;
    for (std::size_t k = 1; k < 7; ++k) {
        const auto cell = [&](const char* key) {
            return rows[k][static_cast<std::size_t>(std::ranges::find(rows[0], key) - rows[0].begin())];
        };
        receivers.insert(cell("gnss.receiver"));
        grid.insert(cell("imu.rate_hz") + " " + cell("imu.gyro_bias_deg_h"));
    }
    EXPECT_EQ(receivers, (std::set<std::string>{"autonomous", "rtk"}));
    EXPECT_EQ(grid, (std::set<std::string>{"10 1", "10 10", "10 100", "20 1", "20 10", "20 100"}));
    for (std::size_t k = 1; k < 7; ++k) EXPECT_EQ(points[k][2], "1");
}

// What is left in the folder of a campaign that was stopped is gone on with, and the files are those of one that was not.
TEST(MonteCarlo, AnInterruptedCampaignGoesOn) {
    const settings::ProcessRequest request = request_of(short_flight, "resume");
    const fs::path whole = run_montecarlo(campaign_of(request, "whole", 6, 1)).folder;
    CampaignRequest stopped = campaign_of(request, "stopped", 6, 1);
    stopped.common.progress = [](double share) {
        if (share > 0.4) throw computation_error("stopped");
    };
    EXPECT_THROW((void)run_montecarlo(stopped), Error);
    EXPECT_FALSE(CampaignPart::left_in(stopped.common.output).empty());
    stopped.common.progress = {};
    EXPECT_THROW((void)run_montecarlo(stopped), Error);  // not without being asked to
    stopped.resume = true;
    CampaignRequest other = stopped;
    other.common.above.push_back({"filter.loop", {std::string("open")}, {}});
    EXPECT_THROW((void)run_montecarlo(other), Error);
    CampaignRequest fewer = stopped;
    fewer.runs = 1;
    EXPECT_THROW((void)run_montecarlo(fewer), Error);
    std::size_t flown = 0;
    stopped.common.progress = [&](double) { ++flown; };
    expect_same_files(whole, run_montecarlo(stopped).folder);
    EXPECT_EQ(flown, 3u);
    EXPECT_TRUE(CampaignPart::left_in(stopped.common.output).empty());
}

// The second run is done, and failed, when the first shows that no run can have these settings.
TEST(MonteCarloThreads, SettingsThatNoRunCanHaveLeaveNothingToResume) {
    settings::ProcessRequest request = request_of(short_flight, "impossible");
    request.above.push_back({"filter.scheme", {std::string("deep")}, {}});
    for (int attempt = 0; attempt < 5; ++attempt) {
        const CampaignRequest campaign = campaign_of(request, "impossible", 2, 2);
        try {
            (void)montecarlo(campaign);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find("--resume"), std::string::npos) << e.what();
        }
        EXPECT_FALSE(fs::exists(campaign.common.output / "checkpoint-0.bin"));
    }
}

TEST(MonteCarloThreads, ComparedSchemesFlyTheSameFlightsWhateverTheJobs) {
    std::string text = short_flight;
    text.insert(text.find("[trajectory]"),
                "[compare]\nschemes = [\"gnss\", \"loose\"]\n[[compare.window]]\nname = \"end\"\nstart_s = 30\nend_s = 40\n");
    const settings::ProcessRequest request = request_of(text, "compared");
    CompareCampaign one = compare_campaign(request, 3, 1), three = compare_campaign(request, 3, 3);
    one.wall_s = three.wall_s = 1.0;
    EXPECT_EQ(campaign_json(one), campaign_json(three));
    EXPECT_EQ(campaign_runs_csv(one), campaign_runs_csv(three));

    // the same as a campaign of the scheme alone
    const fs::path folder = run_montecarlo(campaign_of(request_of(short_flight, "alone"), "alone", 3, 1)).folder;
    const auto json = nlohmann::json::parse(campaign_json(one));
    ASSERT_EQ(json["schemes"].size(), 2u);
    const auto& loose = json["schemes"][1];
    EXPECT_EQ(loose["scheme"], "loose");
    const auto told = timeless(folder);
    EXPECT_NEAR(loose["horizontal_m"].get<double>(), told["errors"]["position_m"]["horizontal"]["rms"].get<double>(), 1e-9);
    EXPECT_NEAR(loose["nees_attitude"]["mean"].get<double>(), told["consistency"]["nees_attitude"]["mean"].get<double>(), 1e-9);
    EXPECT_GT(json["schemes"][0]["nees_position"]["mean"].get<double>(), 0.0);  // of the sigmas that the receiver states
    EXPECT_TRUE(json["schemes"][0]["nees_attitude"].is_null());
    EXPECT_GT(loose["windows"][0]["horizontal_max_m"].get<double>(), loose["windows"][0]["horizontal_rms_m"].get<double>());
    EXPECT_EQ(json["montecarlo"]["runs"], 3);
    const std::string runs = campaign_runs_csv(one);
    EXPECT_NE(runs.find(",nees_velocity,nees_attitude\n"), std::string::npos) << runs.substr(0, 200);
    ASSERT_EQ(one.schemes[1].run_nees.size(), 3u);
    double mean = 0.0;
    for (const std::array<double, 3>& run : one.schemes[1].run_nees) mean += run[2];
    EXPECT_NEAR(mean, loose["nees_attitude"]["mean"].get<double>(), 1e-9);  // of three runs, one instead of three expected

    // what no scheme uses is told
    settings::ProcessRequest with = request;
    with.above = {settings::setting_from_text("filter.backward=true"), settings::setting_from_text("filter.preset=tight"),
                  settings::setting_from_text("filter.loop=open")};
    const CompareCampaign idle = compare_campaign(with, 1, 1);
    std::vector<std::string> keys;
    for (const solution::Ignored& i : idle.ignored) keys.push_back(i.key);
    EXPECT_EQ(keys, (std::vector<std::string>{"filter.backward", "filter.preset"}));
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

/// Slow errors of the range rates are states of the tight filter, and errors of the velocities of fixes made of ranges. A filter that
/// takes them for noise is sure of a wrong velocity.
TEST(MonteCarlo, SlowErrorsOfRangeRatesAreTold) {
    std::string text = ranges_flight;
    text.replace(text.find("\"loose-15\", \"loose\""), 19, "\"tight\", \"loose\"");
    text.insert(text.find("[run]"), "correlated_rate_m_s = 0.3\ncorrelated_rate_time_s = 60\n");
    const auto nees = [&](const settings::SettingList& above) {
        settings::ProcessRequest request = request_of(text, "rates");
        request.above.insert(request.above.end(), above.begin(), above.end());
        const auto json = nlohmann::json::parse(campaign_json(compare_campaign(request, 8, 1)));
        std::map<std::string, double> out;
        for (const auto& scheme : json["schemes"])
            out[scheme["scheme"].get<std::string>()] = scheme["nees_velocity"]["mean"].get<double>();
        return out;
    };
    const std::map<std::string, double> told = nees({}),
                                        untold = nees({settings::setting_from_text("ranges.correlated_rate_m_s=0")});
    ASSERT_EQ(told.size(), 2U);
    for (const auto& [scheme, value] : told) {
        EXPECT_GT(value, 0.9) << scheme;  // 8 runs of 3 degrees of freedom, 99.9 % bounds
        EXPECT_LT(value, 6.4) << scheme;
        EXPECT_GT(untold.at(scheme), 2.5 * value) << scheme;
    }
}

TEST(MonteCarlo, GivenSlowErrorsOfFixesAreKept) {
    WarningLog unheard;
    const auto bundle_of = [&](const std::string& text) {
        return solution::simulated_bundle(
            settings::scenario_from(settings::scenario_settings(request_of(text, "slow").input, {})), {}, unheard);
    };
    std::string text = ranges_flight;
    const solution::ResultBundle derived = bundle_of(text);
    const sensor::GnssErrorModel& found = derived.data.config.filter.gnss.errors;
    EXPECT_GT(found.correlated_position.x(), 0.5);  // of 2 m each range
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
    EXPECT_EQ(sums(1, 0), (std::array{1.0, 4.0, 0.25}));  // one has no sigma of its height
    EXPECT_EQ(sums(0, 149), (std::array{1.0, 25.0, 5.0}));
    EXPECT_EQ(sums(0, 150), (std::array{1.0, 25.0, 5.0}));
    EXPECT_EQ(sums(2, 299), (std::array{1.0, 1.0, 12.0}));  // the last instant belongs to the last span
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
        (void)run_montecarlo(campaign_of(request_of(text + vary + "\n", "bad"), "bad", 1, 1));
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
    EXPECT_THAT(message_of("vary = { \"baro.white_m\" = { sweep = { from = 0, to = 1, steps = 1 } } }"),
                testing::HasSubstr("steps"));
    EXPECT_THAT(message_of("vary = { \"baro.white_m\" = { sweep = [1, -2] } }"), testing::HasSubstr("baro.white_m"));
    EXPECT_THAT(message_of("vary = { \"gnss.white_m\" = { uniform = [1, 2] } }"), testing::HasSubstr("only list and sweep"));
    EXPECT_THAT(message_of("vary = { \"seed\" = { list = [1, 2] } }"), testing::HasSubstr("seed of its own"));
}

}  // namespace
}  // namespace schuler::study
