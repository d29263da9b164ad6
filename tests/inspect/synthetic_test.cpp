// Folders made here, with known truth: inspect must find axes, units, latencies, kinds, and say what is wrong.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/sensor/axes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <string>

namespace schuler::inspect::test {
namespace {

using units::deg;

Eigen::Matrix3d C_sb_of(const std::string& axes) { return sensor::C_bs_from_axes(axes).transpose(); }

TEST(SyntheticCar, InOrderEverythingIsFound) {
    const auto folder = fresh_folder("plain");
    write_car(folder, {});
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
    EXPECT_GE(finding(r, "imu.axes")->confidence, 0.95);
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.03);
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.0, 0.02);
    EXPECT_TRUE(sets(r, "imu.axes = \"frd\""));
    EXPECT_TRUE(sets(r, "imu.mounting_deg = [0, 0, 0]"));
    EXPECT_TRUE(sets(r, "vehicle.kind = \"car\""));
    EXPECT_TRUE(r.dataset_toml.find("\nlatency_s = \"estimate\"") != std::string::npos)
        << "a latency of nothing must not be written as one";
    const FileReport* imu = file_named(r, "imu.csv");
    ASSERT_NE(imu, nullptr);
    EXPECT_EQ(imu->kind, "imu");
    EXPECT_NEAR(imu->rate_hz, 100.0, 1e-6);
    EXPECT_EQ(imu->rows, 12000U);
    EXPECT_EQ(imu->gaps + imu->duplicates, 0U);
    EXPECT_NEAR(imu->start_s, 1000.0, 1e-9);
    double from = -1, to = -1;
    ASSERT_EQ(std::sscanf(value_of(r, "still").c_str(), "%lf to %lf s", &from, &to), 2);
    EXPECT_NEAR(from, 0.0, 1.0);
    EXPECT_NEAR(to, 20.0, 1.5);
    // The gyro bias at rest is known.
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(value_of(r, "imu.gyro_bias").c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3);
    EXPECT_NEAR(x, 0.002 / deg, 0.01);
    EXPECT_NEAR(y, -0.001 / deg, 0.01);
    EXPECT_NEAR(z, 0.0015 / deg, 0.01);
}

/// A column of the other sign makes a mirror of the axes, which turns of the gyros cannot mend.
TEST(SyntheticCar, AnAccelerometerOfTheOtherSignIsTurnedRound) {
    for (const int axis : {0, 1, 2}) {
        const auto folder = fresh_folder("mirror");
        CarLog car;
        car.duration = 240.0;
        write_car(folder, car);
        std::ifstream in(folder / car.imu_name);
        std::string text, line;
        std::getline(in, line);
        text = line + '\n';
        while (std::getline(in, line)) {
            std::size_t at = 0;
            for (int column = 0; column < 4 + axis; ++column) at = line.find(',', at) + 1;
            if (line[at] == '-') line.erase(at, 1);
            else line.insert(at, "-");
            text += line + '\n';
        }
        in.close();
        write_file(folder / car.imu_name, text);
        const InspectReport r = inspect(folder);
        EXPECT_TRUE(sets(r, std::string("imu.scale = { accel_") + "xyz"[axis] + "_m_s2 = -1 }")) << axis << r.dataset_toml;
        EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
        EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    }
}

class AxesFound : public ::testing::TestWithParam<const char*> {};

TEST_P(AxesFound, FromGravityAndTravel) {
    const auto folder = fresh_folder("axes");
    CarLog car;
    car.C_sb = C_sb_of(GetParam());
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), GetParam());
    EXPECT_GE(finding(r, "imu.axes")->confidence, 0.9);
    // The text must be what the parser of axes reads back to the same rotation.
    EXPECT_TRUE(sensor::C_bs_from_axes(value_of(r, "imu.axes")).isApprox(car.C_sb.transpose()));
}
INSTANTIATE_TEST_SUITE_P(Mountings, AxesFound,
                         ::testing::Values("flu", "fur", "x=backward, y=right, z=up", "x=right, y=up, z=backward",
                                           "x=down, y=left, z=forward"));

