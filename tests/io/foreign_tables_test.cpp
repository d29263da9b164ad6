// Tables as other programs write them: preambles, UTF-16, dates of spreadsheets, degrees and minutes, fixes held over faster rows.
#include "io/io_fixture.h"

#include "schuler/core/units.h"
#include "schuler/io/formats.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/held_rows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

namespace schuler::io {
namespace {

using ForeignTables = test::IoTest;

const std::string header = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";

std::string rows(int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += fmt::format("{:.2f},0.01,0.02,0.0{},0.1,0.2,-9.8\n", 0.01 * i, i % 9 + 1);
    return text;
}

TEST_F(ForeignTables, LinesAboveTheHeaderAreSetAside) {
    for (const char* preamble :
         {"Logger v2.3\nStart: 2024-05-01 10:00\nDevice,X\n\n", "My recording\n", "rate,100,Hz\nsite,roof\n"}) {
        const auto path = write("imu.csv", preamble + header + rows(20));
        const TableLayout layout = inspect_table(TextInput(path));
        ASSERT_EQ(layout.names.size(), 7U) << preamble;
        EXPECT_EQ(layout.names.front(), "time_s");
        EXPECT_FALSE(layout.comments.empty());
        WarningLog log;
        EXPECT_EQ(read_imu_csv(TextInput(path), {}, log).samples.size(), 20U) << preamble;
    }
}

/// A header that has more or fewer names than the rows have fields is the header all the same.
TEST_F(ForeignTables, BarsBetweenColumns) {
    const TableLayout layout =
        inspect_table(TextInput::memory("time_s|lat|lon|height\n1.0|48.1|11.5|500\n2.0|48.1|11.5|501\n", "b.txt"));
    EXPECT_EQ(layout.delimiter, '|');
    EXPECT_EQ(layout.names, (std::vector<std::string>{"time_s", "lat", "lon", "height"}));
    WarningLog log;
    const GnssTable table =
        read_gnss_csv(TextInput::memory("time_s|lat|lon|height\n1.0|48.1|11.5|500\n2.0 | 48.1 |11.5|501\n", "b.txt"), {}, log);
    ASSERT_EQ(table.fixes.size(), 2u);
    EXPECT_EQ(table.fixes[1].position.h, 501.0);
}

TEST_F(ForeignTables, AHeaderOfAnotherWidthStays) {
    const auto path = write("imu.csv", "time_s,gx,gy,gz,ax,ay,az,note\n" + rows(20));
    EXPECT_EQ(inspect_table(TextInput(path)).header_line, 1);
    EXPECT_EQ(inspect_table(TextInput(path)).names.size(), 8U);
}

TEST_F(ForeignTables, Utf16IsRead) {
    const std::string text = header + rows(20);
    for (const bool big : {false, true}) {
        std::string wide = big ? std::string("\xfe\xff") : std::string("\xff\xfe");
        for (const char c : text) {
            if (big) wide += '\0';
            wide += c;
            if (!big) wide += '\0';
        }
        const auto path = write("imu.csv", wide);
        ASSERT_NE(format_of(path), nullptr);
        EXPECT_EQ(format_of(path)->name, "csv");
        WarningLog log;
        EXPECT_EQ(read_imu_csv(TextInput(path), {}, log).samples.size(), 20U);
    }
    EXPECT_EQ(utf8_of_utf16(std::string("\xff\xfe\xb0\x00\x3d\xd8\x00\xde", 8)), "\xc2\xb0\xf0\x9f\x98\x80");
}

TEST_F(ForeignTables, DatesOfSpreadsheets) {
    const auto standard = [](const char* text) { return detail::calendar_nanoseconds(text).value_or(-1); };
    const std::int64_t noon = standard("2024-05-13 12:30:15.25");
    ASSERT_GT(noon, 0);
    EXPECT_EQ(standard("5/13/2024 12:30:15.25 PM"), noon);
    EXPECT_EQ(standard("05/13/2024 12:30:15.25"), noon);
    EXPECT_EQ(standard("13/05/2024 12:30:15.25"), noon);
    EXPECT_EQ(standard("13.5.2024 12:30:15.25"), noon);
    EXPECT_EQ(standard("2024-05-13 12:30:15.25 pm"), noon);
    constexpr std::int64_t hour = 3'600'000'000'000;
    EXPECT_EQ(standard("5/13/2024 1:30:15.25 PM"), noon + hour);
    EXPECT_EQ(standard("5/13/2024 12:30:15.25 AM"), noon - 12 * hour);
    EXPECT_EQ(standard("5/6/2024 01:00:00 AM"), standard("2024-05-06 01:00:00"));
    EXPECT_EQ(standard("01:00:00 PM"), 13 * hour);
    for (const char* no :
         {"5/6/2024 12:00:00", "14:00:00 PM", "0:30:00 AM", "5/13/2024", "alarm", "13/13/2024 12:00:00", "12:00 PM"})
        EXPECT_FALSE(detail::calendar_nanoseconds(no).has_value()) << no;
}

TEST_F(ForeignTables, DegreesAndMinutes) {
    std::string text = "time_s,latitude,longitude,height\n";
    for (int i = 0; i < 20; ++i)
        text += fmt::format("{},{:.5f},{:.5f},500\n", i, 4859.9 + 0.01 * i + (i >= 10 ? 40.0 : 0.0), 1130.5 + 0.01 * i);
    WarningLog log;
    const GnssTable table = read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log);
    ASSERT_EQ(table.fixes.size(), 20U);
    EXPECT_NEAR(table.fixes[0].position.lat, (48.0 + 59.9 / 60.0) * units::deg, 1e-12);
    EXPECT_NEAR(table.fixes[19].position.lat, (49.0 + 0.09 / 60.0) * units::deg, 1e-12);
    EXPECT_NEAR(table.fixes[0].position.lon, (11.0 + 30.5 / 60.0) * units::deg, 1e-12);
    // hemispheres beside them
    text = "time_s,lat,N/S,lon,E/W,height\n";
    for (int i = 0; i < 5; ++i) text += fmt::format("{},3352.{},S,15112.5,W,10\n", i, i);
    const GnssTable south = read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log);
    EXPECT_NEAR(south.fixes[0].position.lat, -(33.0 + 52.0 / 60.0) * units::deg, 1e-12);
    EXPECT_NEAR(south.fixes[0].position.lon, -(151.0 + 12.5 / 60.0) * units::deg, 1e-12);
    // near the equator, and near Greenwich too: the longitude beyond 360 and all digits of NMEA show the form
    for (const auto& [lat, lon] :
         {std::pair("0030.5", "00130.25"), std::pair("30.5", "10130.25"), std::pair("30.5N", "10130.25E")}) {
        text = "time_s,latitude,longitude,height\n";
        for (int i = 0; i < 5; ++i) text += fmt::format("{},{},{},10\n", i, lat, lon);
        const GnssTable equator = read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log);
        EXPECT_NEAR(equator.fixes[0].position.lat, 30.5 / 60.0 * units::deg, 1e-12) << lat;
        EXPECT_NEAR(equator.fixes[0].position.lon, (lon[0] == '0' ? 1.0 : 101.0) * units::deg + 30.25 / 60.0 * units::deg, 1e-12);
    }
    // degrees with leading zeros, or minutes beyond 60, are degrees
    for (const char* row : {"030.5,001.25", "0030.5,00165.25"}) {
        text = fmt::format("time_s,latitude,longitude,height\n0,{0},10\n1,{0},10\n", row);
        const GnssTable degrees = read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log);
        EXPECT_NEAR(degrees.fixes[0].position.lat, 30.5 * units::deg, 1e-12) << row;
    }
    // a longitude under the latitude's name
    text = "time_s,latitude,longitude,height\n0,139.71,35.62,10\n1,139.71,35.62,10\n";
    EXPECT_NE(
        test::message_of([&] { (void)read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log); }).find("latitude of 139"),
        std::string::npos);
    // minutes beyond 60: something else
    text = "time_s,latitude,longitude,height\n0,4875.1,1130.5,500\n1,4875.2,1130.6,500\n";
    EXPECT_NE(
        test::message_of([&] { (void)read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log); }).find("latitude of 4875"),
        std::string::npos);
}

