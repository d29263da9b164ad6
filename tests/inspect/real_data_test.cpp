// What the README files of the real data sets say was measured, found by inspect from the raw columns alone.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace schuler::inspect::test {
namespace {

std::filesystem::path data_root() {
    if (const char* root = std::getenv("SCHULER_DATA"); root != nullptr && *root != '\0') return root;
    return std::filesystem::path(SCHULER_SOURCE_DIR) / ".." / "shared" / "data";
}

#define WITH_DATA(folder, name)                                \
    const std::filesystem::path folder = data_root() / (name); \
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder.string() << " (set SCHULER_DATA)"

// The report of a folder, made once.
const InspectReport& report_of(const std::filesystem::path& folder) {
    static std::map<std::string, InspectReport> reports;
    const auto it = reports.find(folder.string());
    return it != reports.end() ? it->second : reports.emplace(folder.string(), inspect(folder)).first->second;
}

// A copy of a CSV file without some columns.
void copy_without(const std::filesystem::path& from, const std::filesystem::path& to, const std::set<std::string>& dropped) {
    std::ifstream in(from);
    std::ofstream out(to);
    std::vector<bool> keep;
    for (std::string line; std::getline(in, line);) {
        std::istringstream fields(line);
        std::string field, kept;
        for (std::size_t i = 0; std::getline(fields, field, ','); ++i) {
            if (keep.size() <= i) keep.push_back(!dropped.contains(field));
            if (keep[i]) kept += (kept.empty() ? "" : ",") + field;
        }
        out << kept << "\n";
    }
}

TEST(RealData, DriveMountingIsBackRightUpAndTilted) {
    WITH_DATA(folder, "drive_0708");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "x=backward, y=right, z=up");
    EXPECT_GE(finding(r, "imu.axes")->confidence, 0.95);
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
    EXPECT_TRUE(sets(r, "imu.mounting_deg = \"estimate\""));
    double roll = 0, pitch = 0, yaw = 0;  // README: about -1, -6.2, +5.6; the author's configuration -6.79, +5.35
    ASSERT_EQ(std::sscanf(value_of(r, "imu.mounting_deg").c_str(), "roll %lf, pitch %lf, yaw %lf", &roll, &pitch, &yaw), 3);
    EXPECT_NEAR(roll, -1.0, 1.5);
    EXPECT_NEAR(pitch, -6.4, 0.8);
    EXPECT_NEAR(yaw, 5.5, 0.8);
    // Still 0-37 s and 200-209 s; +0.13 m/s2 of accelerometer error; gyro bias [-0.006, -0.064, 0.169] deg/s.
    EXPECT_NE(value_of(r, "still").find(" to 37 s, 20"), std::string::npos) << value_of(r, "still");
    EXPECT_NEAR(number_of(r, "imu.gravity"), 0.13, 0.02);
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(value_of(r, "imu.gyro_bias").c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3);
    EXPECT_NEAR(x, -0.006, 0.02);
    EXPECT_NEAR(y, -0.064, 0.02);
    EXPECT_NEAR(z, 0.169, 0.02);
    const FileReport* imu = file_named(r, "imu.csv");
    EXPECT_EQ(imu->gaps + imu->duplicates, 0U);
    EXPECT_NEAR(imu->rate_hz, 100.0, 0.5);
}

// Processor time, so that a busy machine does not matter much; the bound is three times what a quiet one takes.
TEST(RealData, DriveTakesLessThanASecond) {
#if !defined(NDEBUG) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "speed is that of release builds";
#else
    WITH_DATA(folder, "drive_0708");
    const std::clock_t begin = std::clock();
    (void)inspect(folder);
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.9);
#endif
}

TEST(RealData, DriveLatenciesAgreeWithTheStatedOnes) {
    WITH_DATA(folder, "drive_0708");
    const InspectReport& r = report_of(folder);
    EXPECT_NEAR(number_of(r, "gnss.stated_velocity_age"), 0.12, 1e-6);
    EXPECT_EQ(finding(r, "gnss.stated_position_age"), nullptr) << "vel_time_valid_s speaks of the velocity only";
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.12, 0.03);
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.05);
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.12, 0.05);
    EXPECT_GT(number_of(r, "gnss.velocity_down_latency_s"), 0.25);
    // What is written adds to the 0.12 s of the column.
    const std::size_t down = r.dataset_toml.find("\nvelocity_down_latency_s = ");
    ASSERT_NE(down, std::string::npos) << r.dataset_toml;
    EXPECT_NEAR(std::strtod(r.dataset_toml.c_str() + down + 27, nullptr), number_of(r, "gnss.velocity_down_latency_s") - 0.12,
                0.01);
    EXPECT_NE(r.dataset_toml.find("\nlatency_s = \"estimate\""), std::string::npos) << r.dataset_toml;
    EXPECT_EQ(r.dataset_toml.find("\nvelocity_latency_s"), std::string::npos) << "applied already by the column\n"
                                                                              << r.dataset_toml;
}

