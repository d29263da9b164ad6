// Streams cut anywhere and with garbage between the messages give the samples that whole files give.
#include "schuler/live/decoder.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/live/endpoint.h"
#include "schuler/live/message.h"

#include "io/log_bytes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace schuler::live {
namespace {

/// The stream in pieces of `size` bytes, with a pause at its end.
std::vector<Sample> decoded(Decoder& decoder, const std::string& bytes, std::size_t size) {
    std::vector<Sample> out;
    for (std::size_t i = 0; i < bytes.size(); i += size) decoder.take(std::string_view(bytes).substr(i, size), out);
    decoder.quiet(out);
    return out;
}

std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body) sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

/// NAV-PVT of a moment of 2024 at 48 deg, 11 deg.
std::string nav_pvt(int second) {
    std::string payload(92, '\0');
    const auto put = [&payload](std::size_t at, std::int64_t value, std::size_t bytes) {
        for (std::size_t i = 0; i < bytes; ++i)
            payload[at + i] = static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xffU);
    };
    put(0, 302'418'000 + 1000 * second, 4);
    put(4, 2024, 2);
    put(6, 5, 1);
    put(7, 1, 1);
    put(8, 12, 1);
    put(9, 0, 1);
    put(10, second, 1);
    put(11, 0x37, 1);  // date and time are valid and settled
    put(12, 20, 4);
    put(20, 3, 1);
    put(21, 1, 1);
    put(23, 12, 1);
    put(24, 110'000'000, 4);
    put(28, 480'000'000, 4);
    put(32, 500'000, 4);
    put(36, 453'000, 4);
    put(40, 900, 4);
    put(44, 1500, 4);
    std::string message = std::string("\x01\x07\x5c", 3) + '\0' + payload;
    unsigned a = 0, b = 0;
    for (const char c : message) {
        a = (a + static_cast<unsigned char>(c)) & 0xffU;
        b = (b + a) & 0xffU;
    }
    return "\xb5\x62" + message + static_cast<char>(a) + static_cast<char>(b);
}

TEST(LiveDecoder, UbxInPiecesWithGarbageBetween) {
    std::string damaged = nav_pvt(3);
    damaged[40] ^= 1;
    const std::string stream =
        nav_pvt(1) + "\x01\xb5\x00garbage" + sentence("GNTXT,01,01,02,hello") + nav_pvt(2) + damaged + nav_pvt(4);
    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, stream.size()}) {
        const auto decoder = make_decoder(StreamFormat::Ubx, Instrument::Gnss, {});
        const std::vector<Sample> samples = decoded(*decoder, stream, size);
        ASSERT_EQ(samples.size(), 3u) << size;
        const auto& fix = std::get<GnssFix>(samples[1]);
        EXPECT_NEAR(fix.position.lat, 48.0 * units::deg, 1e-12);
        EXPECT_NEAR((fix.time - std::get<GnssFix>(samples[0]).time).seconds(), 1.0, 1e-6);
        EXPECT_GE(decoder->counters().garbage, 2u);
    }
}

TEST(LiveDecoder, NmeaEpochsAreCompleteAtThePauseAndAtTheNext) {
    std::string stream;
    for (int k = 0; k < 3; ++k) {
        stream += sentence(fmt::format("GPRMC,12000{}.00,A,4800.0000,N,01100.0000,E,1.00,90.00,010524,,,A", k));
        stream += sentence(fmt::format("GPGGA,12000{}.00,4800.0000,N,01100.0000,E,1,09,0.9,453.0,M,47.0,M,,", k));
        stream += "$GPGGA,broken*00\r\n";
    }
    for (const std::size_t size : {std::size_t{1}, std::size_t{33}, stream.size()}) {
        const auto decoder = make_decoder(StreamFormat::Nmea, Instrument::Gnss, {});
        std::vector<Sample> early;
        for (std::size_t i = 0; i < stream.size(); i += size) decoder->take(std::string_view(stream).substr(i, size), early);
        EXPECT_EQ(early.size(), 2u);
        EXPECT_TRUE(decoder->waiting());
        decoder->quiet(early);
        ASSERT_EQ(early.size(), 3u);
        const auto& fix = std::get<GnssFix>(early[2]);
        EXPECT_NEAR(fix.position.h, 500.0, 1e-9);
        EXPECT_EQ(fix.time, gps_from_utc({2024, 5, 1, 12, 0, 2.0}));
        EXPECT_EQ(decoder->counters().garbage, 3u);
    }
}

