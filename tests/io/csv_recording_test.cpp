#include "schuler/io/text/csv/csv_recording.h"

#include "schuler/core/units.h"
#include "schuler/io/text/fix_codes.h"

#include "io/io_fixture.h"

#include <GeographicLib/Geocentric.hpp>

#include <fmt/format.h>

#include <cmath>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

const std::string imu_header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";

/// Rows at 100 Hz whose x rate is their number; `change` may alter a row's text.
std::string imu_text(int rows, const std::function<std::string(int, std::string)>& change = nullptr) {
    std::string text = imu_header;
    for (int i = 0; i < rows; ++i) {
        std::string row = fmt::format("{:.3f},{},0.2,0.3,0.1,0.2,-9.8", 100.0 + 0.01 * i, i);
        if (change) row = change(i, row);
        text += row + "\n";
    }
    return text;
}

class Csv : public test::IoTest {
protected:
    ImuTable imu(const std::string& text, const CsvOptions& options = {}) {
        return read_imu_csv(TextInput::memory(text, "imu.csv"), options, log);
    }
    GnssTable gnss(const std::string& text, const CsvOptions& options = {}) {
        return read_gnss_csv(TextInput::memory(text, "gnss.csv"), options, log);
    }
    WarningLog log;
};

TEST_F(Csv, VelocitiesThatAreAlwaysZeroAreLeftOut) {
    const auto log_of = [](double step) {
        std::string text = "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s\n";
        for (int i = 0; i < 100; ++i) text += fmt::format("{},{:.7f},11,500,0,0,0\n", i, 48.0 + step * i);
        return text;
    };
    EXPECT_TRUE(gnss(log_of(1e-4)).fixes[3].velocity_n.array().isNaN().all());
    EXPECT_EQ(log.topics(), std::vector<std::string>{"gnss.idle_velocity"});
    EXPECT_EQ(gnss(log_of(0.0)).fixes[3].velocity_n, Eigen::Vector3d::Zero()) << "a receiver at rest";
}

TEST_F(Csv, TimesMayBeCalendarText) {
    const std::string names = "timestamp,gx,gy,gz,ax,ay,az\n", rest = ",0,0,0,0,0,-9.8\n";
    // Noon of 2024-05-01 in Greenwich, four ways of writing it, then midnight-based times of day.
    for (const std::string at : {"2024-05-01T12:00:00.125Z", "2024-05-01 12:00:00.125", "2024/05/01 14:00:00.125+02:00",
                                 "\"2024-05-01T11:30:00.125-0030\""}) {
        const ImuTable t = imu(names + at + rest + "2024-05-01T12:00:01Z" + rest);
        ASSERT_EQ(t.samples.size(), 2U) << at;
        EXPECT_EQ(t.samples[0].time.ns, 1714564800125000000) << at;
        EXPECT_EQ(t.samples[1].time.ns, 1714564801000000000);
    }
    EXPECT_EQ(imu(names + "23:59:59.5" + rest + "23:59:59.6" + rest).samples[0].time.ns, 86399500000000);
    for (const std::string at : {"2024-13-01T12:00:00", "2024-05-01T25:00:00", "2024-05-01", "12:00"}) {
        std::string text = names;
        for (int k = 0; k < 20; ++k) text += (k == 9 ? at : fmt::format("2024-05-01T12:00:{:02}Z", k)) + rest;
        EXPECT_EQ(imu(text).rows.bad, 1U) << at;
    }
}

TEST_F(Csv, TheScaleOfATimeIsItsUnit) {
    const std::string text = "tick,gx,gy,gz,ax,ay,az\n1500,0,0,0,0,0,-9.8\n1510,0,0,0,0,0,-9.8\n";
    CsvOptions options;
    options.columns["time_s"] = "tick";
    options.scale["time_s"] = 1e-3;
    EXPECT_EQ(imu(text, options).samples[0].time.ns, 1500000000);
    options.scale["time_s"] = 0.02;
    expect_parts(message_of([&] { (void)imu(text, options); }), {"scale.time_s", "0.02", "1e-3"});
}

