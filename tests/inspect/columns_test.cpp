// Columns whose content differs from their names, and columns and scales given without the name of a file.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"
#include "schuler/inspect/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace schuler::inspect::test {
namespace {

bool is_doubted(const InspectReport& r, const std::string& text) {
    return std::ranges::any_of(r.doubts, [&](const std::string& d) { return d.find(text) != std::string::npos; });
}

TEST(Columns, AccelerometersThatAreAllReversedAreTurnedRound) {
    const auto folder = fresh_folder("all_reversed");
    CarLog car;
    car.accel_factor = -1.0;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_TRUE(is_doubted(r, "accelerometer x, y, z turned round"));
    ASSERT_NE(fact(r, "imu.scale"), nullptr);
    const auto scale = std::get<std::map<std::string, double>>(fact(r, "imu.scale")->value);
    EXPECT_EQ(scale.at("accel_m_s2"), -1.0);
    EXPECT_FALSE(scale.contains("gyro_rad_s"));
    EXPECT_LT(number_of(r, "imu.mounting_deg"), 3.0);
}

// Over two seconds positions with a noise of metres disagree with the velocities in either order.
TEST(Columns, ExchangedLatitudeAndLongitudeOfANoisyReceiver) {
    for (const bool exchanged : {true, false}) {
        const auto folder = fresh_folder("exchanged_noisy");
        CarLog car;
        car.position_noise = 2.5;
        if (exchanged) car.gnss_header = "time_s,lon_deg,lat_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s";
        write_car(folder, car);
        const InspectReport r = inspect(folder);
        EXPECT_EQ(is_doubted(r, "latitude and longitude are exchanged"), exchanged);
        EXPECT_EQ(fact(r, "gnss.columns") != nullptr, exchanged);
    }
}

TEST(Columns, ExchangedAccelerometersAreRead) {
    const auto folder = fresh_folder("exchanged");
    CarLog car;
    car.imu_header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_y_m_s2,accel_x_m_s2,accel_z_m_s2";
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_TRUE(is_doubted(r, "accelerometer columns are exchanged"));
    ASSERT_NE(fact(r, "imu.columns"), nullptr);
    const auto columns = std::get<std::map<std::string, std::string>>(fact(r, "imu.columns")->value);
    EXPECT_EQ(columns.at("accel_x_m_s2"), "accel_y_m_s2");
    EXPECT_EQ(columns.at("accel_y_m_s2"), "accel_x_m_s2");
}

TEST(Columns, OfARightLogAreLeftAlone) {
    const auto folder = fresh_folder("right");
    write_car(folder, {});
    const InspectReport r = inspect(folder);
    EXPECT_EQ(fact(r, "imu.columns"), nullptr);
    EXPECT_EQ(fact(r, "imu.scale"), nullptr);
}

TEST(Columns, AndScalesGivenWithoutAFileAreThoseOfTheLogThatIsFound) {
    const auto folder = fresh_folder("without_file");
    CarLog car;
    car.accel_factor = -1.0;
    car.imu_header = "clock,p,q,r,u,v,w";
    write_car(folder, car);
    Given given;
    // clang-format off
    given.imu.columns = {{"time_s", "clock"},     {"gyro_x_rad_s", "p"}, {"gyro_y_rad_s", "q"}, {"gyro_z_rad_s", "r"},
                         {"accel_x_m_s2", "u"}, {"accel_y_m_s2", "v"}, {"accel_z_m_s2", "w"}};
    // clang-format on
    given.imu.scale = {{"accel_m_s2", -1.0}};
    given.keys = {"imu.columns", "imu.scale"};
    const InspectReport r = inspect(folder, given);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_FALSE(is_doubted(r, "turned round"));
    ASSERT_NE(file_named(r, "imu.csv"), nullptr);
    EXPECT_TRUE(file_named(r, "imu.csv")->chosen);
}

TEST(Columns, FixesAreFoundBesideANamedImu) {
    const auto folder = fresh_folder("imu_only");
    write_car(folder, {});
    Given given;
    given.find_logs = given.find_imu = false;
    given.imu = {folder / "imu.csv", "imu.csv", {}, {}, 0.0, {}};
    given.keys = {"imu.file"};
    const InspectReport r = inspect(folder, given);
    ASSERT_NE(fact(r, "gnss.file"), nullptr);
    EXPECT_EQ(std::get<std::string>(fact(r, "gnss.file")->value), "gnss.csv");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
    given.find_gnss = false;
    const InspectReport without = inspect(folder, given);
    EXPECT_EQ(fact(without, "gnss.file"), nullptr);
}

/// What a receiver writes before its first fix, and nothing else.
TEST(Columns, OfAReceiverThatNeverHadAFixAreTold) {
    const auto folder = fresh_folder("no_fix");
    write_car(folder, {});
    std::string gnss = "time_s,lat_deg,lon_deg,height_m\n";
    for (int k = 0; k < 100; ++k) gnss += std::to_string(1000 + k) + ",0,0,0\n";
    write_file(folder / "gnss.csv", gnss);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_problem(r, Level::Error, "none of its 100 rows has a fix"));
}

}  // namespace
}  // namespace schuler::inspect::test
