// Two hundred small tables: each is what it is and nothing else, and what is no log is unknown.
#include "schuler/inspect/inspect.h"

#include "io/io_fixture.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace schuler::inspect {
namespace {

class Recognition : public io::test::IoTest {
protected:
    /// The kind that a table is taken for, and its rate.
    FileReport of(const std::string& name, const std::string& content) {
        const auto report = inspect(write(name, content));
        ++tables_;
        EXPECT_EQ(report.files.size(), 1U) << name;
        return report.files.empty() ? FileReport{} : report.files.front();
    }
    void expect_kind(const std::string& kind, const std::string& name, const std::string& content) {
        const FileReport report = of(name, content);
        EXPECT_EQ(report.kind, kind) << name << ":\n"
                                     << content.substr(0, 300) << (report.problems.empty() ? "" : report.problems.front().text);
    }
    int tables_ = 0;
};

/// A table: header, and rows made of a time and values.
std::string table(const std::string& header, const std::string& delimiter, double step, double start, int rows,
                  const std::vector<double>& values, const char* time_format = "{:.6f}") {
    std::string out = header.empty() ? "" : header + "\n";
    for (int i = 0; i < rows; ++i) {
        out += fmt::format(fmt::runtime(time_format), start + step * i);
        for (std::size_t k = 0; k < values.size(); ++k)
            out += fmt::format("{}{:.9g}", delimiter, values[k] + 1e-3 * std::sin(0.7 * i + static_cast<double>(k)));
        out += "\n";
    }
    return out;
}

std::string joined(const std::vector<std::string>& names, const std::string& delimiter) {
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? "" : delimiter) + name;
    return out;
}

std::vector<std::string> with_time(const std::string& time, std::vector<std::string> names) {
    names.insert(names.begin(), time);
    return names;
}

