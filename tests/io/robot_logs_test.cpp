// Bags and databases of ROS, EuRoC and TUM: written here from their documents, and the real samples.
#include "schuler/core/units.h"
#include "schuler/io/container/compression.h"
#include "schuler/io/container/ros_messages.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <fmt/format.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;
using test::put;

class RobotLogs : public test::IoTest {
protected:
    static StreamLog read(const std::filesystem::path& file, WarningLog& warnings) {
        const Format* format = format_of(file);
        if (format == nullptr || format->read == nullptr) {
            ADD_FAILURE() << file << " was not recognised";
            return {};
        }
        return format->read(TextInput(file), warnings);
    }
};

std::string text(std::string_view value) {
    std::string out;
    put(out, static_cast<std::uint32_t>(value.size()));
    return out.append(value);
}

/// sensor_msgs/Imu of ROS 1, and of ROS 2 with its alignment.
std::string imu_message(RosLayout layout, std::uint32_t seconds, double gyro_x) {
    std::string m;
    if (layout == RosLayout::Packed) {
        put(m, std::uint32_t{7});
        put(m, seconds);
        put(m, std::uint32_t{500'000'000});
        m += text("imu_link");
    } else {
        m = std::string("\0\1\0\0", 4);
        put(m, seconds);
        put(m, std::uint32_t{500'000'000});
        m += text(std::string_view("imu_link\0", 9));
        while ((m.size() - 4) % 8 != 0) m += '\0';
    }
    for (int i = 0; i < 4 + 9; ++i) put(m, 0.25);
    for (const double v : {gyro_x, 0.2, 0.3}) put(m, v);
    for (int i = 0; i < 9; ++i) put(m, 0.0);
    for (const double v : {0.1, 0.2, 9.81}) put(m, v);
    for (int i = 0; i < 9; ++i) put(m, 0.0);
    return m;
}

std::string mcap_record(unsigned char op, const std::string& body) {
    std::string out(1, static_cast<char>(op));
    put(out, static_cast<std::uint64_t>(body.size()));
    return out + body;
}