std::string novatel(const std::string& name, double tow, const std::string& content) {
    const std::string log = fmt::format("{},COM1,0,83.5,FINESTEERING,2244,{:.3f},02000000,cdba,16809;{}", name, tow, content);
    return fmt::format("#{}*{:08x}\r\n", log, io::test::novatel_crc(log));
}
std::string novatel_position(const std::string& name, double tow, double lat) {
    return novatel(
        name, tow,
        fmt::format("SOL_COMPUTED,SINGLE,{},-114.0,1000.0,-16.0,WGS84,0.5,0.5,1.0,\"\",0.0,0.0,20,18,18,0,00,00,00,11", lat));
}

TEST(LiveDecoder, OfTheFixesOfOneNovatelTheBestKindIsTaken) {
    const auto decoder = make_decoder(StreamFormat::Novatel, Instrument::Gnss, {});
    const auto taken = [&](const std::string& bytes) {
        std::vector<double> lat;
        for (const Sample& s : decoded(*decoder, bytes, 100)) lat.push_back(std::get<GnssFix>(s).position.lat / units::deg);
        return lat;
    };
    const auto near = [](double lat) { return std::vector<double>{lat * units::deg / units::deg}; };
    EXPECT_EQ(taken(novatel_position("PSRPOSA", 100.0, 53.0)), near(53.0)) << "as long as nothing better comes";
    EXPECT_EQ(taken(novatel_position("BESTPOSA", 101.0, 51.0) + novatel_position("BESTGNSSPOSA", 101.0, 52.0) +
                    novatel_position("PSRPOSA", 101.0, 53.0)),
              near(52.0));
    EXPECT_TRUE(taken(novatel_position("BESTPOSA", 102.0, 51.0)).empty()) << "of the same receiver";
    EXPECT_EQ(taken(novatel_position("BESTPOSA", 120.0, 51.0)), near(51.0)) << "the better one comes no longer";
    EXPECT_TRUE(taken(novatel_position("PSRPOSA", 120.5, 53.0)).empty());
    EXPECT_EQ(taken(novatel_position("BESTGNSSPOSA", 121.0, 52.0)), near(52.0));
}