TEST(SyntheticCar, TiltedMountingIsMeasured) {
    const auto folder = fresh_folder("tilted");
    CarLog car;
    // Sensor to named axes to body: C_body_named = Rz(yaw) Ry(pitch), pitch -6, yaw 5 deg.
    const Eigen::Matrix3d rest =
        (Eigen::AngleAxisd(5.0 * deg, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(-6.0 * deg, Eigen::Vector3d::UnitY()))
            .toRotationMatrix();
    car.C_sb = C_sb_of("x=backward, y=right, z=up") * rest.transpose();
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "x=backward, y=right, z=up");
    EXPECT_TRUE(sets(r, "imu.mounting_deg = \"estimate\""));
    double roll = 0, pitch = 0, yaw = 0;
    ASSERT_EQ(std::sscanf(value_of(r, "imu.mounting_deg").c_str(), "roll %lf, pitch %lf, yaw %lf", &roll, &pitch, &yaw), 3);
    EXPECT_NEAR(roll, 0.0, 1.0);
    EXPECT_NEAR(pitch, -6.0, 0.5);
    EXPECT_NEAR(yaw, 5.0, 0.5);
}

// Differences of neighbouring positions are metres a second of noise: rest and speed show in the slope of many. Without velocities the fit to the
// track does not show which way the unit points; the filter does.
TEST(SyntheticCar, NoisyPositionsAloneShowRestAndTheFilterFindsForward) {
    const auto folder = fresh_folder("positions");
    CarLog car;
    car.duration = 240.0;
    car.gnss_rate = 2.0;
    car.write_velocity = false;
    car.position_noise = 1.5;
    car.gnss_header = "time_s,lat_deg,lon_deg,height_m,std_n_m,std_e_m,std_d_m";
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    double from = -1, to = -1;
    ASSERT_EQ(std::sscanf(value_of(r, "still").c_str(), "%lf to %lf s", &from, &to), 2) << value_of(r, "still");
    EXPECT_NEAR(from, 0.0, 1.0);
    EXPECT_NEAR(to, 17.0, 3.5);  // the slope begins to feel the motion 5 s before it
    EXPECT_TRUE(sets(r, "imu.mounting_deg = \"estimate\""));
}

// At rest nothing turns that could be compared: the noises of gyros and accelerometers of one unit fit each other in one unit only.
TEST(Units, OfGyrosAtRestByTheNoiseOfTheirAccelerometers) {
    std::mt19937_64 generator(5);
    std::normal_distribution<double> normal;
    constexpr double rate = 100.0, gyro = 0.2 * deg / 60.0, accel = 0.05 / 60.0;  // mems: rad/sqrt(s), m/s/sqrt(s)
    for (const double factor : {1.0, 1.0 / deg}) {
        const auto folder = fresh_folder("resting");
        std::string imu = "time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n";
        for (int i = 0; i < 6000; ++i) {
            imu += std::to_string(1000.0 + i / rate);
            for (int k = 0; k < 3; ++k)
                imu += "," + std::to_string(factor * (0.012 * (k + 1) + gyro * std::sqrt(rate) * normal(generator)));
            for (int k = 0; k < 3; ++k)
                imu += "," + std::to_string((k == 2 ? -9.8 : 0.0) + accel * std::sqrt(rate) * normal(generator));
            imu += "\n";
        }
        write_file(folder / "imu.csv", imu);
        const InspectReport r = inspect(folder);
        const double scale = factor == 1.0 ? 1.0 : deg;
        EXPECT_NE(r.dataset_toml.find(scale == 1.0 ? "gyro_rad_s = 1" : "gyro_rad_s = 0.0174"), std::string::npos)
            << r.dataset_toml;
    }
}

TEST(SyntheticCar, LatenciesOfPositionAndVelocityAreSeparate) {
    const auto folder = fresh_folder("late");
    CarLog car;
    car.position_latency = 0.15;
    car.velocity_latency = 0.27;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.15, 0.02);
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.27, 0.02);
    EXPECT_NEAR(number_of(r, "gnss.velocity_behind_position_s"), 0.12, 0.01);
    EXPECT_NE(r.dataset_toml.find("\nlatency_s = 0.1"), std::string::npos) << r.dataset_toml;
    EXPECT_NE(r.dataset_toml.find("\nvelocity_latency_s = 0.2"), std::string::npos) << r.dataset_toml;
}

