#include "schuler/settings/scenario/scenario.h"
#include "schuler/core/units.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/toml_file.h"
#include "schuler/solution/loaded_dataset.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace schuler::settings {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

ScenarioConfig parse(const std::string& text) {
    return scenario_from(scenario_table().read(parse_toml(text, "s.toml"), "s.toml"));
}

std::string message_of(const std::string& text) {
    try {
        (void)parse(text);
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

constexpr const char* small_drive =
    "name = \"small\"\nseed = 5\nduration_s = 20\n[trajectory]\ntype = \"car\"\nstart = { lat_deg = -33.2, lon_deg = 151.7, "
    "height_m = 12.5 }\nstandstill_s = 5\n"
    "[imu]\nrate_hz = 50\ngrade = \"mems\"\nmounting_deg = [1, -2, 30]\n[gnss]\nrate_hz = 2\nreceiver = "
    "\"autonomous\"\nlever_arm_m = [0.1, 0.2, -1]\nlatency_s = 0.1\n"
    "[baro]\nrate_hz = 5\nbias_m = 3\n[[outage]]\nstart_s = 10\nduration_s = 4\n[[outage]]\nstart_s = 3\nduration_s = 2\nsensor "
    "= \"baro\"\n"
    "[filter]\nsmooth = true\nassumed = { gyro_bias_deg_h = 77 }\ninitial_error = { level_deg = 0.5, heading_deg = 2, "
    "velocity_m_s = 0.1, position_m = 1 }\n";

TEST(Scenario, FilesCarryEveryBitThatTheRunUses) {
    const scenario::SimulatedDataset simulated = scenario::simulate_dataset(parse(small_drive));
    const TemporaryFolder folder("scenario");
    scenario::write_dataset(simulated, folder.path());
    const Dataset dataset = open_dataset(folder.path());
    EXPECT_EQ(dataset.name, "small");
    WarningLog warnings;
    const solution::LoadedDataset read = solution::load_dataset(dataset, config_from(dataset.settings), warnings);
    const solution::LoadedDataset held =
        solution::settled_dataset(simulated.recording, config_from(simulated.settings), warnings);
    const Recording &a = read.recording, &b = held.recording;
    ASSERT_EQ(a.imu.size(), 1000u);
    ASSERT_EQ(a.imu.size(), b.imu.size());
    for (std::size_t i = 0; i < a.imu.size(); ++i) {
        ASSERT_EQ(a.imu[i].time, b.imu[i].time);
        ASSERT_EQ(a.imu[i].gyro, b.imu[i].gyro);
        ASSERT_EQ(a.imu[i].accel, b.imu[i].accel);
    }
    ASSERT_EQ(a.gnss.size(), b.gnss.size());
    for (std::size_t i = 0; i < a.gnss.size(); ++i) {
        ASSERT_EQ(a.gnss[i].time, b.gnss[i].time);
        ASSERT_EQ(a.gnss[i].position.lat, b.gnss[i].position.lat);
        ASSERT_EQ(a.gnss[i].position.lon, b.gnss[i].position.lon);
        ASSERT_EQ(a.gnss[i].position.h, b.gnss[i].position.h);
        ASSERT_EQ(a.gnss[i].velocity_n, b.gnss[i].velocity_n);
        ASSERT_EQ(a.gnss[i].std_position, b.gnss[i].std_position);
        ASSERT_EQ(a.gnss[i].std_velocity, b.gnss[i].std_velocity);
        ASSERT_EQ(a.gnss[i].fix, b.gnss[i].fix);
    }
    ASSERT_EQ(a.baro.size(), b.baro.size());
    ASSERT_GT(a.baro.size(), 80u);
    ASSERT_LT(a.baro.size(), 95u);  // its outage is in the log, that of GNSS is left to the processing
    ASSERT_EQ(a.reference.size(), b.reference.size());
    for (std::size_t i = 0; i < a.reference.size(); ++i) {
        ASSERT_EQ(a.reference[i].position.lat, b.reference[i].position.lat);
        ASSERT_EQ(a.reference[i].rpy, b.reference[i].rpy);
        ASSERT_EQ(a.reference[i].velocity_n, b.reference[i].velocity_n);
    }
    EXPECT_EQ(to_toml(config_table().used(read.config), config_table().specs(), false),
              to_toml(config_table().used(held.config), config_table().specs(), false));
}

TEST(Scenario, FilterIsToldWhatIsSimulatedUnlessAssumedOtherwise) {
    const ScenarioConfig s = parse(small_drive);
    const Config c = config_from(scenario::simulate_dataset(s).settings);
    EXPECT_EQ(c.filter.imu.errors.accel_bias, s.sim.imu.errors.accel_bias);
    EXPECT_NEAR(c.filter.imu.errors.gyro_bias, 77 * 4.84813681109536e-6, 1e-15);  // deg/h to rad/s
    EXPECT_EQ(c.filter.gnss.lever_arm_b, Eigen::Vector3d(0.1, 0.2, -1));
    EXPECT_EQ(c.filter.gnss.latency, 0.1);
    EXPECT_EQ(c.filter.vehicle, fusion::VehicleKind::Car);
    EXPECT_TRUE(c.filter.constraints.nonholonomic);
    EXPECT_FALSE(c.filter.imu.estimate_noise);
    EXPECT_NEAR(c.filter.initial.std_rpy.z(), 2 * M_PI / 180, 1e-12);
    ASSERT_EQ(c.run.outages.size(), 1u);
    EXPECT_EQ(c.run.outages[0].start, 10.0);
}

TEST(Scenario, InitialErrorsHaveTheStatedSigma) {
    // 400 seeds of a static scenario: the squared normalised heading error has mean 1 (five sigma: 1 +- 0.35)
    double sum = 0.0;
    const int runs = 400;
    for (int seed = 1; seed <= runs; ++seed) {
        const Config c = config_from(
            scenario::simulate_dataset(
                parse(fmt::format("seed = {}\nduration_s = 0.2\n[trajectory]\ntype = \"static\"\nattitude_deg = [0, 0, 90]\n"
                                  "[filter]\ninitial_error = {{ level_deg = 1, heading_deg = 3 }}\n",
                                  seed)))
                .settings);
        const double e = (c.filter.initial.rpy.z() * 180 / M_PI - 90) / 3;
        sum += e * e;
    }
    EXPECT_NEAR(sum / runs, 1.0, 0.35);
}

TEST(Scenario, ErrorsNamePlaceAndMend) {
    const struct {
        const char* text;
        std::vector<const char*> parts;
    } cases[] = {
        {"duration = 3\n", {"s.toml:1: duration: unknown key", "did you mean duration_s?"}},
        {"[trajectory]\ntype = \"carr\"\n", {"s.toml:2", "unknown value \"carr\"", "\"car\""}},
        {"[trajectory]\ntype = \"waypoints\"\n", {"no waypoints"}},
        {"[trajectory]\ntype = \"paper_a\"\nstart = { lat_deg = 55, lon_deg = 30, height_m = 4000 }\n",
         {"s.toml:2", "below the ground", "trajectory.ground_height_m"}},
        {"[trajectory]\ntype = \"waypoints\"\nwaypoints = [ { north_m = 100 }, { north_m = 0 } ]\n",
         {"s.toml:3", "trajectory.waypoints[0]", "sharper than 160"}},
        {"[trajectory]\ntype = \"takeoff\"\nspeed_m_s = 5\n",
         {"s.toml:3", "trajectory.speed_m_s", "not the speed of an aircraft"}},
        {"[trajectory]\ntype = \"table\"\n", {"trajectory.moves", "no moves"}},
        {"[trajectory]\ntype = \"survey\"\nsurvey = { lines = 0 }\n", {"s.toml:3", "trajectory.survey.lines", "out of range"}},
        {"[trajectory]\ntype = \"survey\"\ndrape = { clearance_m = 100, file = \"none.csv\" }\n", {"none.csv"}},
        {"[anomaly_field]\nmodel = \"egm2008\"\nfolder = \"nowhere\"\n", {"nowhere/egm2008", "geographiclib-get-gravity"}},
        {"[anomaly_field]\nmodel = \"egm96\"\nfile = \"grid.csv\"\n", {"s.toml:2", "anomaly_field.model", "contradicts"}},
        {"[gauges]\nlever_arms_m = [[1, 2]]\n", {"s.toml:2", "gauges.lever_arms_m", "[[0, 0, 0]"}},
        {"[trajectory]\ntype = \"table\"\nmoves = [ { yaw_deg = 3 } ]\n", {"s.toml:3", "has no \"yaw_deg\""}},
        {"[trajectory]\ntype = \"file\"\n", {"trajectory.file", "no trajectory"}},
        {"[imu]\ngyro_bias_deg_h = -1\n", {"s.toml:2", "imu.gyro_bias_deg_h", "out of range"}},
        {"[gnss]\nrate_hz = 1\ncorrelated_m = [1, -1, 1]\n", {"s.toml:3", "gnss.correlated_m", "out of range"}},
        {"[[fault]]\nstart_s = 1\nkind = \"melt\"\n", {"fault", "melt", "step, ramp, drift"}},
        {"[compare]\nschemes = [\"deepest\"]\n", {"s.toml:2", "deepest", "separate"}},
        {"[trajectory]\ntype = \"waypoints\"\nwaypoints = [ { north = 3 } ]\n", {"s.toml:3", "has no \"north\"", "north_m"}},
        {"[trajectory]\nstart = { lat_deg = 95 }\n", {"trajectory.start.lat_deg", "out of range"}},
        {"[trajectory]\nstart = { latitude_deg = 5 }\n", {"unknown key", "trajectory.start.lat_deg"}},
        {"duration_s = -1\n", {"out of range"}},
        {"[imu]\nrate_hz = 0\n", {"imu.rate_hz", "out of range"}},
        {"[[outage]]\nstart_s = 1\nduration_s = 2\nsensor = \"imu\"\n", {"sensor", "not understood"}},
        {"[filter]\ngate = 3\n", {"unknown key"}},
    };
    for (const auto& c : cases) {
        const std::string message = message_of(c.text);
        for (const char* part : c.parts) EXPECT_NE(message.find(part), std::string::npos) << c.text << " -> " << message;
    }
}

// A trajectory that was flown, written, and flown again stays near itself; the file may lie beside the scenario.
TEST(Scenario, TheIntermediateCouplingIsComparedByBothOfItsNames) {
    for (const std::string name : {"intermediate", "medium"}) {
        EXPECT_EQ(parse("[compare]\nschemes = [\"loose\", \"" + name + "\"]\n").compared,
                  (std::vector<std::string>{"loose", name}));
        EXPECT_EQ(config_from(known_scheme(name).settings).scheme, Scheme::Intermediate) << name;
    }
}

TEST(Scenario, RecordedTrajectoryIsFlownAgain) {
    const TemporaryFolder folder("flown");
    scenario::write_dataset(scenario::simulate_dataset(parse(
                                "name = \"first\"\nduration_s = 120\n[trajectory]\ntype = \"figure8\"\nstart = { lat_deg = 50, "
                                "lon_deg = 30, height_m = 500 }\nfigure_s = 60\n[imu]\nrate_hz = 10\n")),
                            folder.path());
    const std::string again = "duration_s = 119\n[trajectory]\ntype = \"file\"\nsmoothing_s = 0.25\nfile = \"" +
                              (folder.path() / "reference.csv").string() + "\"\n[imu]\nrate_hz = 10\n";
    const scenario::SimulatedDataset flown = scenario::simulate_dataset(parse(again));
    const scenario::SimulatedDataset first =
        scenario::simulate_dataset(parse("duration_s = 120\n[trajectory]\ntype = \"figure8\"\nstart = { lat_deg = 50, lon_deg "
                                         "= 30, height_m = 500 }\nfigure_s = 60\n[imu]\nrate_hz = 10\n"));
    for (std::size_t k = 50; k < 1100; k += 100) {
        const Eigen::Vector3d apart =
            earth::ned_difference(earth::Earth{}, flown.recording.reference[k].position, first.recording.reference[k].position);
        EXPECT_LT(apart.norm(), 0.33) << k;  // a window of s cuts a bend of 10 m/s^2 by a s^2 / 2 = 0.31 m
        EXPECT_LT(std::abs(flown.recording.reference[k].rpy.x() - first.recording.reference[k].rpy.x()), 0.02);
    }
    EXPECT_NE(message_of("duration_s = 500\n" + again.substr(again.find('\n') + 1)).find("lasts 120.0 s"), std::string::npos);
}

// The barometer's log has pressures; its reader makes heights of them. The filter finds what the day's air adds.
TEST(Scenario, PressuresAndMagnetometerPassTheirReaders) {
    const scenario::SimulatedDataset simulated = scenario::simulate_dataset(parse(
        "name = \"air\"\nduration_s = 20\n[trajectory]\ntype = \"static\"\nstart = { height_m = 300 }\n[imu]\nrate_hz = 10\n[baro]\nrate_hz = "
        "1\npressure = true\nsea_level_pressure_pa = 100000\n[mag]\nrate_hz = 2\nwhite_ut = 0.1\nhard_iron_ut = 1\n"));
    const TemporaryFolder folder("air");
    scenario::write_dataset(simulated, folder.path());
    const Dataset dataset = open_dataset(folder.path());
    WarningLog warnings;
    const solution::LoadedDataset read = solution::load_dataset(dataset, config_from(dataset.settings), warnings);
    const solution::LoadedDataset held =
        solution::settled_dataset(simulated.recording, config_from(simulated.settings), warnings);
    ASSERT_EQ(read.recording.baro.size(), 21u);
    ASSERT_EQ(read.recording.mag.size(), 41u);
    for (std::size_t k = 0; k < 21; ++k) ASSERT_EQ(read.recording.baro[k].height, held.recording.baro[k].height);
    for (std::size_t k = 0; k < 41; ++k) ASSERT_EQ(read.recording.mag[k].field_b, held.recording.mag[k].field_b);
    EXPECT_NEAR(read.recording.baro[5].height, 300.0 + simulated.truth.baro_truth[5].bias, 2.0);
    EXPECT_GT(simulated.truth.baro_truth[5].bias, 100.0);
}

TEST(Scenario, InstrumentsOfASurveyPassTheirReaders) {
    const scenario::SimulatedDataset simulated = scenario::simulate_dataset(parse(
        "name = \"ship\"\nduration_s = 20\n[trajectory]\ntype = \"ship\"\nstart = { height_m = 3 }\n[imu]\nrate_hz = 10\n"
        "[gauges]\nrate_hz = 2\nlever_arms_m = [[0, 0, 1], [30, 0, 2]]\nbias_m = 0.7\n[log]\nrate_hz = 1\n"
        "scale_factor_ppm = 4000\nmisalignment_deg = 0.5\nlever_arm_m = [3, 0, 2]\n[compass]\nrate_hz = 5\nbias_deg = 2\n"));
    const TemporaryFolder folder("survey_instruments");
    scenario::write_dataset(simulated, folder.path());
    const Dataset dataset = open_dataset(folder.path());
    WarningLog warnings;
    const solution::LoadedDataset read = solution::load_dataset(dataset, config_from(dataset.settings), warnings);
    const Recording& a = read.recording;
    const InstrumentLogs& b = simulated.instruments;
    ASSERT_EQ(a.gauges.size(), 41U);
    ASSERT_EQ(a.body_velocity.size(), 21U);
    ASSERT_EQ(a.heading.size(), 101U);
    for (std::size_t i = 0; i < a.gauges.size(); ++i) {
        EXPECT_EQ(a.gauges[i].time, b.gauges[i].time);
        EXPECT_EQ(a.gauges[i].height.head<2>(), b.gauges[i].height.head<2>());
        EXPECT_TRUE(std::isnan(a.gauges[i].height(2)));
    }
    for (std::size_t i = 0; i < a.body_velocity.size(); ++i) EXPECT_EQ(a.body_velocity[i].velocity_b, b.velocities[i].velocity_b);
    for (std::size_t i = 0; i < a.heading.size(); ++i) EXPECT_EQ(a.heading[i].heading, b.headings[i].heading);
    const InstrumentsConfig& told = read.config.instruments;
    EXPECT_EQ(told.gauges.lever_arms_b.size(), 2U);
    EXPECT_NEAR(told.gauges.bias, 0.7, 1e-12);
    EXPECT_NEAR(told.log.scale, 4e-3, 1e-12);
    EXPECT_NEAR(told.compass.bias, 2.0 * units::deg, 1e-12);
    // and the filter believes what is told
    EXPECT_EQ(read.config.filter.gauges.level_std, told.gauges.bias);
    EXPECT_EQ(read.config.filter.gauges.lever_arms_b[1], told.gauges.lever_arms_b[1]);
    EXPECT_EQ(read.config.filter.log.lever_arm_b, Eigen::Vector3d(3.0, 0.0, 2.0));
    EXPECT_EQ(read.config.filter.heading.offset_std, told.compass.bias);
}

TEST(Scenario, ExamplesAreRead) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(fs::path(SCHULER_SOURCE_DIR) / "examples")) {
        if (entry.path().extension() != ".toml") continue;
        EXPECT_NO_THROW((void)read_scenario(entry.path(), std::nullopt)) << entry.path();
        ++count;
    }
    EXPECT_GE(count, 4);
    std::ifstream file(fs::path(SCHULER_SOURCE_DIR) / "examples/demo.toml");
    std::stringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), built_in_scenario("demo"));
}

}  // namespace
}  // namespace schuler::settings