std::string mcap_records(int messages) {
    std::string schema, channel;
    put(schema, std::uint16_t{1});
    schema += text("sensor_msgs/msg/Imu") + text("ros2msg") + text("");
    put(channel, std::uint16_t{3});
    put(channel, std::uint16_t{1});
    channel += text("/imu/data") + text("cdr");
    put(channel, std::uint32_t{0});
    std::string out = mcap_record(3, schema) + mcap_record(4, channel);
    for (int i = 0; i < messages; ++i) {
        std::string m;
        put(m, std::uint16_t{3});
        put(m, static_cast<std::uint32_t>(i));
        put(m, std::uint64_t{1});
        put(m, std::uint64_t{1});
        out += mcap_record(5, m + imu_message(RosLayout::Cdr, 1'700'000'000U + static_cast<std::uint32_t>(i), 0.1 * i));
    }
    return out;
}

std::string mcap_chunk(const std::string& records, const std::string& method) {
    std::string packed = records;
    if (method == "zstd") {
        packed.resize(ZSTD_compressBound(records.size()));
        packed.resize(ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 3));
    } else if (method == "lz4") {
        packed.resize(LZ4F_compressFrameBound(records.size(), nullptr));
        packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
    }
    std::string body;
    put(body, std::uint64_t{1});
    put(body, std::uint64_t{2});
    put(body, static_cast<std::uint64_t>(records.size()));
    put(body, test::crc32(records));
    body += text(method);
    put(body, static_cast<std::uint64_t>(packed.size()));
    return mcap_record(6, body + packed);
}

const std::string mcap_magic("\x89MCAP0\r\n", 8);

TEST_F(RobotLogs, McapPlainAndCompressedIsTheSameLog) {
    const std::string records = mcap_records(40);
    for (const char* method : {"", "zstd", "lz4"}) {
        WarningLog warnings;
        const auto file = write("log.mcap", mcap_magic + mcap_record(1, text("ros2") + text("test")) +
                                                mcap_chunk(records, method) + mcap_record(15, std::string(4, '\0')));
        const StreamLog log = read(file, warnings);
        EXPECT_TRUE(warnings.empty()) << method;
        EXPECT_EQ(log.clock, Clock::Unix);
        const Stream* imu = log.find("imu");
        ASSERT_NE(imu, nullptr) << method;
        ASSERT_EQ(imu->rows(), 40U) << method;
        EXPECT_EQ(imu->source, "/imu/data");
        EXPECT_EQ(imu->time_ns[1], 1'700'000'001'500'000'000) << "of the header";
        EXPECT_DOUBLE_EQ(imu->find("gyro_x_rad_s")->values[3], 0.3);
        EXPECT_EQ(imu->find("accel_z_m_s2")->values[3], 9.81);
    }
    const auto cut = write("cut.mcap", (mcap_magic + mcap_record(1, text("ros2") + text("test")) + records).substr(0, 4000));
    WarningLog warnings;
    EXPECT_GT(read(cut, warnings).find("imu")->rows(), 3U);
    expect_parts(warnings.summary().at(0), {"cut.mcap", "at byte"});
    std::string chunk = mcap_chunk(records, "zstd");
    for (std::size_t i = 53; i < 140; ++i) chunk[i] = 'x';
    const auto partly = write("partly.mcap", mcap_magic + mcap_chunk(records, "lz4") + chunk + mcap_chunk(records, "zstd"));
    WarningLog told;
    EXPECT_EQ(read(partly, told).find("imu")->rows(), 80U) << "a damaged chunk costs itself";
    expect_parts(told.summary().at(0), {"partly.mcap", "damaged", "at byte"});
    const auto damaged = write("damaged.mcap", mcap_magic + chunk);
    expect_parts(message_of([&] { (void)read(damaged, warnings); }), {"damaged.mcap", "damaged", "at byte 8"});
}

TEST_F(RobotLogs, DatabaseOfRos2) {
    const auto file = folder() / "log.db3";
    sqlite3* db = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
    sqlite3_exec(
        db,
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
        "INSERT INTO topics VALUES(5,'/imu','sensor_msgs/msg/Imu','cdr');INSERT INTO topics VALUES(6,'/rosout','rcl_interfaces/msg/Log','cdr');",
        nullptr, nullptr, nullptr);
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1, &insert, nullptr);
    for (int i = 0; i < 10; ++i) {
        const std::string m = i == 4 ? std::string("\0\1\0\0x", 5) : imu_message(RosLayout::Cdr, 1'700'000'000, i);
        sqlite3_bind_int(insert, 1, 5);
        sqlite3_bind_int64(insert, 2, i);
        sqlite3_bind_blob(insert, 3, m.data(), static_cast<int>(m.size()), SQLITE_TRANSIENT);
        sqlite3_step(insert);
        sqlite3_reset(insert);
    }
    sqlite3_finalize(insert);
    sqlite3_close(db);
    WarningLog warnings;
    const StreamLog log = read(file, warnings);
    EXPECT_EQ(log.find("imu")->rows(), 9U);
    expect_parts(warnings.summary().at(0), {"log.db3", "damaged messages"});
    const auto packed_file = write_gz("log.db3.gz", content_of(file));
    WarningLog packed;
    EXPECT_EQ(read(packed_file, packed).find("imu")->rows(), 9U);
    expect_parts(packed.summary().at(0), {"log.db3.gz", "damaged messages"});
}

TEST_F(RobotLogs, BagOfRos1) {
    const auto record = [](const std::vector<std::pair<std::string, std::string>>& fields, const std::string& data) {
        std::string header;
        for (const auto& [name, value] : fields) header += text(name + "=" + value);
        return text(header) + text(data);
    };
    std::string number;
    put(number, std::uint32_t{2});
    std::string inner = text("topic=/imu") + text("type=sensor_msgs/Imu");
    std::string records = record({{"op", "\x07"}, {"conn", number}, {"topic", "/imu"}}, inner);
    for (int i = 0; i < 5; ++i)
        records += record({{"op", "\x02"}, {"conn", number}, {"time", std::string(8, '\1')}},
                          imu_message(RosLayout::Packed, 1'600'000'000, i));
    std::string packed(LZ4F_compressFrameBound(records.size(), nullptr), '\0'), size;
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
    put(size, static_cast<std::uint32_t>(records.size()));
    const auto file = write("log.bag", "#ROSBAG V2.0\n" + record({{"op", "\x03"}}, "") +
                                           record({{"op", "\x05"}, {"compression", "lz4"}, {"size", size}}, packed));
    WarningLog warnings;
    const StreamLog log = read(file, warnings);
    ASSERT_NE(log.find("imu"), nullptr);
    EXPECT_EQ(log.find("imu")->rows(), 5U);
    EXPECT_EQ(log.find("imu")->find("gyro_x_rad_s")->values[4], 4.0);
    const auto chunk = [&](const std::string& content) {
        return record({{"op", "\x05"}, {"compression", "lz4"}, {"size", size}}, content);
    };
    const std::string start = "#ROSBAG V2.0\n" + record({{"op", "\x03"}}, ""), broken(packed.size(), 'x');
    WarningLog damage;
    EXPECT_EQ(read(write("partly.bag", start + chunk(packed) + chunk(broken) + chunk(packed)), damage).find("imu")->rows(), 10U);
    ASSERT_EQ(damage.summary().size(), 1U);
    expect_parts(damage.summary()[0],
                 {"partly.bag", "damaged chunks", fmt::format("at byte {}", (start + chunk(packed)).size())});
    const auto all = write("damaged.bag", start + chunk(broken));
    expect_parts(message_of([&] { (void)read(all, damage); }), {"damaged.bag", "nothing of use is left"});
}

std::string packed_header(int k) {  // ROS 1, 5 Hz
    std::string m;
    put(m, std::uint32_t{1});
    put(m, static_cast<std::uint32_t>(1'600'000'000 + k / 5));
    put(m, static_cast<std::uint32_t>(200'000'000 * (k % 5)));
    return m + text("gps");
}

/// Fixes of a way at some speeds east and north from 60 deg north, and velocities (x, y, z) with their stamps.
StreamLog way_with_twist(std::array<double, 2> east_north, std::array<double, 3> twist, const char* type, WarningLog& warnings) {
    constexpr double radius = 6.378e6, latitude = 60.0;
    RosMessages messages;
    for (int k = 0; k < 60; ++k) {
        std::string fix = packed_header(k);
        put(fix, std::int8_t{0});
        put(fix, std::uint16_t{1});
        put(fix, latitude + 0.2 * k * east_north[1] / radius / units::deg);
        put(fix, 10.0 + 0.2 * k * east_north[0] / (0.5 * radius) / units::deg);
        put(fix, 100.0);
        for (const double c : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 4.0}) put(fix, c);
        put(fix, std::uint8_t{2});
        messages.add("/fix", "sensor_msgs/NavSatFix", RosLayout::Packed, fix, 0);
        if (k == 7) continue;                                    // one is lost
        std::string velocity = packed_header(k == 9 ? 500 : k);  // and one is stamped far ahead
        for (const double v : twist) put(velocity, v);
        for (int i = 0; i < 3; ++i) put(velocity, 0.0);
        for (int i = 0; i < 36; ++i) put(velocity, i % 7 != 0 ? 0.0 : i < 21 ? 0.01 : -1.0);
        messages.add("/vel", type, RosLayout::Packed, velocity, 0);
    }
    StreamLog log;
    messages.finish(log, "drive.bag", warnings);
    return log;
}

TEST_F(RobotLogs, TheTwistWithTheStampsOfFixesIsTheirVelocity) {
    WarningLog warnings;
    const StreamLog log = way_with_twist({-3.0, 4.0}, {-3.0, 4.0, 0.5}, "geometry_msgs/TwistWithCovarianceStamped", warnings);
    ASSERT_EQ(log.streams.size(), 1U) << "no stream of its own";
    const Stream& gnss = log.streams[0];
    ASSERT_NE(gnss.find("vel_n_m_s"), nullptr);
    EXPECT_EQ(gnss.find("vel_n_m_s")->values[3], 4.0);
    EXPECT_EQ(gnss.find("vel_e_m_s")->values[3], -3.0);
    EXPECT_EQ(gnss.find("vel_d_m_s")->values[3], -0.5);
    EXPECT_DOUBLE_EQ(gnss.find("std_vd_m_s")->values[3], 0.1);
    EXPECT_TRUE(std::isnan(gnss.find("vel_n_m_s")->values[7])) << "that one is lost";
    EXPECT_TRUE(std::isnan(gnss.find("vel_n_m_s")->values[9]));
    EXPECT_EQ(gnss.find("vel_n_m_s")->values[10], 4.0) << "those behind a wrong stamp are not";
    EXPECT_TRUE(warnings.empty());
    const StreamLog level = way_with_twist({-3.0, 4.0}, {-3.0, 4.0, 0.0}, "geometry_msgs/TwistStamped", warnings);
    EXPECT_NE(level.streams.at(0).find("vel_n_m_s"), nullptr);
    EXPECT_EQ(level.streams.at(0).find("vel_d_m_s"), nullptr) << "always 0: not measured";
    EXPECT_EQ(level.streams.at(0).find("std_vn_m_s"), nullptr);
}

TEST_F(RobotLogs, ATwistInTheVehiclesAxesIsNot) {
    WarningLog warnings;
    const StreamLog log = way_with_twist({-3.0, 4.0}, {5.0, 0.0, 0.0}, "geometry_msgs/TwistStamped", warnings);
    EXPECT_EQ(log.streams.at(0).find("vel_n_m_s"), nullptr);
    expect_parts(warnings.summary().at(0), {"drive.bag", "/vel", "/fix", "is not their velocity", "left out"});
    WarningLog slow;
    const StreamLog short_way = way_with_twist({0.0, 0.8}, {0.8, 0.0, 0.0}, "geometry_msgs/TwistStamped", slow);
    EXPECT_EQ(short_way.streams.at(0).find("vel_e_m_s"), nullptr) << "10 m show nothing";
    expect_parts(slow.summary().at(0), {"does not show"});
}

TEST_F(RobotLogs, AGpsFixHoldsPositionAndVelocity) {
    RosMessages messages;
    for (int k = 0; k < 3; ++k) {
        std::string m = packed_header(k) + packed_header(k);
        put(m, std::uint16_t{9});
        put(m, std::uint32_t{2});  // a list
        for (const std::int32_t prn : {4, 7}) put(m, prn);
        put(m, std::uint16_t{12});
        for (int i = 0; i < 4; ++i) put(m, std::uint32_t{0});
        put(m, static_cast<std::int16_t>(k == 0 ? 18 : 20));
        for (int i = 0; i < 3; ++i) put(m, std::uint16_t{0});
        for (const double v : {52.0, 13.0, 80.0, 90.0, 2.0, k == 0 ? 0.0 : 0.25}) put(m, v);
        for (int i = 0; i < 9; ++i) put(m, 0.0);
        for (const double v : {0.0, 2.448, 3.92, 0.0, 0.196, 0.0, 0.0, 0.0, 0.0, 0.0}) put(m, v);
        for (int i = 0; i < 9; ++i) put(m, k == 2 && i % 4 == 0 ? 4.0 : 0.0);
        put(m, static_cast<std::uint8_t>(k == 2 ? 3 : 0));
        messages.add("/gps", k == 1 ? "gps_common/GPSFix" : "gps_msgs/msg/GPSFix", RosLayout::Packed, m, 0);
    }
    WarningLog warnings;
    StreamLog log;
    messages.finish(log, "drive.bag", warnings);
    ASSERT_EQ(log.streams.size(), 1U);
    const Stream& gnss = log.streams[0];
    ASSERT_EQ(gnss.rows(), 3U) << messages.damaged;
    const auto value = [&](const char* column, std::size_t row) { return gnss.find(column)->values[row]; };
    EXPECT_EQ(value("height_m", 1), 80.0);
    EXPECT_NEAR(value("vel_n_m_s", 0), 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(value("vel_e_m_s", 0), 2.0);
    EXPECT_EQ(value("vel_d_m_s", 1), -0.25);
    EXPECT_DOUBLE_EQ(value("std_n_m", 0), 1.0) << "95 % in the plane";
    EXPECT_DOUBLE_EQ(value("std_d_m", 0), 2.0) << "95 % of one component";
    EXPECT_EQ(value("std_n_m", 2), 2.0) << "the covariance says more";
    EXPECT_DOUBLE_EQ(value("std_vn_m_s", 0), 0.1);
    EXPECT_EQ(gnss.find("std_vd_m_s"), nullptr) << "not stated";
    EXPECT_EQ(value("satellites", 0), 9.0);
    EXPECT_EQ(gnss.fix[0], FixType::Differential);
    EXPECT_EQ(gnss.fix[1], FixType::RtkFloat);
}

TEST_F(RobotLogs, WhatAnImuDoesNotMeasureIsNotZero) {
    RosMessages messages;
    std::string attitude = imu_message(RosLayout::Packed, 1'600'000'000, 0.0);
    const double none = -1.0;
    attitude.replace(attitude.size() - 8 * 9, 8, reinterpret_cast<const char*>(&none), 8);  // of the accelerometers
    messages.add("/imu", "sensor_msgs/Imu", RosLayout::Packed, attitude, 0);
    WarningLog warnings;
    StreamLog log;
    messages.finish(log, "drive.bag", warnings);
    EXPECT_TRUE(log.streams.empty());
    expect_parts(warnings.summary().at(0), {"drive.bag", "/imu", "-1"});
}

/// An Imu whose gyros or accelerometers are zero, or marked as not measured.
std::string half_imu(std::uint32_t seconds, bool rates, bool marked) {
    std::string m = imu_message(RosLayout::Packed, seconds, 0.5);
    const std::size_t forces_at = m.size() - 8 * 12, rates_at = forces_at - 8 * 12, idle = rates ? forces_at : rates_at;
    m.replace(idle, 8 * 3, std::string(8 * 3, '\0'));
    const double none = -1.0;
    if (marked) m.replace(idle + 8 * 3, 8, reinterpret_cast<const char*>(&none), 8);
    return m;
}

TEST_F(RobotLogs, GyrosAndAccelerometersPublishedApartAreOneUnit) {
    for (const bool marked : {false, true}) {
        RosMessages messages;
        for (std::uint32_t i = 0; i < 10; ++i) {
            messages.add("/camera/accel/sample", "sensor_msgs/Imu", RosLayout::Packed, half_imu(100 + i, false, marked), 0);
            messages.add("/camera/gyro/sample", "sensor_msgs/Imu", RosLayout::Packed, half_imu(100 + i, true, marked), 0);
        }
        WarningLog warnings;
        StreamLog log;
        messages.finish(log, "drive.bag", warnings);
        EXPECT_TRUE(warnings.empty());
        ASSERT_EQ(log.streams.size(), 1U);
        expect_parts(log.streams[0].source, {"/camera/gyro/sample with /camera/accel/sample"});
        ASSERT_EQ(log.streams[0].rows(), 10U);
        EXPECT_EQ(log.streams[0].find("gyro_x_rad_s")->values[4], 0.5);
        EXPECT_EQ(log.streams[0].find("accel_z_m_s2")->values[4], 9.81);
    }
}

TEST_F(RobotLogs, AHalfUnitBesideAWholeOneIsLeftOut) {
    for (const bool whole : {true, false}) {
        RosMessages messages;
        for (std::uint32_t i = 0; i < 10; ++i) {
            messages.add("/a", "sensor_msgs/Imu", RosLayout::Packed, half_imu(100 + i, false, false), 0);
            if (whole) messages.add("/b", "sensor_msgs/Imu", RosLayout::Packed, imu_message(RosLayout::Packed, 100 + i, 0.5), 0);
        }
        WarningLog warnings;
        StreamLog log;
        messages.finish(log, "drive.bag", warnings);
        ASSERT_EQ(log.streams.size(), 1U);
        EXPECT_EQ(log.streams[0].source, whole ? "/b" : "/a");
        expect_parts(warnings.summary().at(0), {"drive.bag", "/a", "angular rates are all zero"});
    }
}

TEST_F(RobotLogs, DecompressionNeverTrustsASize) {
    std::string packed(ZSTD_compressBound(1000), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), std::string(1000, 'a').data(), 1000, 1));
    EXPECT_EQ(decompressed(packed, "zstd", 10), std::string(1000, 'a'));
    EXPECT_EQ(decompressed(packed, "zstd", std::size_t{1} << 60), std::string(1000, 'a'));
    expect_parts(message_of([&] { (void)decompressed(packed.substr(0, packed.size() - 3), "zstd", 1000); }), {"zstd", "damaged"});
    expect_parts(message_of([&] { (void)decompressed("x", "brotli", 1); }), {"brotli", "zstd, lz4"});
}

TEST_F(RobotLogs, ATrajectoryIsNeverAnImu) {
    std::string tum, euroc = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";
    for (int i = 0; i < 100; ++i) {
        // the last three columns have the norm of gravity over one step: what once was taken for increments
        const double a = 0.049;
        tum += fmt::format("{}.{:02} {} {} {} {} {} {} {}\n", 1700000000 + i / 100, i % 100, 0.1 * i, 2.0, 3.0,
                           std::sqrt(1.0 - 3.0 * a * a), a, a, a);
        euroc += fmt::format("{},{},{},{},{},{},{},{}\n", 1403715524907143168LL + 5'000'000LL * i, 0.1 * i, 2.0, 3.0, 1.0, 0.0,
                             0.0, 0.0);
    }
    WarningLog warnings;
    for (const auto& [name, content, format] : {std::tuple("a.txt", tum, "tum"), std::tuple("b.csv", euroc, "euroc")}) {
        const auto file = write(name, content);
        ASSERT_NE(format_of(file), nullptr);
        EXPECT_EQ(format_of(file)->name, format);
        const StreamLog log = read(file, warnings);
        EXPECT_TRUE(log.streams.at(0).own_frame);
        EXPECT_EQ(log.streams.at(0).rows(), 100U);
    }
}

TEST_F(RobotLogs, ATrajectoryCutInItsLastNumberIsTold) {
    std::string tum,
        euroc = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], b []\n";
    for (int i = 0; i < 20; ++i) {
        tum += fmt::format("{:.2f} {:.3e} 2.000e+00 3.000e+00 0.000e+00 0.000e+00 0.000e+00 1.000e+00\n", 100.0 + i, 0.1 * i);
        euroc += fmt::format("{},{:.6f},2.000000,3.000000,1.000000,0.000000,0.000000,0.000000,0.{:06}\n",
                             1403715524907143168LL + 5'000'000LL * i, 0.1 * i, 39'000 + i);
    }
    for (const auto& [name, content, line] : {std::tuple("a.txt", tum, "line 20"), std::tuple("b.csv", euroc, "line 21")}) {
        WarningLog whole;
        EXPECT_EQ(read(write(name, content.substr(0, content.size() - 1)), whole).streams.at(0).rows(), 20U);
        EXPECT_TRUE(whole.empty()) << "only the line end is missing";
        for (const std::size_t lost : {2U, 3U, 10U}) {
            WarningLog warnings;
            EXPECT_EQ(read(write(name, content.substr(0, content.size() - lost)), warnings).streams.at(0).rows(), 19U) << lost;
            ASSERT_EQ(warnings.summary().size(), 1U) << name << lost;
            expect_parts(warnings.summary().at(0), {name, line});
        }
    }
}

TEST_F(RobotLogs, RealSamples) {
    SKIP_WITHOUT_DATA();
    const auto folder = test::data_folder() / "format_samples";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no format samples (set SCHULER_DATA to the folder of the data sets)";
    WarningLog warnings;
    EXPECT_NE(read(folder / "ros/rosbag2_test_0.db3", warnings).find("imu"), nullptr);
    EXPECT_FALSE(read(folder / "ros/nav2_turtlebot.mcap", warnings).streams.empty());
    EXPECT_FALSE(read(folder / "ros/ROS_example.bag", warnings).streams.empty());
    EXPECT_TRUE(read(folder / "tum/georeferenced.tum", warnings).streams.at(0).own_frame);
    EXPECT_TRUE(read(folder / "euroc/V102_groundtruth.csv", warnings).streams.at(0).own_frame);
}

}  // namespace
}  // namespace schuler::io