TEST(SyntheticCar, EarlyImuClockGivesANegativeLatency) {
    const auto folder = fresh_folder("early");
    CarLog car;
    car.imu_start = 1000.2;  // IMU stamps 0.2 s late: the GNSS looks early
    write_car(folder, car);
    EXPECT_NEAR(number_of(inspect(folder), "gnss.latency_s"), -0.2, 0.02);
}

TEST(SyntheticCar, StatedTimesOfValidityAreComparedAndNotCountedTwice) {
    const auto folder = fresh_folder("stated");
    CarLog car;
    car.position_latency = car.velocity_latency = 0.2;
    write_car(folder, car);
    // time_valid_s in front: 0.2 s before the stamp.
    std::ifstream in(folder / "gnss.csv");
    std::string line, out;
    std::getline(in, line);
    out = "time_s,time_valid_s" + line.substr(6) + "\n";
    char valid[64];
    while (std::getline(in, line)) {
        const std::size_t comma = line.find(',');
        std::snprintf(valid, sizeof valid, ",%.6f", std::stod(line.substr(0, comma)) - 0.2);
        out += line.substr(0, comma) + valid + line.substr(comma) + "\n";
    }
    write_file(folder / "gnss.csv", out);
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(number_of(r, "gnss.stated_position_age"), 0.2, 1e-6);
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.2, 0.02);
    EXPECT_EQ(r.dataset_toml.find("\nlatency_s"), std::string::npos) << r.dataset_toml;
    EXPECT_EQ(r.dataset_toml.find("\nvelocity_latency_s"), std::string::npos) << r.dataset_toml;
}

TEST(SyntheticCar, UnitsByValueWhereNamesAreSilent) {
    const auto folder = fresh_folder("units");
    CarLog car;
    car.C_sb = C_sb_of("flu");
    car.imu_header = "timestamp,gyro_x,gyro_y,gyro_z,acc_x,acc_y,acc_z";
    car.gyro_factor = 1.0 / deg;
    car.accel_factor = 1.0 / 9.80665;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(number_of(r, "imu.scale.accel_m_s2"), 9.80665, 1e-6);
    EXPECT_NEAR(number_of(r, "imu.scale.gyro_rad_s"), deg, 1e-9);
    EXPECT_EQ(value_of(r, "imu.axes"), "flu");
    EXPECT_NE(r.dataset_toml.find("scale = { accel_m_s2 = 9.80665, gyro_rad_s = 0.01745329252 }"), std::string::npos)
        << r.dataset_toml;
}

TEST(SyntheticCar, UnitsByNameNeedNoScale) {
    const auto folder = fresh_folder("named");
    CarLog car;
    car.imu_header = "time_s,gyro_x_deg_s,gyro_y_deg_s,gyro_z_deg_s,accel_x_g,accel_y_g,accel_z_g";
    car.gyro_factor = 1.0 / deg;
    car.accel_factor = 1.0 / 9.80665;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(r.dataset_toml.find("scale ="), r.dataset_toml.find("scale = \"")) << "only [time] has a scale";
}

TEST(SyntheticCar, AWrongNameOfTheUnitIsAnErrorWithTheFactor) {
    const auto folder = fresh_folder("wrong");
    CarLog car;
    car.accel_factor = 1.0 / 9.80665;  // g under the name of m/s2
    car.gyro_factor = 1.0 / deg;       // deg/s under the name of rad/s
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_problem(r, Level::Error, "accelerometer columns state a unit that cannot be"));
    EXPECT_TRUE(has_problem(r, Level::Error, "gyro columns state a unit that cannot be"));
    EXPECT_NEAR(number_of(r, "imu.scale.gyro_rad_s"), deg, 1e-9);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
}