TEST_F(Recognition, ImusByTheirNames) {
    const std::vector<std::vector<std::string>> styles = {
        {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"},
        {"w_RS_S_x [rad s^-1]", "w_RS_S_y [rad s^-1]", "w_RS_S_z [rad s^-1]", "a_RS_S_x [m s^-2]", "a_RS_S_y [m s^-2]",
         "a_RS_S_z [m s^-2]"},
        {"gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]", "accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"},
        {"IMU.GyrX", "IMU.GyrY", "IMU.GyrZ", "IMU.AccX", "IMU.AccY", "IMU.AccZ"},
        {"GyroX", "GyroY", "GyroZ", "AccelX", "AccelY", "AccelZ"},
        {"angular_velocity.x", "angular_velocity.y", "angular_velocity.z", "linear_acceleration.x", "linear_acceleration.y",
         "linear_acceleration.z"},
        {"IMU::UncompGyro::X [rad/s]", "IMU::UncompGyro::Y [rad/s]", "IMU::UncompGyro::Z [rad/s]", "IMU::UncompAccel::X [m/s^2]",
         "IMU::UncompAccel::Y [m/s^2]", "IMU::UncompAccel::Z [m/s^2]"},
        {"wx", "wy", "wz", "ax", "ay", "az"},
        {"gyr_x", "gyr_y", "gyr_z", "acc_x", "acc_y", "acc_z"},
        {"omega_x (rad/s)", "omega_y (rad/s)", "omega_z (rad/s)", "f_x (m/s2)", "f_y (m/s2)", "f_z (m/s2)"},
    };
    for (const auto& style : styles)
        for (const char* time : {"time_s", "timestamp", "Time (s)", "t"})
            for (const char* delimiter : {",", ";"})
                expect_kind("imu", "imu.csv",
                            table(joined(with_time(time, style), delimiter), delimiter, 0.01, 0.0, 60,
                                  {0.01, -0.02, 0.03, 0.1, 0.2, -9.8}));
    EXPECT_EQ(tables_, 80);
}

// clang-format off
TEST_F(Recognition, FixesByTheirNames) {
    const std::vector<std::vector<std::string>> styles = {{"lat_deg", "lon_deg", "height_m"}, {"latitude", "longitude", "altitude"}, {"Lat", "Lng", "Alt"},
                                                          {"gps.lat", "gps.lon", "gps.alt"},  {"Latitude(deg)", "Longitude(deg)", "Height(m)"}, {"GPS.Lat", "GPS.Lng", "GPS.Alt"}};
    // clang-format on
    for (const auto& style : styles)
        for (const char* time : {"time_s", "timestamp", "gps_time"})
            for (const char* delimiter : {",", "\t"})
                expect_kind("gnss", "gps.csv",
                            table(joined(with_time(time, style), delimiter), delimiter, 1.0, 1000.0, 30, {48.1, 11.5, 512.0}));
    EXPECT_EQ(tables_, 36);
}

TEST_F(Recognition, OtherInstruments) {
    for (const auto& names : {std::vector<std::string>{"mag_x_ut", "mag_y_ut", "mag_z_ut"},
                              {"MagX", "MagY", "MagZ"},
                              {"magnetometer_ga[0]", "magnetometer_ga[1]", "magnetometer_ga[2]"},
                              {"magnetic_field.x", "magnetic_field.y", "magnetic_field.z"}})
        for (const char* time : {"time_s", "timestamp"})
            expect_kind("mag", "m.csv", table(joined(with_time(time, names), ","), ",", 0.02, 0.0, 40, {20.0, 5.0, 40.0}));
    for (const char* name : {"pressure_pa", "baro_alt_meter", "pressure_hpa", "fluid_pressure"})
        expect_kind("baro", "b.csv",
                    table(std::string("time_s,") + name, ",", 0.1, 0.0, 40,
                          {std::string(name).find("alt") != std::string::npos ? 500.0 : 950.0}));
    for (const auto& names : {std::vector<std::string>{"roll_deg", "pitch_deg", "heading_deg"},
                              {"Roll", "Pitch", "Yaw"},
                              {"roll (deg)", "pitch (deg)", "yaw (deg)"}})
        expect_kind("reference", "a.csv", table(joined(with_time("time_s", names), ","), ",", 0.02, 0.0, 40, {1.0, 2.0, 90.0}));
}

TEST_F(Recognition, RotationsAndTrajectoriesAreNeverImus) {
    const auto row = [](int i, const std::string& delimiter, const std::array<double, 4>& q, bool positions) {
        std::string out = fmt::format("{:.3f}", 100.0 + 0.005 * i);
        if (positions) out += fmt::format("{0}{1:.4f}{0}{2:.4f}{0}{3:.4f}", delimiter, 0.01 * i, 1.0, 9.8);
        for (const double v : q) out += fmt::format("{}{:.9f}", delimiter, v);
        return out + "\n";
    };
    // the norm of three components is gravity times a step of 5 ms: 0.049
    const double a = 0.049 / std::sqrt(3.0), rest = std::sqrt(1.0 - 0.049 * 0.049);
    for (const auto& q :
         {std::array{a, a, a, rest}, std::array{0.0, 0.0, 0.0, 1.0}, std::array{rest, a, a, a}, std::array{0.5, 0.5, 0.5, 0.5}}) {
        for (const char* delimiter : {" ", ","}) {
            std::string tum;
            for (int i = 0; i < 60; ++i) tum += row(i, delimiter, q, true);
            expect_kind("trajectory", "pose.txt", "# time x y z qx qy qz qw\n" + tum);
            expect_kind("trajectory", "pose.txt", tum);
            std::string seven;
            for (int i = 0; i < 60; ++i)
                seven += row(i, delimiter, q, true).substr(0, row(i, delimiter, q, true).rfind(delimiter)) + "\n";
            const std::string kind = of("short.txt", seven).kind;
            EXPECT_TRUE(kind == "unknown" || kind == "trajectory") << kind;
        }
    }
    for (const auto& names : {std::vector<std::string>{"tx", "ty", "tz", "qx", "qy", "qz", "qw"},
                              {"x", "y", "z", "qx", "qy", "qz", "qw"},
                              {"pose.position.x", "pose.position.y", "pose.position.z", "orientation_x", "orientation_y",
                               "orientation_z", "orientation_w"}}) {
        std::string rows;
        for (int i = 0; i < 60; ++i) rows += row(i, ",", {0.0, 0.0, 0.6, 0.8}, true);
        expect_kind("trajectory", "odometry.csv", joined(with_time("timestamp", names), ",") + "\n" + rows);
    }
    // without a header, at the height of gravity: angles, and velocities, before the position
    std::string hover, flight;
    for (int i = 0; i < 60; ++i) {
        const double t = 0.01 * i;
        hover +=
            fmt::format("{:.3f} {:.6f} {:.6f} {:.6f} {:.4f} {:.4f} {:.4f}\n", 100.0 + t, 0.02 * std::sin(t),
                        -0.01 * std::cos(2.0 * t), 1.2 + 0.1 * t, 0.3 * std::sin(t), 0.2 * std::cos(t), 9.8 + 0.05 * std::sin(t));
        flight += fmt::format("{:.3f} {:.5f} {:.5f} {:.5f} {:.4f} {:.4f} {:.4f}\n", 100.0 + t, 0.5 * std::cos(t), 0.2,
                              0.1 * std::sin(t), 0.5 * std::sin(t), 0.2 * t, -9.8 - 0.1 * std::cos(t));
    }
    expect_kind("unknown", "hover.txt", hover);
    expect_kind("unknown", "flight.txt", flight);
    std::string rows;
    for (int i = 0; i < 60; ++i) rows += row(i, ",", {0.3, 0.4, 0.5, 0.6}, false);
    expect_kind("unknown", "q.csv", "time_s,qw,qx,qy,qz\n" + rows);  // not of unit length: no rotation
}

TEST_F(Recognition, SetpointsAreNeverMeasurements) {
    const std::string rows = table("", ",", 4000.0, 5e6, 50, {0.1, 0.2, 0.3, 0.4}, "{:.0f}");
    for (const char* name :
         {"flight_vehicle_rates_setpoint_0.csv", "vehicle_attitude_setpoint.csv", "trajectory_setpoint_0.csv",
          "attitude_target.csv", "cmd_attitude.csv", "desired_attitude.csv", "log_vehicle_rates_setpoint_1.csv", "command.csv"})
        expect_kind("unknown", name, "timestamp,roll,pitch,yaw,thrust\n" + rows);
    for (const char* names :
         {"timestamp,roll_sp,pitch_sp,yaw_sp,thrust", "timestamp,desired_roll,desired_pitch,desired_yaw,thrust",
          "timestamp,roll_setpoint,pitch_setpoint,yaw_setpoint,thrust"})
        expect_kind("unknown", "control.csv", std::string(names) + "\n" + rows);
}

TEST_F(Recognition, SetpointsByTheColumnsOfActuators) {
    const std::string rows = table("", ",", 0.02, 5.0, 200, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
    for (const char* names : {"timestamp,roll,pitch,yaw,thrust_body[0],thrust_body[1],thrust_body[2]",
                              "time,roll,pitch,throttle,yaw,aux1,aux2", "time,throttle_pct,roll,pitch,yaw,aux1,aux2"})
        expect_kind("unknown", "rates.csv", std::string(names) + "\n" + rows);
    // of a vehicle that logs where it is, the attitude is its own
    const std::string flown = table("", ",", 0.1, 5.0, 200, {1.0, 2.0, 90.0, 0.5, 48.1, 11.5});
    expect_kind("reference", "flight.csv", "time_s,roll_deg,pitch_deg,yaw_deg,throttle,lat,lon\n" + flown);
}

TEST_F(Recognition, PosesOfCamerasAreNoReference) {
    std::string named, bare, moving, jumping;
    for (int i = 0; i < 300; ++i) {
        const double a = i / 300.0, east = 0.2 * i;
        const std::string pose = fmt::format("{} {:.6f} {:.6f} 0 0 {:.2f} 0 1.5 1", i, std::cos(a), std::sin(a), 0.1 * i);
        named += pose + fmt::format(" img{}.jpg\n", i);
        bare += pose + " 7\n";
        moving += fmt::format("{:.2f} 48.0 {:.10f} 500 0 4 0 0 0 90\n", 100.0 + 0.05 * i, 11.0 + east / 74'600.0);
        jumping += fmt::format("{:.2f} 48.0 {:.6f} 500 0 4 0 0 0 90\n", 100.0 + 0.05 * i, 11.0 + 0.001 * i);
    }
    expect_kind("unknown", "col.txt", named);
    expect_kind("unknown", "col.txt", bare);
    // positions and velocities belong together
    expect_kind("kfgins_reference", "truth.txt", moving);
    expect_kind("unknown", "truth.txt", jumping);
}

TEST_F(Recognition, TheGainsOfAControllerAreNoPressure) {
    std::string pid, tall;
    for (int i = 0; i < 200; ++i) {
        pid += fmt::format("{:.2f},0.5,0.4,0.1,{:.4f},0.02,0.001,0,1\n", 10.0 + 0.1 * i, 0.14 + 0.01 * std::sin(0.3 * i));
        tall += fmt::format("{:.2f},0.5,0.4,0.1,{:.2f},0.02,0.001,0,1\n", 10.0 + 0.1 * i, 980.0 + std::sin(0.3 * i));
    }
    for (const std::string& rows : {pid, tall}) expect_kind("unknown", "pid.csv", "timestamp,Tar,Act,Err,P,I,D,FF,Dmod\n" + rows);
    expect_kind("unknown", "rate.csv", "timestamp,RDes,R,ROut,P,POut,YDes,Y,YOut\n" + pid);
    expect_kind("unknown", "b.csv", table("time_s,pressure", ",", 0.1, 0.0, 40, {0.14}));
    expect_kind("unknown", "b.csv", table("time_s,baro_alt", ",", 0.1, 0.0, 40, {3e6}));
    for (const double air : {1.01325e5, 1013.25, 101.325})
        expect_kind("baro", "b.csv", table("time_s,pressure", ",", 0.1, 0.0, 40, {air}));
    expect_kind("baro", "b.csv", table("time_s,T,P", ",", 0.1, 0.0, 40, {20.0, 1013.25}));
}

TEST_F(Recognition, ForcesAndTorquesAreNoField) {
    const std::string rows = table("", ",", 0.01, 0.0, 100, {1.0, 2.0, 30.0, 20.0, 5.0, 40.0});
    for (const char* names : {"time,fx,fy,fz,mx,my,mz", "time,mx,my,mz,fx,fy,fz",
                              "time,Fx (N),Fy (N),Fz (N),Mx (Nm),My (Nm),Mz (Nm)", "time,force_x,force_y,force_z,mx,my,mz"})
        expect_kind("unknown", "ft.csv", std::string(names) + "\n" + rows);
    expect_kind("mag", "m.csv", "time,mx,my,mz,a,b,c\n" + rows);
}

TEST_F(Recognition, ScatteredPlacesAreNoTrack) {
    std::string quakes, rest, track;
    unsigned state = 1;
    const auto random = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
    for (int i = 0; i < 200; ++i) {
        const int minute = 3 * i + static_cast<int>(2.0 * random());
        quakes += fmt::format("2024-05-01T{:02d}:{:02d}:12.125Z,{:.4f},{:.4f},{:.1f},{:.1f},ml\n", minute / 60, minute % 60,
                              120.0 * random() - 60.0, 340.0 * random() - 170.0, 100.0 * random(), 5.0 * random());
        rest += fmt::format("{},{:.7f},{:.7f},{:.2f}\n", i, 48.0 + 5e-4 * random(), 11.0 + 5e-4 * random(), 500.0 + random());
        track += fmt::format("{},{:.7f},{:.7f},7e5\n", 60 * i, 60.0 * std::sin(0.067 * i), 0.1 * i);
    }
    expect_kind("unknown", "quakes.csv", "time,latitude,longitude,depth,mag,magType\n" + quakes);
    expect_kind("gnss", "rest.csv", "time_s,lat,lon,height\n" + rest);
    expect_kind("gnss", "orbit.csv", "time_s,lat,lon,height\n" + track);
    expect_kind("unknown", "sp.csv", table("time,lat,lon,yaw", ",", 1.0, 0.0, 40, {48.0, 11.0, 90.0}));
    expect_kind("gnss", "dual.csv", table("time,lat,lon,yaw,fix_type", ",", 1.0, 0.0, 40, {48.0, 11.0, 90.0, 3.0}));
}

TEST_F(Recognition, TimesByTheirUsualNames) {
    for (const char* time : {"DateTime", "datetime", "Date/Time", "Timestamp (UTC)", "timestamp_utc", "datetime_utc", "UTC",
                             "Date", "time_iso", "ISO time", "local_time", "recorded_at", "created_at"}) {
        std::string rows = std::string(time) + ",lat,lon,height\n";
        for (int i = 0; i < 40; ++i)
            rows += fmt::format("2024-05-01T{:02d}:{:02d}:00.5Z,48.{:05d},11.5,500\n", 10 + i / 60, i % 60, 1000 + i);
        const FileReport report = of("gps.csv", rows);
        EXPECT_EQ(report.kind, "gnss") << time;
        EXPECT_EQ(report.start_s, 1714557600.5) << time;
        EXPECT_TRUE(std::ranges::none_of(report.problems, [](const Problem& p) {
            return p.text.find("unit") != std::string::npos;
        })) << report.problems.front().text;
        // numbers below such a name have no known origin
        if (std::string(time) == "Date" || std::string(time) == "UTC")
            expect_kind("unknown", "gps.csv",
                        table(std::string(time) + ",lat,lon,height", ",", 1.0, 120000.0, 40, {48.0, 11.0, 500.0}));
    }
    const auto apart = of("gps.csv", [] {
        std::string rows = "date,time,lat,lon,height\n";
        for (int i = 0; i < 40; ++i)
            rows += fmt::format("2024-05-0{},{:02d}:59:{:02d}.5,48.{:05d},11.5,500\n", i < 20 ? 1 : 2, i < 20 ? 23 : 0,
                                40 + i % 20, 1000 + i);
        return rows;
    }());
    EXPECT_EQ(apart.kind, "gnss");
    EXPECT_EQ(apart.start_s, 1714607980.5);
}

TEST_F(Recognition, WhatIsNoNumberIsShown) {
    std::string rows = "time_s,lat,lon,alt\n";
    for (int i = 0; i < 300; ++i) rows += fmt::format("{},48.{:05d},11.5,\"1,521.{:02d}\"\n", i, 1000 + i, i % 100);
    const FileReport report = of("gps.csv", rows);
    const auto shown = std::ranges::find_if(report.problems, [](const Problem& p) {
        return p.text.find("300 of 300 rows have no number in alt, the first '1,521.00'") != std::string::npos;
    });
    ASSERT_NE(shown, report.problems.end());
    EXPECT_EQ(shown->hint.find("nothing to do"), std::string::npos);
    EXPECT_NE(shown->hint.find("1521.17"), std::string::npos) << shown->hint;
}

TEST_F(Recognition, AGyroscopeAloneLacksItsAccelerometer) {
    const std::string rates = table("time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s", ",", 0.01, 1.0, 300, {0.1, 0.2, 0.3});
    const FileReport alone = of("gyro_phone.csv", rates);
    ASSERT_EQ(alone.problems.size(), 1U);
    EXPECT_EQ(alone.resembles, "imu");
    EXPECT_NE(alone.problems[0].text.find("a gyroscope without an accelerometer"), std::string::npos) << alone.problems[0].text;
    // the table beside it is by its name that of the accelerometer, and has other columns
    write("acc_phone.csv", table("time_s,voltage_x,voltage_y,voltage_z", ",", 0.01, 1.0, 300, {0.1, 0.2, 0.3}));
    const InspectReport both = inspect(folder());
    const auto gyro = std::ranges::find(both.files, "gyro_phone.csv", &FileReport::path);
    ASSERT_NE(gyro, both.files.end());
    ASSERT_EQ(gyro->problems.size(), 1U);
    EXPECT_NE(gyro->problems[0].text.find("acc_phone.csv beside it has no columns of an accelerometer"), std::string::npos)
        << gyro->problems[0].text;
}

TEST_F(Recognition, ArchivesAreToldToBeUnpacked) {
    std::string tar(512, '\0');
    tar.replace(0, 7, "imu.csv");
    tar.replace(257, 5, "ustar");
    for (const auto& [name, bytes, what] : {std::tuple("log.zip", std::string("PK\3\4", 4) + std::string(300, '\1'), "zip"),
                                            std::tuple("log.tar", tar + std::string(512, 'x'), "tar"),
                                            std::tuple("log.7z", "7z\xbc\xaf\x27\x1c" + std::string(300, '\1'), "7z"),
                                            std::tuple("log.csv.xz",
                                                       std::string("\xfd"
                                                                   "7zXZ\0",
                                                                   6) +
                                                           std::string(300, '\1'),
                                                       "xz"),
                                            std::tuple("log.csv.zst", "\x28\xb5\x2f\xfd" + std::string(300, '\1'), "zstd")}) {
        const InspectReport report = inspect(write(name, bytes));
        ASSERT_EQ(report.files.size(), 1U);
        EXPECT_EQ(report.files.front().kind, "archive");
        ASSERT_FALSE(report.files.front().problems.empty()) << name;
        EXPECT_NE(report.files.front().problems.front().text.find(std::string("packed with ") + what), std::string::npos)
            << report.files.front().problems.front().text;
        EXPECT_NE(report.files.front().problems.front().hint.find("unpack"), std::string::npos);
        EXPECT_TRUE(std::ranges::any_of(report.problems, [](const Problem& p) {
            return p.level == Level::Error && p.hint.find("unpack") != std::string::npos;
        })) << name;
    }
}

TEST_F(Recognition, ProjectsAreKnownByTheirContent) {
    const std::string yaml = "imupath: \"imu.txt\"\ngnsspath: \"gnss.txt\"\n";
    for (const char* name : {"kf-gins.yaml", "kf-gins", "kf-gins.txt"}) expect_kind("kfgins_yaml", name, yaml);
    expect_kind("kfgins_yaml", "ob_gins", "# comment\nimufile: imu.txt\ngnssfile: gnss.txt\n");
    expect_kind("dataset_toml", "set", "name = \"drive\"\n\n[imu]\nfile = \"imu.csv\"\n");
    expect_kind("unknown", "notes.txt", "the imupath and the gnsspath are in the project\n[imu] is not here\n");
}

TEST_F(Recognition, WhatIsNoLogIsUnknown) {
    const std::vector<std::string> headers = {"time_s,motor_1,motor_2,motor_3,motor_4",
                                              "timestamp,voltage_v,current_a,remaining",
                                              "time,open,high,low,close",
                                              "t,u,v,w",
                                              "timestamp,cpu_load,ram_usage,temp_a",
                                              "time_s,ch1,ch2,ch3,ch4,ch5,ch6",
                                              "time,servo1,servo2",
                                              "frame,exposure_ms,gain",
                                              "time_s,thrust,torque",
                                              "time_s,satellite_count,hdop,vdop,pdop",
                                              "id,name,price,quantity,stock",
                                              "time_s,wind_x,wind_y,wind_z",
                                              "timestamp,rpm_left,rpm_right",
                                              "time_s,range_cm,quality",
                                              "t,fuel,load,rpm",
                                              "timestamp,flow_dx,flow_dy,quality"};
    for (const std::string& header : headers) {
        const auto columns = static_cast<std::size_t>(std::count(header.begin(), header.end(), ','));
        std::vector<double> values;
        for (std::size_t i = 0; i < columns; ++i) values.push_back(3.0 + static_cast<double>(i));
        expect_kind("unknown", "other.csv", table(header, ",", 0.1, 0.0, 40, values));
    }
    // numbers without names
    for (const std::size_t columns : {2U, 3U, 5U, 6U, 11U, 12U, 16U})
        expect_kind("unknown", "n.txt", table("", " ", 0.1, 0.0, 40, std::vector<double>(columns - 1, 5.0)));
    for (const double size : {95.0, 300.0, 2000.0})
        expect_kind("unknown", "n.txt", table("", " ", 0.1, 0.0, 40, std::vector<double>(6, size)));
    expect_kind("unknown", "a.txt", "This is a text about a flight.\nIt went well.\n");
    expect_kind("unknown", "b.bin",
                std::string("\x7f"
                            "ELF\0\1\2\3\0\0\0\0",
                            12) +
                    std::string(500, '\3'));
    expect_kind("unknown", "c.csv", "a,b\n");
}

TEST_F(Recognition, TablesOfKfGinsByTheirValues) {
    for (const std::size_t columns : {7U, 8U, 9U}) {
        std::vector<double> increments(columns - 1, 0.0);
        increments[5] = -9.8 * 0.005;
        std::string out;
        for (int i = 0; i < 60; ++i) {
            out += fmt::format("{:.6f}", 1000.0 + 0.005 * i);
            for (const double v : increments) out += fmt::format(" {:.9f}", v + 1e-7 * std::sin(i));
            out += "\n";
        }
        expect_kind("kfgins_imu", "imu.txt", out);
    }
    expect_kind("kfgins_gnss", "gnss.txt", table("", " ", 1.0, 1000.0, 40, {30.0, 114.0, 20.0, 0.01, 0.01, 0.03}));
    std::string truth;
    for (int i = 0; i < 40; ++i)
        truth += fmt::format("{:.3f} 30.0 {:.10f} 20.0 0.0 2.0 0.0 0.5 0.6 90.0\n", 1000.0 + 0.005 * i, 114.0 + 1.0372e-7 * i);
    expect_kind("kfgins_reference", "truth.nav", truth);
    expect_kind("imu", "rates.txt", table("", " ", 0.01, 0.0, 60, {0.01, -0.02, 0.03, 0.1, 0.2, -9.8}));
}

TEST_F(Recognition, NanosecondsOfAnEpochAreAComputersClock) {
    std::string rows =
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
    for (int i = 0; i < 400; ++i)
        rows += fmt::format("{},{:.4f},0.01,0.02,9.8,{:.3f},-3.2\n", 1403636579758555392LL + 5'000'000LL * i, 1e-3 * (i % 7),
                            1e-2 * (i % 5));
    const InspectReport report = inspect(write("imu0.csv", rows));
    const auto scale = std::ranges::find(report.facts, "time.scale", &Fact::key);
    ASSERT_NE(scale, report.facts.end());
    EXPECT_EQ(to_text(scale->value), "\"utc\"");
}

TEST_F(Recognition, UnitsOfTimeByTheSteps) {
    const std::string header = "t,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2";
    for (const double rate : {50.0, 100.0, 250.0, 400.0, 1000.0, 2000.0}) {
        for (const double unit : {1e3, 1e6, 1e9}) {
            if (unit / rate < 2.5 || std::fmod(unit, rate) != 0.0) continue;  // a step of one or two may be seconds as well
            const FileReport report =
                of("imu.csv", table(header, ",", unit / rate, 5e6, 200, {0.01, -0.02, 0.03, 0.1, 0.2, -9.8}, "{:.0f}"));
            EXPECT_NEAR(report.rate_hz, rate, 0.01 * rate) << rate << " Hz in units of 1/" << unit << " s";
        }
    }
}

}  // namespace
}  // namespace schuler::inspect