TEST(RealData, DriveVelocityLatencyIsFoundWithoutTheColumnThatStatesIt) {
    WITH_DATA(folder, "drive_0708");
    const auto copy = fresh_folder("drive_copy");
    std::filesystem::copy_file(folder / "imu.csv", copy / "imu.csv");
    copy_without(folder / "gnss.csv", copy / "gnss.csv", {"vel_time_valid_s"});
    const InspectReport r = inspect(copy);
    EXPECT_EQ(finding(r, "gnss.stated_velocity_age"), nullptr);
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.12, 0.03);
    EXPECT_NE(r.dataset_toml.find("\nlatency_s = \"estimate\""), std::string::npos) << r.dataset_toml;
    EXPECT_NE(r.dataset_toml.find("\nvelocity_latency_s = 0.1"), std::string::npos) << r.dataset_toml;
}

TEST(RealData, QuadcopterIsForwardRightDownAndLate) {
    WITH_DATA(folder, "quad_apm_106");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "air");
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.2, 0.07);
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.12, 0.06);  // README: 0.08 to 0.16 s
    EXPECT_TRUE(sets(r, "gnss.height = \"relative\""));
    EXPECT_TRUE(has_problem(r, Level::Warning, "not a height of GNSS"));
    EXPECT_TRUE(has_problem(r, Level::Warning, "onboard or AHRS estimate"));
    EXPECT_TRUE(sets(r, "mag.file = \"mag.csv\"")) << "norm 611 +-15 mGauss is calibrated";
    const FileReport* imu = file_named(r, "imu.csv");
    EXPECT_EQ(imu->gaps, 1U);
    EXPECT_NEAR(imu->rate_hz, 50.0, 1.0);
}

TEST(RealData, SlowQuadcopterIsNoCar) {
    WITH_DATA(folder, "quad_apm_flow");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "air");
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.2, 0.1);
    EXPECT_EQ(file_named(r, "imu.csv")->gaps, 3U);
    EXPECT_EQ(file_named(r, "flow.csv")->kind, "unknown");
}

TEST(RealData, FixedWingIsForwardRightDownLateWithADisturbedMagnetometer) {
    WITH_DATA(folder, "flight_px4_swiss");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_GE(finding(r, "imu.axes")->confidence, 0.8);
    EXPECT_EQ(value_of(r, "vehicle.kind"), "air");
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.24, 0.07);
    EXPECT_NEAR(number_of(r, "gnss.stated_velocity_age"), 0.24, 1e-3);
    EXPECT_TRUE(has_problem(r, Level::Warning, "disturbed or not calibrated"));
    EXPECT_NE(r.dataset_toml.find("# [mag]"), std::string::npos);
    EXPECT_NEAR(number_of(r, "baro.offset"), 60.0, 3.0);
    EXPECT_TRUE(has_problem(r, Level::Info, "steps of 0.11 m"));
    EXPECT_TRUE(sets(r, "gnss.height = \"msl\""));
}

TEST(RealData, SimulatedHopCountsMissingSamples) {
    WITH_DATA(folder, "px4_iris_sitl");
    const InspectReport& r = report_of(folder);
    EXPECT_TRUE(has_problem(r, Level::Warning, "1566 of 8628 samples are missing"));
    EXPECT_NEAR(number_of(r, "imu.gravity"), 0.13, 0.02);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_LT(finding(r, "imu.axes")->confidence, 0.7) << "nothing shows where forward is";
    EXPECT_TRUE(value_of(r, "still").starts_with("0 to 20 s")) << value_of(r, "still");
}

TEST(RealData, StaticSensorIsStaticAndItsMagnetometerUseless) {
    WITH_DATA(folder, "vn310_static");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(value_of(r, "vehicle.kind"), "static");
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_TRUE(has_problem(r, Level::Warning, "the Earth's 22 to 67 uT"));
    EXPECT_NEAR(number_of(r, "imu.gravity"), -0.004, 0.003);
    EXPECT_NE(value_of(r, "imu.grade"), "consumer");
    EXPECT_EQ(value_of(r, "time.scale"), "gps");
}