TEST(SyntheticCar, GyrosTurningTheWrongWayAreTurnedRound) {
    const auto folder = fresh_folder("sign");
    CarLog car;
    car.gyro_factor = -1.0;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    const Fact* found = fact(r, "imu.scale");
    ASSERT_NE(found, nullptr);
    const auto& scale = std::get<std::map<std::string, double>>(found->value);
    // the vertical one at least: a car hardly turns about the others
    EXPECT_EQ(scale.contains("gyro_rad_s") ? scale.at("gyro_rad_s") : scale.at("gyro_z_rad_s"), -1.0);
    EXPECT_EQ(r.doubts.size(), 1u);
    EXPECT_FALSE(has_problem(r, Level::Error, "gyros turn against the GNSS course"));
}

TEST(SyntheticCar, ExchangedLatitudeAndLongitudeAreExchangedBack) {
    const auto folder = fresh_folder("exchanged");
    CarLog car;
    car.gnss_header = "time_s,lon_deg,lat_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s";
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    const Fact* found = fact(r, "gnss.columns");
    ASSERT_NE(found, nullptr);
    const auto& columns = std::get<std::map<std::string, std::string>>(found->value);
    EXPECT_EQ(columns.at("lat_deg"), "lon_deg");
    EXPECT_EQ(columns.at("lon_deg"), "lat_deg");
    EXPECT_EQ(r.doubts.size(), 1u);
}

TEST(SyntheticCar, OdometerAndHeadingBesideItAreFound) {
    const auto folder = fresh_folder("plain_aids");
    write_car(folder, CarLog{});
    std::string speed = "time_s,speed_m_s\n", heading = "time_s,heading_deg,std_deg\n";
    for (int i = 0; i < 100; ++i) {
        speed += std::to_string(1000 + i) + ",1.5\n";
        heading += std::to_string(1000 + i) + ",90.0,0.5\n";
    }
    write_file(folder / "wheels.csv", speed);
    write_file(folder / "heading.csv", heading);
    const auto text = [](const InspectReport& r, const char* key) {
        const auto fact = std::ranges::find(r.facts, key, &Fact::key);
        return fact == r.facts.end() ? std::string() : std::get<std::string>(fact->value);
    };
    const InspectReport r = inspect(folder);
    EXPECT_EQ(text(r, "odometer.file"), "wheels.csv");
    EXPECT_EQ(text(r, "heading.file"), "heading.csv");
    Given given;
    given.find_companions = false;
    EXPECT_EQ(text(inspect(folder, given), "odometer.file"), "");
}

TEST(SyntheticCar, MillisecondsAndRadiansByValue) {
    const auto folder = fresh_folder("ms");
    CarLog car;
    car.time_factor = 1000.0;
    car.imu_header = "timestamp,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
    car.gnss_header = "timestamp,lat,lon,alt,vn,ve,vd";
    car.angle_factor = deg;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(file_named(r, "imu.csv")->rate_hz, 100.0, 1e-6);
    EXPECT_NEAR(file_named(r, "gnss.csv")->rate_hz, 5.0, 1e-6);
    EXPECT_NEAR(number_of(r, "gnss.scale.lat_deg"), 1.0 / deg, 1e-6);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.03);
}

TEST(SyntheticCar, HeaderlessIncrementsAsKfGinsWritesThem) {
    const auto folder = fresh_folder("kfgins");
    CarLog car;
    car.imu_name = "imu.txt";
    car.gnss_name = "gnss.txt";
    car.imu_header = car.gnss_header = "";
    car.separator = "  ";
    car.increments = true;
    car.imu_rate = 200.0;
    car.gnss_rate = 1.0;
    car.write_velocity = false;
    car.duration = 300.0;
    write_car(folder, car);
    write_file(folder / "drive.yaml", "imupath: imu.txt\ngnsspath: gnss.txt\n");
    const InspectReport r = inspect(folder);
    EXPECT_EQ(file_named(r, "imu.txt")->kind, "kfgins_imu");
    EXPECT_EQ(file_named(r, "gnss.txt")->kind, "kfgins_gnss");
    EXPECT_EQ(file_named(r, "drive.yaml")->kind, "kfgins_yaml");
    EXPECT_TRUE(sets(r, "imu.kind = \"increments\""));
    EXPECT_NE(r.dataset_toml.find("dv_x_m_s = \"#5\""), std::string::npos);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.04);
}

