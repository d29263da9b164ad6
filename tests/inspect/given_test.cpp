// A folder about which something is given: it is taken, what is not given is found as without it, and what the data contradict is said.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"
#include "io/log_bytes.h"

#include "schuler/core/units.h"
#include "schuler/sensor/axes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace schuler::inspect::test {
namespace {

namespace fs = std::filesystem;
using units::deg;
constexpr const char* turned = "x=backward, y=right, z=up";

/// The files of the car under their names, nothing else.
Given named(const fs::path& folder) {
    Given given;
    given.imu = {folder / "imu.csv", "imu.csv", {}, {}, 0.0, {}};
    given.gnss = {folder / "gnss.csv", "gnss.csv", {}, {}, 0.0, {}};
    given.keys = {"imu.file", "gnss.file"};
    given.find_logs = false;
    return given;
}

std::string text_of(const InspectReport& report, const std::string& key) {
    const Fact* f = fact(report, key);
    return f == nullptr ? "(not found)" : to_text(f->value);
}

bool contradicted(const InspectReport& report, const std::string& key) {
    return std::ranges::any_of(report.contradictions, [&](const Contradiction& c) { return c.key == key; });
}

fs::path turned_car(const std::string& name, double velocity_latency = 0.0) {
    const fs::path folder = fresh_folder(name);
    CarLog car;
    car.C_sb = sensor::C_bs_from_axes(turned).transpose();
    car.velocity_latency = velocity_latency;
    write_car(folder, car);
    return folder;
}

TEST(Given, FilesThatAreOnlyNamedAreJudgedAsInABareFolder) {
    const fs::path folder = turned_car("given_named", 0.2);
    const InspectReport bare = inspect(folder), said = inspect(folder, named(folder));
    ASSERT_GT(bare.facts.size(), 6u);
    std::size_t compared = 0;
    for (const Fact& f : bare.facts) {
        if (f.key == "name" || f.key.ends_with(".file")) continue;
        EXPECT_EQ(text_of(said, f.key), to_text(f.value)) << f.key;
        ++compared;
    }
    EXPECT_GT(compared, 5u);
    EXPECT_EQ(text_of(said, "vehicle.kind"), "\"car\"");
    EXPECT_EQ(text_of(said, "imu.axes"), "\"x=backward, y=right, z=up\"");
    EXPECT_EQ(fact(said, "imu.file"), nullptr) << "what is given is not found";
    EXPECT_TRUE(said.contradictions.empty());
}

TEST(Given, AFoundLatencyHasItsSigmaAndTheSpanThatShowsIt) {
    const fs::path folder = turned_car("given_sigma", 0.2);
    const InspectReport r = inspect(folder, named(folder));
    const Fact* f = fact(r, "gnss.velocity_latency_s");
    ASSERT_NE(f, nullptr);
    EXPECT_EQ(f->how, Known::Found);
    EXPECT_NEAR(std::get<double>(f->value), 0.2, 0.03);
    EXPECT_GT(f->sigma, 0.0);
    EXPECT_LT(f->sigma, 0.05);
    EXPECT_NEAR(f->from, 0.0, 1.0);
    EXPECT_NEAR(f->to, 120.0, 2.0);
}

TEST(Given, WhatIsGivenIsNotFoundAndTheRestIsMeasuredFromIt) {
    const fs::path folder = turned_car("given_axes");
    Given given = named(folder);
    given.keys.insert("imu.axes");
    given.axes = turned;
    given.C_bs = sensor::C_bs_from_axes(turned);
    const InspectReport r = inspect(folder, given);
    EXPECT_EQ(fact(r, "imu.axes"), nullptr);
    EXPECT_EQ(text_of(r, "imu.mounting_deg"), "[0, 0, 0]");
    EXPECT_TRUE(r.contradictions.empty());
}

TEST(Given, AWholeMountingWithoutAxesCountsFromForwardRightDown) {
    const fs::path folder = turned_car("given_mounting");
    Given given = named(folder);
    given.keys.insert("imu.mounting_deg");
    given.mounting_rpy = Eigen::Vector3d(180.0, 0.0, 180.0) * deg;  // the same as the axes
    const InspectReport whole = inspect(folder, given);
    EXPECT_EQ(text_of(whole, "imu.axes"), "\"frd\"");
    EXPECT_TRUE(whole.contradictions.empty());
    given.mounting_rpy = Eigen::Vector3d::Zero();  // nothing beside the axes, which are to be found
    const InspectReport rest = inspect(folder, given);
    EXPECT_EQ(text_of(rest, "imu.axes"), "\"x=backward, y=right, z=up\"");
    EXPECT_TRUE(rest.contradictions.empty());
}

TEST(Given, DataThatContradictAxesSaySo) {
    const fs::path folder = turned_car("given_wrong_axes");
    Given given = named(folder);
    given.keys.insert("imu.axes");
    for (const char* axes : {"frd", "flu"}) {  // upside down; upright and backwards
        given.axes = axes;
        given.C_bs = sensor::C_bs_from_axes(axes);
        EXPECT_TRUE(contradicted(inspect(folder, given), "imu.axes")) << axes;
    }
}

TEST(Given, DataThatContradictALatencySaySoWithBothValues) {
    const fs::path folder = turned_car("given_wrong_latency", 0.2);
    Given given = named(folder);
    given.keys.insert("gnss.velocity_latency_s");
    given.velocity_latency = 0.2;
    EXPECT_TRUE(inspect(folder, given).contradictions.empty());
    given.velocity_latency = 0.4;
    const InspectReport r = inspect(folder, given);
    ASSERT_EQ(r.contradictions.size(), 1u);
    EXPECT_EQ(r.contradictions[0].key, "gnss.velocity_latency_s");
    EXPECT_NE(r.contradictions[0].text.find("0.400 s is given"), std::string::npos) << r.contradictions[0].text;
    EXPECT_NE(r.contradictions[0].text.find("the data show 0.2"), std::string::npos) << r.contradictions[0].text;
    ASSERT_TRUE(r.contradictions[0].better);  // refuted: what the data show is used
    EXPECT_NEAR(std::get<double>(*r.contradictions[0].better), 0.2, 0.03);
    given.velocity_latency = 0.28;  // doubted: the filter has the difference for its sigma
    const InspectReport doubted = inspect(folder, given);
    ASSERT_EQ(doubted.contradictions.size(), 1u);
    EXPECT_FALSE(doubted.contradictions[0].refuted);
    const auto sigma = std::ranges::find(doubted.facts, "gnss.velocity_latency_std_s", &Fact::key);
    ASSERT_NE(sigma, doubted.facts.end());
    EXPECT_NEAR(std::get<double>(sigma->value), 0.08, 0.03);
}

// A vertical velocity that comes and goes with the springs fits as well a period later.
TEST(Given, APeriodOfABobbingBodyIsNoLatency) {
    CarLog car;
    car.bob_frequency = 2.08;
    car.bob_speed = 0.15;
    car.down_latency = 1.0 / car.bob_frequency;
    const fs::path folder = fresh_folder("given_bobbing");
    write_car(folder, car);
    Given given = named(folder);
    const InspectReport bare = inspect(folder, given);
    EXPECT_EQ(fact(bare, "gnss.velocity_down_latency_s"), nullptr);
    given.keys.insert("gnss.velocity_down_latency_s");
    for (const double said : {0.0, car.down_latency}) {
        given.velocity_down_latency = said;
        EXPECT_TRUE(inspect(folder, given).contradictions.empty()) << said;
    }
    const auto measured = std::ranges::find(bare.findings, "gnss.velocity_down_latency_s", &Finding::key);
    ASSERT_NE(measured, bare.findings.end());
    EXPECT_NE(measured->why.find("further fits at 0.48"), std::string::npos) << measured->why;
}

/// The car's gyros have biases of 0.1 deg/s.
TEST(Given, AGradeWhoseBiasesCannotBeIsRefutedAndALoudLogMeasured) {
    const fs::path folder = turned_car("given_grade");
    Given given = named(folder);
    given.keys.insert("imu.grade");
    given.gyro_noise = 1.0;
    given.gyro_bias = 1e-6;
    const InspectReport r = inspect(folder, given);
    ASSERT_TRUE(contradicted(r, "imu.grade"));
    EXPECT_TRUE(r.contradictions[0].better);
    given.gyro_bias = 0.01;
    EXPECT_FALSE(contradicted(inspect(folder, given), "imu.grade"));
}

TEST(Given, ColumnsAndScalesAreReadAsSaid) {
    const fs::path folder = fresh_folder("given_columns");
    CarLog car;
    car.gyro_factor = 1.0 / deg;
    car.imu_header = "clock,p,q,r,u,v,w";
    write_car(folder, car);
    Given given = named(folder);
    // clang-format off
    given.imu.columns = {{"time_s", "clock"},     {"gyro_x_rad_s", "p"}, {"gyro_y_rad_s", "q"}, {"gyro_z_rad_s", "r"},
                         {"accel_x_m_s2", "u"}, {"accel_y_m_s2", "v"}, {"accel_z_m_s2", "w"}};
    // clang-format on
    given.imu.scale = {{"gyro_rad_s", deg}};
    given.keys.insert({"imu.columns", "imu.scale"});
    const InspectReport right = inspect(folder, given);
    EXPECT_EQ(text_of(right, "imu.axes"), "\"frd\"");
    EXPECT_EQ(text_of(right, "vehicle.kind"), "\"car\"");
    EXPECT_TRUE(right.contradictions.empty());
    given.imu.scale = {{"gyro_rad_s", 1.0}};
    EXPECT_TRUE(contradicted(inspect(folder, given), "imu.scale"));
}

TEST(Given, OtherFilesOfTheFolderAreAidsOnlyWhereTheyMay) {
    const fs::path folder = fresh_folder("given_aids");
    write_car(folder, {});
    write_file(folder / "baro.csv", "time_s,pressure_pa\n1000,100000\n1060,100010\n1120,100005\n");
    Given given = named(folder);
    EXPECT_EQ(text_of(inspect(folder, given), "baro.file"), "\"baro.csv\"");
    given.find_companions = false;
    EXPECT_EQ(text_of(inspect(folder, given), "baro.file"), "(not found)");
}

/// A bag of ROS 1 with an IMU and fixes.
class Bag {
public:
    Bag() {
        bytes = "#ROSBAG V2.0\n" + record(7, 1, text("type=sensor_msgs/Imu"), text("topic=/imu")) +
                record(7, 2, text("type=sensor_msgs/NavSatFix"), text("topic=/fix"));
    }
    void imu(double t, const Eigen::Vector3d& w, const Eigen::Vector3d& f) {
        std::string m = header(t);
        numbers(m, std::vector<double>(13, 0.0));
        numbers(m, {w.x(), w.y(), w.z()});
        numbers(m, std::vector<double>(9, 0.0));
        numbers(m, {f.x(), f.y(), f.z()});
        numbers(m, std::vector<double>(9, 0.0));
        bytes += record(2, 1, m);
    }
    void fix(double t, double lat, double lon, double height) {
        std::string m = header(t) + std::string("\0\1\0", 3);  // status and service
        numbers(m, {lat, lon, height, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 4.0});
        bytes += record(2, 2, m + '\2');
    }
    std::string bytes;

private:
    static std::string text(const std::string& value) {
        std::string out;
        io::test::put(out, static_cast<std::uint32_t>(value.size()));
        return out + value;
    }
    static std::string record(char op, int connection, const std::string& data, const std::string& more = {}) {
        std::string number;
        io::test::put(number, static_cast<std::uint32_t>(connection));
        return text(text(std::string("op=") + op) + text("conn=" + number) + more) + text(data);
    }
    static std::string header(double t) {
        const auto ms = static_cast<std::uint32_t>(std::lround(1000.0 * t));
        std::string m;
        io::test::put(m, std::uint32_t{1});
        io::test::put(m, 1'600'000'000U + ms / 1000U);
        io::test::put(m, 1'000'000U * (ms % 1000U));
        return m + text("");
    }
    static void numbers(std::string& m, const std::vector<double>& values) {
        for (const double v : values) io::test::put(m, v);
    }
};

/// 100 Hz and 1 Hz.
std::string bag_at_rest() {
    Bag bag;
    for (int k = 0; k < 3000; ++k) {
        const double noise = 1e-3 * (k * 7 % 11 - 5);
        bag.imu(0.01 * k, {noise, 0.001, -noise}, {0.01, noise, 9.81 + noise});
        if (k % 100 == 0) bag.fix(0.01 * k, 52.0, 13.0, 80.0);
    }
    return bag.bytes;
}

// Numbers in bytes are not read as text, where none has 160 digits: no fit to the track has a finite residual.
TEST(Given, GyrosBeyondAnyInstrumentAreNoMotion) {
    const fs::path folder = fresh_folder("given_wild");
    Bag bag;
    for (int k = 0; k < 12000; ++k) {
        const double t = 0.01 * k, noise = 1e-3 * (k * 7 % 11 - 5);
        bag.imu(t, {noise, 0.001, 1e300 * std::cos(0.3 * t)}, {3.0 * std::cos(0.3 * t), 0.2, 9.81 + noise});
        if (k % 20 == 0) bag.fix(t, 52.0 + 3e-4 * std::sin(0.3 * t), 13.0 + 4e-4 * std::cos(0.2 * t), 80.0);
    }
    write_file(folder / "drive.bag", bag.bytes);
    EXPECT_EQ(inspect(folder).files.size(), 2U);
}

TEST(Given, TheImuIsFoundInTheLogWhoseFixesAreNamed) {
    const fs::path folder = fresh_folder("given_stream");
    write_file(folder / "drive.bag", bag_at_rest());
    Given given;
    given.gnss = {folder / "drive.bag#gnss", "drive.bag#gnss", {}, {}, 0.0, {}};
    given.keys = {"gnss.file"};
    given.find_logs = given.find_companions = false;
    const InspectReport report = inspect(folder, given);
    EXPECT_EQ(text_of(report, "imu.file"), "\"drive.bag#imu\"");
    given.find_imu = false;
    EXPECT_EQ(text_of(inspect(folder, given), "imu.file"), "(not found)");
}

}  // namespace
}  // namespace schuler::inspect::test