TEST(LiveDecoder, TheImuOfANovatelIsNamedOnce) {
    const auto raw = [](double t) { return novatel("RAWIMUA", t, fmt::format("2244,{},00000077,98067,0,0,0,0,0", t)); };
    const auto decoder = make_decoder(StreamFormat::Novatel, Instrument::Imu, {});
    EXPECT_TRUE(decoded(*decoder, raw(100.0), 100).empty());
    ASSERT_EQ(decoder->counters().warnings.size(), 1U) << "and it is told";
    EXPECT_NE(decoder->counters().warnings[0].find("does not state the type of its IMU"), std::string::npos);
    const std::string config = novatel("INSCONFIGA", 100.0, "HG4930_AN01,0,20,20,AUTOMOTIVE");
    std::string damaged = config;
    damaged[damaged.find("HG4930")] = 'X';
    EXPECT_TRUE(decoded(*decoder, config, 7).empty());
    EXPECT_TRUE(decoded(*decoder, damaged, 7).empty());
    for (const double t : {101.0, 102.0}) {
        const std::vector<Sample> samples = decoded(*decoder, raw(t), 7);
        ASSERT_EQ(samples.size(), 1U) << t;
        EXPECT_NEAR(std::get<ImuSample>(samples[0]).accel.z(), -98'067.0 * 0x1p-29, 1e-15);
    }
    EXPECT_EQ(decoder->counters().garbage, 1U);
    EXPECT_EQ(decoder->counters().warnings.size(), 1U);
}

TEST(LiveDecoder, RowsOfTablesAndLinesOfJson) {
    const std::string table =
        "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n"
        "1440437439.7495429,1,2,3,4,5,6\nnonsense\n1440437439.7595429,1,2,3,4,x,6\n1440437439.7695429,0.1,0.2,0.3,0,0,-9.81\n";
    const auto csv = make_decoder(StreamFormat::Csv, Instrument::Imu, {});
    const std::vector<Sample> rows = decoded(*csv, table, 5);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(std::get<ImuSample>(rows[0]).time.ns, 1440437439749542900);
    EXPECT_EQ(std::get<ImuSample>(rows[1]).accel.z(), -9.81);
    EXPECT_EQ(csv->counters().garbage, 2u);
    const auto json = make_decoder(StreamFormat::Json, Instrument::Imu, {});
    const std::vector<Sample> lines = decoded(
        *json,
        "{\"type\":\"imu\",\"time_ns\":123456789012345678,\"gyro_rad_s\":[1,2,3],\"accel_m_s2\":[4,5,null]}\r\n[1]\n{\"type\":\"x\"}\n"
        "{\"type\":\"heading\",\"time_s\":2,\"heading_deg\":90}\n",
        3);
    ASSERT_EQ(lines.size(), 2u);
    EXPECT_EQ(std::get<ImuSample>(lines[0]).time.ns, 123456789012345678);
    EXPECT_TRUE(std::isnan(std::get<ImuSample>(lines[0]).accel.z()));
    EXPECT_NEAR(std::get<HeadingSample>(lines[1]).heading, 90.0 * units::deg, 1e-15);
    EXPECT_EQ(json->counters().garbage, 2u);
}

TEST(LiveEndpoint, WhatAUserWrites) {
    const Endpoint serial = endpoint_from("serial:/dev/ttyUSB0?baud=460800", Direction::In, "imu.source");
    EXPECT_EQ(serial.path, "/dev/ttyUSB0");
    EXPECT_EQ(serial.baud, 460800);
    EXPECT_EQ(endpoint_from("tcp://[::1]:5000", Direction::In, "x").host, "::1");
    EXPECT_EQ(endpoint_from("gpsd://localhost", Direction::In, "x").port, "2947");
    for (const char* wrong : {"", "tcp://host", "tcp://:5000", "tcp://host:0", "udp://h:99999",
                              "serial:", "serial:/dev/x?baud=fast", "stdout", "ftp://h:1"})
        EXPECT_THROW((void)endpoint_from(wrong, Direction::In, "imu.source"), Error) << wrong;
    EXPECT_THROW((void)endpoint_from("udp://:5", Direction::Out, "output.to"), Error);
}

TEST(LiveMessage, NmeaOfAState) {
    SolutionRow row{gps_from_utc({2024, 5, 1, 12, 0, 1.996}),
                    {-0.5 * units::deg, 179.9999999 * units::deg, 12.5},
                    {0.0, -1.0, 0.0},
                    {0.0, 0.0, 1.5707963267948966},
                    {},
                    {},
                    {}};
    const std::string text = state_nmea(row);
    EXPECT_NE(text.find("$INGGA,120002.00,0030.0000000,S,17959.9999940,E,6,"), std::string::npos) << text;
    EXPECT_NE(text.find(",1.944,270.00,010524,"), std::string::npos) << text;
    EXPECT_NE(text.find("$INHDT,90.00,T*"), std::string::npos) << text;
}

}  // namespace
}  // namespace schuler::live