TEST_F(Csv, ImuIsReadInSensorAxesAndSi) {
    const ImuTable t =
        imu("t_ms; gx [deg/s]; gy [deg/s]; gz [deg/s]; ax [g]; ay [mg]; az [m/s^2]; note\n"
            "1000,5; 180; -90; 0; 1; 500; -9,5; a\n"
            "1010,5; 0; 0; 1e1; 0; 0; 0; b\n");
    ASSERT_EQ(t.samples.size(), 2U);
    EXPECT_EQ(t.kind, ImuKind::Rates);
    EXPECT_EQ(t.samples[0].time.ns, 1000500000);
    EXPECT_EQ(t.samples[1].time.ns, 1010500000);
    EXPECT_LT((t.samples[0].gyro - Eigen::Vector3d(std::numbers::pi, -std::numbers::pi / 2.0, 0.0)).norm(), 1e-15);
    EXPECT_LT((t.samples[0].accel - Eigen::Vector3d(9.80665, 0.5 * 9.80665, -9.5)).norm(), 1e-15);
    EXPECT_TRUE(log.empty());
    const ImuTable d =
        imu("time_s,dtheta_x_rad,dtheta_y_rad,dtheta_z_rad,dv_x_m_s,dv_y_m_s,dv_z_m_s\n1,0.1,0.2,0.3,4,5,6\n2,1,2,3,4,5,6\n");
    EXPECT_EQ(d.kind, ImuKind::Increments);
    EXPECT_EQ(d.samples[0].gyro, Eigen::Vector3d(0.1, 0.2, 0.3));
    EXPECT_EQ(d.samples[0].accel, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_F(Csv, WrongColumnNamesTheOnesThereAre) {
    expect_parts(
        message_of([&] { (void)imu("time_s,gx,gy,gz,ax,ay,up\n1,2,3,4,5,6,7\n"); }),
        {"imu.csv:1", "accel_z_m_s2", "no such column", "[imu] columns = { accel_z_m_s2 = ", "time_s, gx, gy, gz, ax, ay, up"});
    expect_parts(message_of([&] { (void)imu("1,2,3,4,5,6,7\n2,2,3,4,5,6,7\n"); }), {"imu.csv:1", "no header line", "#1"});
    expect_parts(message_of([&] { (void)imu(imu_header); }), {"imu.csv:1", "no rows below the header"});
    // Numbered columns need no header.
    CsvOptions options;
    int number = 1;
    for (const char* name :
         {"time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"}) {
        options.columns[name] = fmt::format("#{}", number++);
    }
    EXPECT_EQ(imu("1,2,3,4,5,6,7\n2,2,3,4,5,6,7\n", options).samples[1].accel.z(), 7.0);
}

TEST_F(Csv, IsolatedBadRowsAreSkippedAndCounted) {
    const ImuTable t = imu(imu_text(100, [](int i, std::string row) {
        if (i == 50) return fmt::format("{:.3f},nan,0.2,0.3,0.1,0.2,-9.8", 100.5);
        if (i == 60) return fmt::format("{:.3f},1,0.2,,0.1,0.2,-9.8", 100.6);
        return row;
    }));
    EXPECT_EQ(t.samples.size(), 98U);
    EXPECT_EQ(t.rows.bad, 2U);
    EXPECT_EQ(log.count("imu.bad_rows"), 2U);
    expect_parts(log.summary().at(0), {"imu.csv", "line 52", "(2 times)"});
}

TEST_F(Csv, ManyBadRowsAreAnErrorAndThoseAtTheStartAreLeftOut) {
    const auto nan_from = [](int first) {
        return imu_text(100, [first](int i, std::string row) {
            return i >= first ? fmt::format("{:.3f},1,NaN,0.3,0.1,0.2,-9.8", 100.0 + 0.01 * i) : row;
        });
    };
    expect_parts(message_of([&] { (void)imu(nan_from(90)); }),
                 {"imu.csv:92", "column 3", "gyro_y_rad_s", "'NaN' is not a number", "10 of 100", "[imu] columns"});
    expect_parts(message_of([&] { (void)imu(nan_from(0)); }), {"imu.csv:2", "column 3", "gyro_y_rad_s", "delete the row"});
    const auto nan_until = [](int last) {
        return imu_text(100, [last](int i, std::string row) {
            return i < last ? fmt::format("{:.3f},1,NaN,0.3,0.1,0.2,-9.8", 100.0 + 0.01 * i) : row;
        });
    };
    for (const int last : {1, 20}) {
        log = WarningLog{};
        const ImuTable t = imu(nan_until(last));
        EXPECT_EQ(t.samples.size(), static_cast<std::size_t>(100 - last)) << "an instrument that starts late";
        EXPECT_EQ(log.count("imu.bad_rows"), static_cast<std::size_t>(last));
        expect_parts(log.summary().at(0), {"imu.csv", "line 2"});
    }
    expect_parts(message_of([&] { (void)imu(nan_until(60)); }), {"imu.csv:2", "column 3", "60 of 100 rows"});
}

TEST_F(Csv, AbsurdValuesSuggestTheUnit) {
    const auto with = [](const std::string& bad) {
        return imu_text(20, [&](int i, std::string row) { return i == 10 || i == 11 ? bad : row; });  // one alone is an accident
    };
    expect_parts(message_of([&] { (void)imu(with("100.1,1,2,20000,1,2,3")); }),
                 {"imu.csv:12", "column 4", "gyro_z_rad_s", "deg/s", "[imu] scale = { gyro_rad_s"});
    expect_parts(message_of([&] { (void)imu(with("100.1,1,2,3,-16384,2,3")); }),
                 {"imu.csv:12", "column 5", "accel_x_m_s2", "[imu] scale = { accel_m_s2"});
    const std::string head = "time_s,lat_deg,lon_deg,height_m\n1,47.1,8.1,400\n";
    expect_parts(message_of([&] { (void)gnss(head + "2,471000000,81000000,400\n"); }),
                 {"gnss.csv:3", "column 2", "lat_deg", "1e-7"});
    expect_parts(message_of([&] { (void)gnss(head + "2,47.1,481,400\n"); }), {"gnss.csv:3", "column 3", "lon_deg"});
    WarningLog baro_log;
    expect_parts(
        message_of([&] { (void)read_baro_csv(TextInput::memory("time_s,pressure_pa\n1,97.8\n", "b.csv"), {}, baro_log); }),
        {"b.csv:2", "column 2", "pressure_pa", "hPa or kPa"});
}

TEST_F(Csv, TimeGoingBack) {
    // Two rows exchanged, one row twice, one time twice with other values.
    const ImuTable t = imu(imu_text(100, [](int i, std::string row) {
        if (i == 20) return fmt::format("{:.3f},21,0.2,0.3,0.1,0.2,-9.8", 100.21);
        if (i == 21) return fmt::format("{:.3f},20,0.2,0.3,0.1,0.2,-9.8", 100.20);
        if (i == 40) return fmt::format("{:.3f},39,0.2,0.3,0.1,0.2,-9.8", 100.39);
        if (i == 60) return fmt::format("{:.3f},60,0.2,0.3,0.1,0.2,-9.8", 100.59);
        return row;
    }));
    EXPECT_EQ(t.samples.size(), 99U);
    EXPECT_EQ(t.rows.out_of_order, 1U);
    EXPECT_EQ(t.rows.duplicates, 1U);
    EXPECT_EQ(t.rows.same_time, 1U);
    for (std::size_t i = 1; i < t.samples.size(); ++i) EXPECT_LE(t.samples[i - 1].time, t.samples[i].time);
    EXPECT_EQ(t.samples[20].gyro.x(), 20.0);
    EXPECT_EQ(log.count("imu.out_of_order"), 1U);
    // A log appended to itself.
    const std::string once = imu_text(100);
    const std::string twice = once + once.substr(imu_header.size());
    expect_parts(message_of([&] { (void)imu(twice); }), {"imu.csv:102", "time goes back from 100.99 s to 100 s", "several logs"});
}

TEST_F(Csv, CutFile) {
    std::string text = imu_text(50);
    text.resize(text.size() - 12);
    expect_parts(message_of([&] { (void)imu(text); }), {"imu.csv:51", "column 5", "cut here", "delete line 51"});
}

TEST_F(Csv, GnssColumnsOfADrive) {
    CsvOptions options;
    const GnssTable t = gnss(
        "time_s,vel_time_valid_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,std_n_m,std_e_m,std_d_m,std_vel_m_s,"
        "fix_rtk1fix_2float_5single,num_sats,height_msl_m\n"
        "200000.499,200000.379,40.1234567,-105.7654321,1500.250,0.100,-0.200,0.300,0.0099,0.0098,0.0100,0.0587,1,21,1520.750\n"
        "200000.749,200000.629,40.1234567,-105.7654321,1500.500,0.400,0.500,-0.600,,,-1,0.0559,2,21,1520.750\n"
        "200000.999,200000.879,40.1234567,-105.7654321,1500.500,0.400,0.500,-0.600,0.1,0.1,0.1,,5,,1520.750\n"
        "200001.249,,,,,,,,,,,,0,,\n"
        "200001.499,200001.379,0,0,0,0,0,0,1,1,1,1,1,3,0\n",
        options);
    ASSERT_EQ(t.fixes.size(), 3U);
    EXPECT_EQ(t.rows.without_fix, 2U);
    EXPECT_EQ(log.count("gnss.no_fix"), 2U);
    const GnssFix& f = t.fixes[0];
    EXPECT_EQ(f.time.ns, 200000499000000);
    EXPECT_DOUBLE_EQ(f.position.lat, 40.1234567 * units::deg);
    EXPECT_DOUBLE_EQ(f.position.lon, -105.7654321 * units::deg);
    EXPECT_EQ(f.position.h, 1500.250);
    EXPECT_EQ(f.position_age, 0.0);
    EXPECT_NEAR(f.velocity_age, 0.12, 1e-12);
    EXPECT_EQ(f.std_position, Eigen::Vector3d(0.0099, 0.0098, 0.01));
    EXPECT_EQ(f.std_velocity, Eigen::Vector3d::Constant(0.0587));
    EXPECT_EQ(f.fix, FixType::RtkFixed);
    EXPECT_EQ(f.satellites, 21);
    EXPECT_EQ(t.fixes[1].fix, FixType::RtkFloat);
    EXPECT_TRUE(t.fixes[1].std_position.array().isNaN().all());
    EXPECT_EQ(t.fixes[2].fix, FixType::Autonomous);
    EXPECT_EQ(t.fixes[2].satellites, -1);
    EXPECT_EQ(t.height, HeightKind::Unstated);
    options.columns = {{"height_m", "height_msl_m"}};
    const GnssTable msl = gnss("time_s,lat,lon,height_m,height_msl_m,time_valid_s\n10,40,-105,1,2,9.8\n", options);
    EXPECT_EQ(msl.fixes[0].position.h, 2.0);
    EXPECT_EQ(msl.height, HeightKind::Msl);
    EXPECT_NEAR(msl.fixes[0].position_age, 0.2, 1e-12);
    EXPECT_NEAR(msl.fixes[0].velocity_age, 0.2, 1e-12);
}

TEST_F(Csv, GnssFixWordsCodesAndUp) {
    CsvOptions options;
    options.fix_codes = {{"9", "rtk_fixed"}};
    const GnssTable t = gnss(
        "time_s,lat_rad,lon_rad,height_m,vu,fix,hAcc_m\n1,0.5,4.0,1,2,rtk_float,2\n2,0.5,1.0,1,2,4,2\n3,0.5,1,1,2,9,2\n4,0.5,1,1,"
        "2,77,2\n",
        options);
    EXPECT_EQ(t.fixes[0].velocity_n.z(), -2.0);
    EXPECT_TRUE(std::isnan(t.fixes[0].velocity_n.x()));
    EXPECT_DOUBLE_EQ(t.fixes[0].position.lat, 0.5);
    EXPECT_DOUBLE_EQ(t.fixes[0].position.lon, 4.0 - 2.0 * std::numbers::pi);
    EXPECT_DOUBLE_EQ(t.fixes[0].std_position.x(), std::sqrt(2.0));
    EXPECT_EQ(t.fixes[0].fix, FixType::RtkFloat);
    EXPECT_EQ(t.fixes[1].fix, FixType::RtkFixed);
    EXPECT_EQ(t.fixes[2].fix, FixType::RtkFixed);
    EXPECT_EQ(t.fixes.size(), 3U) << "what 77 means is not guessed";
    EXPECT_EQ(log.count("gnss.fix.unknown"), 1U);
    options.fix_codes = {{"9", "rtkfixd"}};
    expect_parts(message_of([&] { (void)gnss("time_s,lat,lon,height_m,fix\n1,1,1,1,1\n", options); }),
                 {"fix_codes.9", "'rtkfixd'", "rtk_fixed"});
    expect_parts(message_of([&] { (void)gnss("time_s,lat,lon,height_m,fix\n1,1,1,1,0\n2,1,1,1,0\n"); }),
                 {"gnss.csv", "none of the 2 rows has a fix"});
    expect_parts(message_of([&] { (void)gnss("time_s,lat,lon\n1,1,1\n"); }), {"gnss.csv:1", "height_m", "no such column"});
}

TEST_F(Csv, BaroAndMag) {
    const BaroTable b =
        read_baro_csv(TextInput::memory("time_s,baro_height_msl_std_m,airspeed_m_s\n1,423.3,5\n2,424,6\n", "baro.csv"), {}, log);
    EXPECT_EQ(b.height, HeightKind::Msl);
    EXPECT_EQ(b.samples[0].height, 423.3);
    EXPECT_TRUE(std::isnan(b.samples[0].pressure));
    const BaroTable p = read_baro_csv(TextInput::memory("time_s,pressure_kpa\n1,97.82\n", "baro.csv"), {}, log);
    EXPECT_DOUBLE_EQ(p.samples[0].pressure, 97820.0);
    const MagTable m = read_mag_csv(
        TextInput::memory("time_s,mag_x_mgauss,mag_y_mgauss,mag_z_mgauss\n1,-32.7,196.28,482.94\n", "mag.csv"), {}, log);
    EXPECT_LT((m.samples[0].field_b - 1e-7 * Eigen::Vector3d(-32.7, 196.28, 482.94)).norm(), 1e-20);
}

TEST_F(Csv, ReferenceAnglesQuaternionsAndEarthFixed) {
    const auto read = [&](const std::string& text, const CsvOptions& options = {}) {
        return read_reference_csv(TextInput::memory(text, "ref.csv"), options, log);
    };
    const ReferenceTable angles = read("time_s,ahrs_roll_deg,ahrs_pitch_deg,ahrs_yaw_deg\n0,0.5,-1,-90\n");
    EXPECT_LT((angles.samples[0].rpy - units::deg * Eigen::Vector3d(0.5, -1.0, 270.0)).norm(), 1e-15);
    EXPECT_TRUE(std::isnan(angles.samples[0].position.lat));
    EXPECT_TRUE(angles.autopilot);
    // Sensor x east, y north, z up; mounted with body forward = x, right = -y, down = -z: heading 90 deg.
    CsvOptions options;
    options.C_sb = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const ReferenceTable q = read(
        "time_s,quat_sensor_to_enu_w,quat_sensor_to_enu_x,quat_sensor_to_enu_y,quat_sensor_to_enu_z,movement\n0,1,0,0,0,1\n1,,,,,"
        "0\n2,1,0,0,0,0\n",
        options);
    EXPECT_EQ(q.quaternion, "sensor_to_enu");
    ASSERT_EQ(q.samples.size(), 2U);
    EXPECT_LT((q.samples[0].rpy - units::deg * Eigen::Vector3d(0.0, 0.0, 90.0)).norm(), 1e-15);
    EXPECT_TRUE(q.samples[0].movement);
    EXPECT_FALSE(q.samples[1].movement);
    const ReferenceTable n = read("time_s,qw,qx,qy,qz\n0,0.7071067811865476,0,0,0.7071067811865476\n");
    EXPECT_EQ(n.quaternion, "body_to_ned");
    EXPECT_LT((n.samples[0].rpy - units::deg * Eigen::Vector3d(0.0, 0.0, 90.0)).norm(), 1e-15);
    options.quaternion = "body_to_enu";
    expect_parts(message_of([&] { (void)read("time_s,qw,qx,qy,qz\n0,1,0,0,0\n", options); }),
                 {"ref.csv", "body_to_enu", "use sensor_to_enu or body_to_ned"});
    const ReferenceTable e = read(
        "time_s,ecef_x_m,ecef_y_m,ecef_z_m,vel_n_m_s,vel_e_m_s,vel_d_m_s\n36000.0,4000000.1250,700000.2500,4900000.5000,5.25,0."
        "5,0.25\n");
    double lat, lon, h;
    GeographicLib::Geocentric::WGS84().Reverse(4000000.1250, 700000.2500, 4900000.5000, lat, lon, h);
    EXPECT_NEAR(e.samples[0].position.lat, lat * units::deg, 1e-14);
    EXPECT_NEAR(e.samples[0].position.lon, lon * units::deg, 1e-14);
    EXPECT_NEAR(e.samples[0].position.h, h, 1e-8);
}

TEST_F(Csv, TimeOffsetAndUnitOverride) {
    CsvOptions options;
    options.time_unit = TimeUnit::Milliseconds;
    options.time_offset.ns = 7;
    EXPECT_EQ(imu("time,gx,gy,gz,ax,ay,az\n1500.25,0,0,0,0,0,0\n", options).samples[0].time.ns, 1500250007);
}

struct RealFile {
    const char* path;
    std::size_t rows;
};

TEST_F(Csv, RealDataSetsAreReadAsTheyAre) {
    SKIP_WITHOUT_DATA();
    const auto data = test::data_folder();
    const auto lines = [](const std::filesystem::path& path) {
        const std::string text = content_of(path);
        return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) - 1;
    };
    for (const char* set : {"drive_0708", "flight_px4_swiss", "quad_apm_106", "quad_apm_flow", "px4_iris_sitl", "vn310_static",
                            "broad_02_undisturbed_slow_rotation_B"}) {
        const ImuTable t = read_imu_csv(data / set / "imu.csv", {}, log);
        EXPECT_EQ(t.rows.read, lines(data / set / "imu.csv")) << set;
        EXPECT_GE(t.samples.size(), t.rows.read - 2) << set;
        EXPECT_EQ(t.kind, ImuKind::Rates);
    }
    for (const char* set :
         {"drive_0708", "flight_px4_swiss", "quad_apm_106", "quad_apm_flow", "px4_iris_sitl", "vn310_static", "navego_synth"}) {
        const GnssTable t = read_gnss_csv(data / set / "gnss.csv", {}, log);
        EXPECT_EQ(t.rows.read, lines(data / set / "gnss.csv")) << set;
        EXPECT_GT(t.fixes.size(), t.rows.read / 2) << set;
        EXPECT_FALSE(t.fixes.front().velocity_n.array().isNaN().any()) << set;
    }
    EXPECT_EQ(read_gnss_csv(data / "quad_apm_106/gnss.csv", {}, log).height, HeightKind::Relative);
    EXPECT_EQ(read_gnss_csv(data / "flight_px4_swiss/gnss.csv", {}, log).height, HeightKind::Msl);
    EXPECT_NEAR(read_gnss_csv(data / "flight_px4_swiss/gnss.csv", {}, log).fixes[5].velocity_age, 0.24, 1e-9);
    for (const char* set : {"flight_px4_swiss", "quad_apm_106", "quad_apm_flow", "px4_iris_sitl", "vn310_static"}) {
        EXPECT_GT(read_baro_csv(data / set / "baro.csv", {}, log).samples.size(), 1000U) << set;
        EXPECT_GT(read_mag_csv(data / set / "mag.csv", {}, log).samples.size(), 1000U) << set;
    }
    for (const char* set : {"flight_px4_swiss", "quad_apm_106", "quad_apm_flow", "vn310_static", "navego_synth",
                            "spirent_rose_noatm", "broad_07_undisturbed_fast_rotation_B"}) {
        const ReferenceTable t = read_reference_csv(data / set / "reference.csv", {}, log);
        EXPECT_GT(t.samples.size(), 150U) << set;
        EXPECT_FALSE(t.samples[t.samples.size() / 2].rpy.array().isNaN().any()) << set;
    }
    // BROAD at rest: gravity is up in the sensor axes, so levelled attitude with body axes forward-right-down from z up.
    CsvOptions up;
    up.C_sb = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const ReferenceTable broad = read_reference_csv(data / "broad_02_undisturbed_slow_rotation_B/reference.csv", up, log);
    EXPECT_LT(std::abs(broad.samples.front().rpy.x()), 0.05);
    EXPECT_LT(std::abs(broad.samples.front().rpy.y()), 0.05);
}

}  // namespace
}  // namespace schuler::io