TEST(SyntheticCar, NoTimeInCommonIsAnErrorWithAMendWhereNothingMoves) {
    const auto folder = fresh_folder("apart");
    CarLog car;
    car.gnss_start = 900000.0;
    car.duration = 20.0;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    ASSERT_TRUE(has_problem(r, Level::Error, "have no time in common"));
    for (const Problem& p : r.problems) {
        if (p.level == Level::Error) {
            EXPECT_NE(p.hint.find("time_offset_s = 899000.000"), std::string::npos) << p.hint;
        }
    }
}

TEST(SyntheticCar, SeveralCandidatesTheFirstByNameIsTaken) {
    const auto folder = fresh_folder("two");
    CarLog car;
    car.imu_name = "imu_b.csv";
    write_car(folder, car);
    car.imu_name = "imu_a.csv";
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(sets(r, "imu.file = \"imu_a.csv\""));
    EXPECT_NE(r.dataset_toml.find("# or file = \"imu_b.csv\""), std::string::npos);
}

TEST(OddContent, NeverThrowsAndSaysWhatIsWrong) {
    const auto folder = fresh_folder("odd");
    write_file(folder / "empty.csv", "");
    write_file(folder / "header_only.csv",
               "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n");
    write_file(folder / "binary.bin", std::string("\x7f"
                                                  "ELF\0\0\0\x01\x02",
                                                  9));
    write_file(folder / "prose.txt", "Dear diary,\ntoday we drove.\n");
    write_file(folder / "nan.csv", "time_s,lat_deg,lon_deg,height_m\nnan,nan,nan,nan\nx,y,z,w\n");
    write_file(folder / "backwards.csv", "time_s,mag_x_ut,mag_y_ut,mag_z_ut\n5,1,2,3\n4,1,2,3\n3,1,2,3\n2,1,2,3\n");
    write_file(folder / "ragged.csv", "time_s,lat_deg,lon_deg,height_m\n1,2\n1,2,3,4,5,6\n;;;\n");
    write_file(folder / "half.csv", "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2\n1,2,3,4,5,6\n");
    std::filesystem::create_directory(folder / "sub.csv");
    InspectReport r;
    ASSERT_NO_THROW(r = inspect(folder));
    EXPECT_EQ(r.files.size(), 8U);
    EXPECT_TRUE(has_problem(r, Level::Error, "empty"));
    EXPECT_TRUE(has_problem(r, Level::Error, "no usable row"));
    EXPECT_TRUE(has_problem(r, Level::Error, "goes backwards 3 times"));
    EXPECT_TRUE(has_problem(r, Level::Warning, "not usable as it is"));
    EXPECT_FALSE(describe(r).empty());
    for (const FileReport& f : r.files) {
        InspectReport one;
        EXPECT_NO_THROW(one = inspect(folder / f.path)) << f.path;
    }
}

TEST(OddContent, OnlyAMissingPathThrows) {
    try {
        (void)inspect(fresh_folder("missing") / "nothing");
        FAIL() << "no error";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Input);
        EXPECT_FALSE(e.hint().empty());
    }
}

TEST(OddContent, ACutFileKeepsItsRows) {
    const auto folder = fresh_folder("cut");
    write_car(folder, {});
    std::filesystem::resize_file(folder / "imu.csv", std::filesystem::file_size(folder / "imu.csv") * 2 / 3);
    const InspectReport r = inspect(folder);
    EXPECT_GT(file_named(r, "imu.csv")->rows, 7000U);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
}

TEST(OddContent, ASingleFileIsEnough) {
    const auto folder = fresh_folder("single");
    write_car(folder, {});
    const InspectReport r = inspect(folder / "imu.csv");
    ASSERT_EQ(r.files.size(), 1U);
    EXPECT_TRUE(sets(r, "imu.file = \"imu.csv\""));
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_LT(finding(r, "imu.axes")->confidence, 0.6) << "forward cannot be known without GNSS";
}

}  // namespace
}  // namespace schuler::inspect::test