TEST(RealData, TwoImusAndNoRestInNavegoSynth) {
    WITH_DATA(folder, "navego_synth");
    const InspectReport& r = report_of(folder);
    EXPECT_TRUE(sets(r, "imu.file = \"imu1.csv\""));
    EXPECT_NE(r.dataset_toml.find("imu2.csv"), std::string::npos);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "still"), "none");
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.0, 0.03);
    double x = 0, y = 0, z = 0;  // README: static bias 3 deg/s
    ASSERT_EQ(std::sscanf(value_of(r, "imu.gyro_bias").c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3);
    EXPECT_NEAR(x, 3.0, 0.6);
    EXPECT_NEAR(y, 3.0, 0.6);
    EXPECT_NEAR(z, 3.0, 0.6);
}

TEST(RealData, BroadHasNoGnssAndAQuaternionReference) {
    WITH_DATA(folder, "broad_31_disturbed_stationary_magnet_D");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(file_named(r, "reference.csv")->kind, "reference");
    EXPECT_TRUE(sets(r, "reference.quaternion = \"sensor_to_enu\""));
    EXPECT_EQ(value_of(r, "imu.axes"), "flu") << "z up at rest";
    EXPECT_NEAR(file_named(r, "imu.csv")->rate_hz, 2000.0 / 7.0, 0.5);
    EXPECT_EQ(value_of(r, "vehicle.kind"), "hand");
}

TEST(RealData, RawGnssFilesAreNamed) {
    WITH_DATA(folder, "spirent_f9p_static_ubx");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(file_named(r, "f9p.obs")->kind, "rinex_obs");
    EXPECT_EQ(file_named(r, "f9p.ubx")->kind, "ubx");
}

TEST(RealData, RtklibSolutionIsDatedAndTheReferenceIsMovedByWholeWeeks) {
    WITH_DATA(folder, "spirent_rose_noatm");
    const InspectReport& r = report_of(folder);
    EXPECT_EQ(file_named(r, "rtklib_rtk_fixandhold.pos")->kind, "rtklib_pos");
    EXPECT_EQ(value_of(r, "gnss.fix"), "561 rtk_fixed, 40 rtk_float");  // README: the first 40 epochs are float
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.0, 0.03);
    EXPECT_TRUE(sets(r, "reference.time_offset_s = 1357171200"));  // week 2244
    EXPECT_EQ(finding(r, "time.scale")->confidence, 1.0);
}

TEST(RealData, NmeaLogIsRecognised) {
    WITH_DATA(file, "parser_corpus/instinct/NmeaFile/test.nmea");
    const InspectReport r = inspect(file);
    ASSERT_EQ(r.files.size(), 1U);
    EXPECT_EQ(r.files[0].kind, "nmea");
    EXPECT_TRUE(sets(r, "gnss.file = \"test.nmea\""));
}

// Every key of every draft must be one that dataset.toml knows.
TEST(RealData, DraftsUseKnownKeysOnly) {
    WITH_DATA(root, "");
    const std::set<std::string> known{"name",
                                      "time.scale",
                                      "time.week",
                                      "vehicle.kind",
                                      "imu.file",
                                      "imu.kind",
                                      "imu.stamp",
                                      "imu.axes",
                                      "imu.mounting_deg",
                                      "imu.grade",
                                      "imu.columns",
                                      "imu.scale",
                                      "imu.time_offset_s",
                                      "gnss.file",
                                      "gnss.lever_arm_m",
                                      "gnss.latency_s",
                                      "gnss.latency_std_s",
                                      "gnss.velocity_latency_std_s",
                                      "gnss.velocity_latency_s",
                                      "gnss.height_latency_s",
                                      "gnss.velocity_down_latency_s",
                                      "gnss.height",
                                      "gnss.columns",
                                      "gnss.scale",
                                      "baro.file",
                                      "baro.columns",
                                      "baro.scale",
                                      "mag.file",
                                      "mag.columns",
                                      "mag.scale",
                                      "reference.file",
                                      "reference.columns",
                                      "reference.time_offset_s",
                                      "reference.scale",
                                      "reference.quaternion"};
    int drafts = 0;
    for (const auto& entry : std::filesystem::directory_iterator(root)) {
        if (!entry.is_directory()) continue;
        const InspectReport& r = report_of(entry.path());
        drafts += r.dataset_toml.empty() ? 0 : 1;
        std::set<std::string> keys;
        for (const std::string& setting : settings_of(r.dataset_toml)) {
            const std::string key = setting.substr(0, setting.find(" = "));
            EXPECT_TRUE(known.contains(key)) << entry.path() << ": " << setting;
            EXPECT_TRUE(keys.insert(key).second) << entry.path() << ": " << key << " twice";
        }
    }
    EXPECT_GE(drafts, 10);
}

}  // namespace
}  // namespace schuler::inspect::test