TEST_F(ForeignTables, TablesOfMavlinkHaveTheirUnits) {
    std::string text = "timestamp,time_usec,xacc,yacc,zacc,xgyro,ygyro,zgyro,xmag,ymag,zmag\n";
    for (int i = 0; i < 20; ++i)
        text += fmt::format("{:.2f},{},10,{},-1000,100,0,-50,200,0,400\n", 1.7e9 + 0.02 * i, 1'000'000 + 20'000 * i, i % 7);
    const auto path = write("RAW_IMU.csv", text);
    EXPECT_EQ(guess_table_kind(inspect_table(TextInput(path))), TableKind::Imu);
    EXPECT_TRUE(match_columns(inspect_table(TextInput(path)), TableKind::Imu).find("gyro_x_rad_s")->unit_stated);
    TableLayout stated;
    stated.names = {"xacc [m/s^2]", "yacc (mG)"};
    stated.columns = stated.data_columns = 2;
    EXPECT_NEAR(match_columns(stated, TableKind::Imu).find("accel_x_m_s2")->factor, 1.0, 1e-12);
    EXPECT_NEAR(match_columns(stated, TableKind::Imu).find("accel_y_m_s2")->factor, units::mg, 1e-12);
    WarningLog log;
    const ImuTable imu = read_imu_csv(TextInput(path), {}, log);
    ASSERT_EQ(imu.samples.size(), 20U);
    EXPECT_NEAR(imu.samples[0].accel.z(), -units::g0, 1e-9);
    EXPECT_NEAR(imu.samples[0].gyro.x(), 0.1, 1e-12);
    EXPECT_NEAR((imu.samples[1].time - imu.samples[0].time).seconds(), 0.02, 1e-9);
    EXPECT_NEAR(read_mag_csv(TextInput(path), {}, log).samples[0].field_b.z(), 40e-6, 1e-12);
}

/// The motion file of a simulator: accelerations without gravity under the names of an IMU's.
TEST_F(ForeignTables, AComputedMotionIsNoImu) {
    std::string text = "rate,10\nTime_ms,Acc_X,Acc_Y,Acc_Z,Jerk_X,Jerk_Y,Jerk_Z,Ang-vel_X,Ang-vel_Y,Ang-vel_Z\n";
    for (int i = 0; i < 20; ++i) text += fmt::format("{},0,0.1,0,0,0,0,0,0,0.01\n", 100 * i);
    EXPECT_FALSE(guess_table_kind(inspect_table(TextInput(write("motion.csv", text)))).has_value());
}

TEST_F(ForeignTables, GyroscopeAndAccelerometerOfATelephone) {
    std::string gyro = "time,seconds_elapsed,z,y,x\n", accel = gyro, linear = gyro;
    for (int i = 0; i < 400; ++i) {
        gyro += fmt::format("{},{:.3f},0.3,0.2,0.1\n", 1'700'000'000'000'000'000LL + 10'000'000LL * i, 0.01 * i);
        accel += fmt::format("{},{:.3f},9.8,{:.3f},0\n", 1'700'000'000'003'000'000LL + 10'000'000LL * i, 0.01 * i, 0.01 * i);
        linear += fmt::format("{},{:.3f},0,0.1,0\n", 1'700'000'000'003'000'000LL + 10'000'000LL * i, 0.01 * i);
    }
    const auto path = write("Gyroscope.csv", gyro);
    EXPECT_EQ(format_of(path)->name, "csv");  // alone it is no log of an IMU
    (void)write("Accelerometer.csv", linear);
    ASSERT_EQ(format_of(path)->name, "phone");
    WarningLog log;
    EXPECT_NE(test::message_of([&] { (void)format_of(path)->read(TextInput(path), log); }).find("does not show gravity"),
              std::string::npos);
    (void)write("TotalAcceleration.csv", accel);
    const StreamLog joined = format_of(path)->read(TextInput(path), log);
    ASSERT_EQ(joined.streams.size(), 1U);
    const Stream& imu = joined.streams.front();
    EXPECT_EQ(joined.clock, Clock::Unix);
    ASSERT_EQ(imu.rows(), 399U);
    EXPECT_EQ(imu.time_ns[0], 1'700'000'000'010'000'000LL);
    EXPECT_NEAR(imu.find("gyro_x")->values[0], 0.1, 1e-12);
    EXPECT_NEAR(imu.find("accel_z")->values[5], 9.8, 1e-12);
    EXPECT_NEAR(imu.find("accel_y")->values[0], 0.007, 1e-9);  // between the samples at 3 and 13 ms
    std::string uncalibrated = "time,seconds_elapsed,z,y,x\n", mag = uncalibrated;
    for (int i = 0; i < 40; ++i) {
        uncalibrated += fmt::format("{},{:.3f},1,2,3\n", 1'700'000'000'000'000'000LL + 100'000'000LL * i, 0.1 * i);
        mag += fmt::format("{},{:.3f},-45,2,20.5\n", 1'700'000'000'000'000'000LL + 100'000'000LL * i, 0.1 * i);
    }
    (void)write("MagnetometerUncalibrated.csv", uncalibrated);
    EXPECT_EQ(format_of(path)->read(TextInput(path), log).streams.size(), 1U) << "the biases are in it";
    (void)write("Magnetometer.csv", mag);
    const StreamLog with_field = format_of(path)->read(TextInput(path), log);
    ASSERT_EQ(with_field.streams.size(), 2U);
    const Stream& field = *with_field.find("mag");
    ASSERT_EQ(field.rows(), 40U) << "at its own times";
    EXPECT_EQ(field.time_ns[1], 1'700'000'000'100'000'000LL);
    EXPECT_EQ(field.find("mag_x_ut")->values[0], 20.5);
    EXPECT_EQ(field.find("mag_z_ut")->values[0], -45.0);
}

/// 5 Hz written with every row at 100 Hz.
TEST_F(ForeignTables, HeldFixesAreOneFixEach) {
    std::string text = "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s\n";
    for (int i = 0; i < 2000; ++i) {
        const int fix = i < 1500 ? i / 20 : 74;  // then it is at rest
        text += fmt::format("{:.2f},{:.8f},11,500,{:.3f},0,0\n", 0.01 * i, 48.0 + 1e-5 * fix, 5.5 + 0.01 * (fix % 3));
    }
    WarningLog log;
    const GnssTable table = read_gnss_csv(TextInput::memory(text, "gnss.csv"), {}, log);
    ASSERT_EQ(table.fixes.size(), 75U);
    EXPECT_NEAR(table.fixes[3].time.seconds(), 0.6, 1e-9);
    EXPECT_EQ(log.count("gnss.held"), 1925U);
}

/// A receiver that says the same while it rests, and coordinates that are rounded, are fixes like others.
TEST_F(ForeignTables, RestAndRoundingAreNotHeld) {
    std::vector<bool> rest(1000, true);
    for (std::size_t i = 0; i < 500; ++i) rest[i] = false;
    EXPECT_TRUE(held_rows(rest).empty());
    std::vector<bool> rounded(1000, true);
    for (std::size_t i = 0, step = 1; i < 1000; i += step, step = 2 + (7 * step + i) % 11) rounded[i] = false;
    EXPECT_TRUE(held_rows(rounded).empty());
    std::vector<bool> held(1000, true);
    for (std::size_t i = 0; i < 1000; i += 10) held[i] = false;
    EXPECT_EQ(held_rows(held).size(), 900U);
}

}  // namespace
}  // namespace schuler::io
