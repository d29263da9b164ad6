// PX4 and ArduPilot logs: written here from the documents of their formats, and the real samples.
#include "schuler/core/units.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <cmath>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

class AutopilotLogs : public test::IoTest {
protected:
    StreamLog read(const std::string& name, const std::string& bytes, WarningLog& warnings) const {
        const std::filesystem::path file = write(name, bytes);
        const Format* format = format_of(file);
        if (format == nullptr || format->read == nullptr) {
            ADD_FAILURE() << name << " was not recognised";
            return {};
        }
        EXPECT_EQ(format->name, name.ends_with(".ulg") ? "ulog" : "dataflash");
        return format->read(TextInput(file), warnings);
    }
};

double value_at(const Stream& s, std::string_view column, std::size_t row) {
    const Stream::Column* c = s.find(column);
    return c == nullptr ? std::nan("") : c->values.at(row);
}

constexpr float gyro_of(int i) { return 0.01F * static_cast<float>(i); }

test::Ulog sample_ulog() {
    test::Ulog log;
    log.define(
        "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;");
    log.define("inner_s:float a;float b;");
    log.define(
        "vehicle_gps_position:uint64_t timestamp;inner_s[2] nested;int32_t lat;int32_t lon;int32_t alt;int32_t alt_ellipsoid;float s_variance_m_s;float eph;float epv;"
        "float vel_n_m_s;float vel_e_m_s;float vel_d_m_s;bool vel_ned_valid;uint8_t fix_type;uint8_t satellites_used;uint8_t[5] _padding0;");
    log.define("vehicle_air_data:uint64_t timestamp;float baro_alt_meter;float baro_pressure_pa;");
    log.define("vehicle_rates_setpoint:uint64_t timestamp;float roll;float pitch;float yaw;");
    log.define("vehicle_attitude:uint64_t timestamp;float[4] q;");
    log.subscribe(0, 0, "sensor_combined");
    log.subscribe(0, 1, "vehicle_gps_position");
    log.subscribe(1, 2, "vehicle_gps_position");
    log.subscribe(0, 3, "vehicle_air_data");
    log.subscribe(0, 4, "vehicle_rates_setpoint");
    log.subscribe(0, 5, "vehicle_attitude");
    for (int i = 0; i < 100; ++i) {
        const std::uint64_t t = 5'000'000 + 4'000U * static_cast<std::uint64_t>(i);
        log.data(0, t, gyro_of(i), 0.0F, -gyro_of(i), std::uint32_t{4000}, std::int32_t{0}, 0.1F, 0.2F, -9.81F);
        log.data(4, t, 1.0F, 2.0F, 3.0F);
        if (i % 20 == 0) {
            for (const std::uint16_t receiver : {1, 2})
                log.data(receiver, t, 1.0F, 2.0F, 3.0F, 4.0F, std::int32_t{473'977'420}, std::int32_t{85'455'940},
                         std::int32_t{488'000}, std::int32_t{536'000}, 0.3F, 0.9F, 1.5F, 1.0F, -2.0F, 0.5F, std::uint8_t{1},
                         static_cast<std::uint8_t>(receiver == 1 ? 6 : 3), std::uint8_t{14}, std::uint32_t{0}, std::uint8_t{0});
            log.data(3, t, 490.25F, 95'500.0F);
            log.data(5, t, 1.0F, 0.0F, 0.0F, 0.0F);
        }
        if (i == 50) log.dropout(120);
    }
    return log;
}

TEST_F(AutopilotLogs, UlogGivesEveryInstrumentWithItsUnits) {
    WarningLog warnings;
    const StreamLog log = read("flight.ulg", sample_ulog().bytes(), warnings);
    EXPECT_TRUE(warnings.empty());
    const Stream* imu = log.find("imu");
    ASSERT_NE(imu, nullptr);
    ASSERT_EQ(imu->rows(), 100U);
    EXPECT_EQ(imu->time_ns[1] - imu->time_ns[0], 4'000'000);
    EXPECT_EQ(value_at(*imu, "gyro_x_rad_s", 7), static_cast<double>(gyro_of(7)));
    EXPECT_EQ(value_at(*imu, "accel_z_m_s2", 7), static_cast<double>(-9.81F));
    const Stream *first = log.find("gnss"), *second = log.find("gnss1");
    ASSERT_TRUE(first != nullptr && second != nullptr) << "two receivers";
    EXPECT_NEAR(value_at(*first, "lat_deg", 0), 47.397742, 1e-12);
    EXPECT_EQ(value_at(*first, "height_ellipsoidal_m", 0), 536.0);
    EXPECT_EQ(value_at(*first, "vel_e_m_s", 0), -2.0);
    EXPECT_EQ(value_at(*first, "std_vel_m_s", 0), static_cast<double>(0.3F));
    EXPECT_EQ(first->fix.at(0), FixType::RtkFixed);
    EXPECT_EQ(second->fix.at(0), FixType::Autonomous);
    EXPECT_EQ(value_at(*log.find("baro"), "pressure_pa", 0), 95'500.0);
    ASSERT_NE(log.find("reference"), nullptr);
    EXPECT_EQ(log.find("reference")->source, "vehicle_attitude, vehicle_local_position, vehicle_global_position");
    EXPECT_EQ(log.streams.size(), 5U) << "a setpoint is nothing measured";
    ASSERT_EQ(log.contents.size(), 1U);
    expect_parts(log.contents[0], {"1 drop-out", "0.12 s"});
}

TEST_F(AutopilotLogs, DamageCostsItselfAndIsTold) {
    const std::string whole = sample_ulog().bytes();
    WarningLog cut_warnings, damage_warnings;
    const StreamLog cut = read("cut.ulg", whole.substr(0, whole.size() * 2 / 3), cut_warnings);
    EXPECT_GT(cut.find("imu")->rows(), 55U);
    EXPECT_LT(cut.find("imu")->rows(), 75U);
    ASSERT_EQ(cut_warnings.summary().size(), 1U);
    expect_parts(cut_warnings.summary()[0], {"cut.ulg", "cut in the message at byte"});
    std::string damaged = whole;
    for (std::size_t i = 0; i < 60; ++i) damaged[whole.size() / 2 + i] = '\xff';
    const StreamLog rest = read("damaged.ulg", damaged, damage_warnings);
    EXPECT_GT(rest.find("imu")->rows(), 90U);
    expect_parts(damage_warnings.summary().at(0), {"damaged.ulg", "at byte"});
    EXPECT_EQ(rest.find("imu")->time_ns.back(), read("whole.ulg", whole, damage_warnings).find("imu")->time_ns.back());
    const auto empty = write("empty.ulg", whole.substr(0, 70));
    expect_parts(message_of([&] {
                     WarningLog w;
                     (void)format_of(empty)->read(TextInput(empty), w);
                 }),
                 {"empty.ulg", "holds no instrument"});
}

TEST_F(AutopilotLogs, SingleSensorsAreOneImuAtTheGyroscopesTimes) {
    test::Ulog log;
    log.define("sensor_gyro:uint64_t timestamp;float x;float y;float z;");
    log.define("sensor_accel:uint64_t timestamp;float x;float y;float z;");
    log.subscribe(0, 0, "sensor_gyro");
    log.subscribe(0, 1, "sensor_accel");
    for (std::uint64_t i = 0; i < 50; ++i) {
        log.data(0, 1000 * i, 0.1F, 0.2F, 0.3F);
        log.data(1, 1000 * i + 500, static_cast<float>(i), 0.0F, -9.8F);
    }
    WarningLog warnings;
    const StreamLog read_log = read("raw.ulg", log.bytes(), warnings);
    const Stream* imu = read_log.find("imu_raw");
    ASSERT_NE(imu, nullptr);
    EXPECT_NEAR(value_at(*imu, "accel_x_m_s2", 10), 9.5, 1e-9) << "half way between the two samples around it";
}

std::string sample_dataflash() {
    test::Dataflash log;
    log.define(1, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
    log.define(2, "GPS", "QBBIHBcLLeffff", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw");
    log.define(3, "GPA", "QBCCCC", "TimeUS,I,VDop,HAcc,VAcc,SAcc");
    log.define(4, "MAG", "QBhhh", "TimeUS,I,MagX,MagY,MagZ");
    log.define(5, "BARO", "QBff", "TimeUS,I,Alt,Press");
    log.define(6, "ATT", "Qcccc", "TimeUS,DesRoll,Roll,Pitch,Yaw");
    for (std::uint64_t i = 0; i < 100; ++i) {
        const std::uint64_t t = 1'000'000 + 20'000 * i;
        for (std::uint8_t unit = 0; unit < 2; ++unit) log.data(1, t, unit, 0.1F, 0.2F, 0.3F, 1.0F, 2.0F, -9.8F);
        if (i % 10 != 0) continue;
        log.data(2, t, std::uint8_t{0}, std::uint8_t{6}, std::uint32_t{123'456}, std::uint16_t{2200}, std::uint8_t{17},
                 std::int16_t{70}, std::int32_t{-353'632'610}, std::int32_t{1'491'652'300}, std::int32_t{58'412}, 10.0F, 90.0F,
                 -1.5F, 0.0F);
        log.data(3, t, std::uint8_t{0}, std::uint16_t{120}, std::uint16_t{80}, std::uint16_t{150}, std::uint16_t{30});
        log.data(4, t, std::uint8_t{0}, std::int16_t{250}, std::int16_t{-30}, std::int16_t{400});
        log.data(5, t, std::uint8_t{0}, 12.5F, 94'500.0F);
        log.data(6, t, std::int16_t{500}, std::int16_t{150}, std::int16_t{-250}, std::int16_t{9000});
    }
    return log.bytes();
}

TEST_F(AutopilotLogs, DataflashGivesEveryInstrumentWithItsUnits) {
    WarningLog warnings;
    const StreamLog log = read("flight.bin", sample_dataflash(), warnings);
    EXPECT_TRUE(warnings.empty());
    ASSERT_TRUE(log.find("imu") != nullptr && log.find("imu1") != nullptr);
    EXPECT_EQ(log.find("imu1")->rows(), 100U);
    const Stream& gnss = *log.find("gnss");
    EXPECT_NEAR(value_at(gnss, "lat_deg", 0), -35.363261, 1e-12);
    EXPECT_NEAR(value_at(gnss, "height_msl_m", 0), 584.12, 1e-9);
    EXPECT_NEAR(value_at(gnss, "vel_e_m_s", 0), 10.0, 1e-6) << "speed and course";
    EXPECT_NEAR(value_at(gnss, "vel_n_m_s", 0), 0.0, 1e-6);
    EXPECT_NEAR(value_at(gnss, "std_h_m", 3), 0.8, 1e-9) << "of GPA";
    EXPECT_EQ(gnss.fix.at(0), FixType::RtkFixed);
    EXPECT_NEAR(value_at(*log.find("mag"), "mag_x_ut", 0), 25.0, 1e-9) << "milligauss";
    EXPECT_NEAR(value_at(*log.find("reference"), "onboard_roll_deg", 0), 1.5, 1e-9) << "not the angle that was asked for";
    EXPECT_NEAR(value_at(*log.find("reference"), "onboard_heading_deg", 0), 90.0, 1e-9);
}

/// Und is the height above mean sea level less that above the ellipsoid; zero before the receiver gives it.
TEST_F(AutopilotLogs, TheUndulationOfDataflashGivesEllipsoidalHeights) {
    const auto flight = [](float undulation) {
        test::Dataflash log;
        log.define(2, "GPS", "QBBLLe", "TimeUS,I,Status,Lat,Lng,Alt");
        log.define(3, "GPA", "QBCf", "TimeUS,I,VDop,Und");
        log.define(4, "ATT", "Qccc", "TimeUS,Roll,Pitch,Yaw");
        log.define(5, "POS", "QLLf", "TimeUS,Lat,Lng,Alt");
        for (std::uint64_t i = 0; i < 50; ++i) {
            const std::uint64_t t = 1'000'000 + 200'000 * i;
            log.data(2, t, std::uint8_t{0}, std::uint8_t{6}, std::int32_t{-353'632'610}, std::int32_t{1'491'652'300},
                     std::int32_t{58'412});
            log.data(3, t + 100, std::uint8_t{0}, std::uint16_t{120}, i < 5 ? 0.0F : undulation);
            log.data(4, t, std::int16_t{150}, std::int16_t{-250}, std::int16_t{9000});
            log.data(5, t, std::int32_t{-353'632'610}, std::int32_t{1'491'652'300}, 584.0F);
        }
        return log.bytes();
    };
    WarningLog warnings;
    const StreamLog log = read("flight.bin", flight(-19.5F), warnings);
    const Stream& gnss = *log.find("gnss");
    ASSERT_NE(gnss.find("height_ellipsoidal_m"), nullptr);
    EXPECT_EQ(gnss.find("height_msl_m"), nullptr);
    for (const std::size_t i : {0U, 4U, 49U}) EXPECT_NEAR(value_at(gnss, "height_ellipsoidal_m", i), 603.62, 1e-9) << i;
    EXPECT_NEAR(value_at(*log.find("reference"), "onboard_height_m", 10), 603.5, 1e-9) << "on the same axis as the fixes";
    const StreamLog without = read("none.bin", flight(0.0F), warnings);
    EXPECT_NEAR(value_at(*without.find("gnss"), "height_msl_m", 10), 584.12, 1e-9) << "the receiver does not know it";
    EXPECT_NEAR(value_at(*without.find("reference"), "onboard_height_msl_m", 10), 584.0, 1e-9);
}

TEST_F(AutopilotLogs, ACutDataflashIsReadUpToThere) {
    const std::string whole = sample_dataflash();
    WarningLog warnings;
    EXPECT_EQ(read("cut.bin", whole.substr(0, whole.size() - 5), warnings).find("imu")->rows(), 100U);
    ASSERT_EQ(warnings.summary().size(), 1U);
    expect_parts(warnings.summary()[0], {"cut.bin", "is cut in the message at byte"});
}

/// Names beyond the 64 characters of a definition are not in the log; those before them are.
TEST_F(AutopilotLogs, AMessageWithMoreNumbersThanNamesIsRead) {
    test::Dataflash log;
    log.define(1, "IMU", "QBfffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
    for (std::uint64_t i = 0; i < 50; ++i)
        log.data(1, 1'000'000 + 20'000 * i, std::uint8_t{0}, 0.1F, 0.2F, 0.3F, 1.0F, 2.0F, -9.8F, 7.0F);
    WarningLog warnings;
    const StreamLog read_log = read("long.bin", log.bytes(), warnings);
    const Stream* imu = read_log.find("imu");
    ASSERT_NE(imu, nullptr);
    EXPECT_EQ(imu->rows(), 50U);
    EXPECT_NEAR(value_at(*imu, "accel_z_m_s2", 3), -9.8, 1e-6);
}

TEST_F(AutopilotLogs, DataflashAsTextIsTheSameLog) {
    WarningLog warnings;
    const StreamLog log = read(
        "flight.log",
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 1, 35, IMU, Qffffff, TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n"
        "FMT, 2, 35, IMU2, Qffffff, TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\nIMU, 1000000, 0.1, 0.2, 0.3, 1, 2, -9.8\nIMU2, 1000000, 0.5, 0.2, 0.3, 1, 2, -9.8\n"
        "IMU, 1020000, 0.1, 0.2\nIMU, 1040000, 0.4, 0.2, 0.3, 1, 2, -9.8\n",
        warnings);
    ASSERT_TRUE(log.find("imu") != nullptr && log.find("imu1") != nullptr);
    EXPECT_EQ(log.find("imu")->rows(), 2U);
    EXPECT_EQ(value_at(*log.find("imu1"), "gyro_x_rad_s", 0), 0.5);
    expect_parts(warnings.summary().at(0), {"flight.log", "line 6"});
}

TEST_F(AutopilotLogs, RealSamples) {
    SKIP_WITHOUT_DATA();
    const auto folder = test::data_folder() / "format_samples";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no format samples (set SCHULER_DATA to the folder of the data sets)";
    WarningLog warnings;
    const StreamLog ulog = format_named("ulog")->read(TextInput(folder / "px4/sample.ulg"), warnings);
    ASSERT_NE(ulog.find("imu"), nullptr);
    const StreamLog bin = format_named("dataflash")->read(TextInput(folder / "ardupilot/test.BIN"), warnings);
    EXPECT_FALSE(bin.streams.empty());
    for (const StreamLog* log : {&ulog, &bin}) {
        for (const Stream& s : log->streams) {
            if (s.kind != TableKind::Imu) continue;
            double norm = 0.0;
            for (std::size_t i = 0; i < s.rows(); ++i)
                norm +=
                    std::hypot(value_at(s, "accel_x_m_s2", i), value_at(s, "accel_y_m_s2", i), value_at(s, "accel_z_m_s2", i)) /
                    static_cast<double>(s.rows());
            EXPECT_NEAR(norm, units::g0, 2.0) << s.source << ": gravity is in it";
        }
    }
}

}  // namespace
}  // namespace schuler::io
