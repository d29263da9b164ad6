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

/// A message of class NAV.
std::string ubx_frame(char kind, const std::string& payload) {
    const std::string message =
        std::string{'\x01', kind, static_cast<char>(payload.size() & 0xff), static_cast<char>(payload.size() >> 8)} + payload;
    unsigned a = 0, b = 0;
    for (const char c : message) {
        a = (a + static_cast<unsigned char>(c)) & 0xffU;
        b = (b + a) & 0xffU;
    }
    return "\xb5\x62" + message + static_cast<char>(a) + static_cast<char>(b);
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
    return ubx_frame('\x07', payload);
}

struct Sat {
    int system, number, cn0, elevation, azimuth;
    bool used;
};

/// NAV-SAT.
std::string nav_sat(const std::vector<Sat>& all) {
    std::string payload(8, '\0');
    payload[4] = 1;
    payload[5] = static_cast<char>(all.size());
    for (const Sat& s : all) {
        payload += {static_cast<char>(s.system),    static_cast<char>(s.number),         static_cast<char>(s.cn0),
                    static_cast<char>(s.elevation), static_cast<char>(s.azimuth & 0xff), static_cast<char>(s.azimuth >> 8)};
        payload += {0, 0, static_cast<char>(s.used ? 0x1f : 0x17), 0, 0, 0};
    }
    return ubx_frame('\x35', payload);
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

/// Time since power-on and GPS time (0: none yet) of an IMU message, with the fix last received.
std::string vectornav(int k, std::uint64_t gps, bool has_gps_field, double lat = 0.0) {
    io::test::VectorNav m;
    m.field(0, 0, static_cast<std::uint64_t>(k) * 10'000'000);
    if (has_gps_field) m.field(0, 1, gps);
    m.field(0, 9, 0.0F, 0.0F, -9.8F, 0.01F, 0.02F, 0.03F);
    if (lat != 0.0) {
        m.field(3, 1, std::uint64_t{400'000'000'000} + static_cast<std::uint64_t>(lat * 1e9)).field(3, 2, std::uint16_t{2200});
        m.field(3, 4, static_cast<unsigned char>(3)).field(3, 5, lat, 11.0, 500.0);
    }
    return m.message();
}

TEST(LiveDecoder, VectorNavInPieces) {
    constexpr std::uint64_t begin = 1'330'560'400'000'000'000;  // week 2200, 400 000 s
    std::string compensated =
        io::test::VectorNav().field(0, 1, begin).field(0, 5, 9.0F, 9.0F, 9.0F).field(0, 8, 1.0F, 1.0F, 1.0F).message();
    std::string damaged = vectornav(9, begin, true);
    damaged[30] ^= 1;
    const std::string stream = vectornav(0, 0, true) + vectornav(1, begin + 10'000'000, true, 1.0) + "$VNINS,1,2*5A\r\n\xfa\xfa" +
                               compensated + vectornav(2, begin + 20'000'000, true, 1.0) + damaged +
                               vectornav(3, begin + 30'000'000, true, 2.0);
    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, stream.size()}) {
        const auto decoder = make_decoder(StreamFormat::Vectornav, Instrument::Imu, {});
        std::vector<std::int64_t> imu, fixes;
        for (const Sample& s : decoded(*decoder, stream, size)) {
            if (const auto* i = std::get_if<ImuSample>(&s)) imu.push_back(i->time.ns - static_cast<std::int64_t>(begin));
            if (const auto* f = std::get_if<GnssFix>(&s)) fixes.push_back(f->time.ns - static_cast<std::int64_t>(begin));
        }
        EXPECT_EQ(imu, (std::vector<std::int64_t>{10'000'000, 20'000'000, 30'000'000}))
            << "one source of inertial data, GPS time";
        EXPECT_EQ(fixes, (std::vector<std::int64_t>{1'000'000'000, 2'000'000'000})) << "each once, at the receiver's time";
        EXPECT_GE(decoder->counters().garbage, 1U);
        ASSERT_EQ(decoder->counters().warnings.size(), 1U);
    }
    const auto decoder = make_decoder(StreamFormat::Vectornav, Instrument::Imu, {});
    const std::vector<Sample> alone = decoded(*decoder, vectornav(5, 0, false) + vectornav(6, 0, false, 1.0), 5);
    ASSERT_EQ(alone.size(), 3U) << "a unit without GPS time";
    EXPECT_EQ(std::get<ImuSample>(alone[0]).time.ns, 50'000'000);
    EXPECT_EQ(std::get<GnssFix>(alone[2]).time.ns, 60'000'000) << "that of its message";
    EXPECT_TRUE(decoder->counters().warnings.empty());
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
        "{\"type\":\"heading\",\"time_s\":2,\"heading_deg\":90}\n"
        "{\"type\":\"gauges\",\"time_s\":3,\"height_m\":[-12.5,null]}\n"
        "{\"type\":\"log\",\"time_s\":4,\"velocity_m_s\":[2,0.5,-0.25]}\n",
        3);
    ASSERT_EQ(lines.size(), 4u);
    EXPECT_EQ(std::get<GaugeSample>(lines[2]).height.x(), -12.5);
    EXPECT_TRUE(std::isnan(std::get<GaugeSample>(lines[2]).height.y()));
    EXPECT_EQ(std::get<BodyVelocitySample>(lines[3]).velocity_b, Eigen::Vector3d(2.0, 0.5, -0.25));
    const std::vector<Sample> heights =
        decoded(*make_decoder(StreamFormat::Csv, Instrument::Gauges, {}), "time_s,height_1_m,height_2_m\n1,-3,-4\n", 5);
    ASSERT_EQ(heights.size(), 1u);
    EXPECT_EQ(std::get<GaugeSample>(heights[0]).height.head<2>(), Eigen::Vector2d(-3.0, -4.0));
    const std::vector<Sample> velocities =
        decoded(*make_decoder(StreamFormat::Csv, Instrument::Log, {}), "time_s,vel_x_m_s,vel_y_m_s,vel_z_m_s\n1,2,0,0.1\n", 5);
    ASSERT_EQ(velocities.size(), 1u);
    EXPECT_EQ(std::get<BodyVelocitySample>(velocities[0]).velocity_b, Eigen::Vector3d(2.0, 0.0, 0.1));
    EXPECT_EQ(std::get<ImuSample>(lines[0]).time.ns, 123456789012345678);
    EXPECT_TRUE(std::isnan(std::get<ImuSample>(lines[0]).accel.z()));
    EXPECT_NEAR(std::get<HeadingSample>(lines[1]).heading, 90.0 * units::deg, 1e-15);
    EXPECT_EQ(json->counters().garbage, 2u);
}

/// "G05 30/120 44 used" in order; "-" for what is not given.
std::vector<std::string> satellites_of(Decoder& decoder) {
    std::vector<std::string> out;
    const auto all = decoder.satellites().renewed();
    if (!all) return {"nothing new"};
    const auto text = [](double x, double unit) { return std::isfinite(x) ? fmt::format("{:.0f}", x / unit) : "-"; };
    for (const SatelliteSeen& s : *all)
        out.push_back(fmt::format("{} {}/{} {}{}", gnss::name_of(s.id), text(s.elevation, units::deg),
                                  text(s.azimuth, units::deg), text(s.cn0, 1.0), s.used ? " used" : ""));
    return out;
}

std::string epoch_of(int second, const std::string& more) {
    return sentence(fmt::format("GNRMC,12000{}.00,A,4800.0000,N,01100.0000,E,1.00,90.00,010524,,,A", second)) + more;
}

using Names = std::vector<std::string>;

TEST(LiveSatellites, SentencesOfSeveralSystemsAndSignals) {
    const std::string sky =
        sentence("GNGSA,A,3,05,12,,,,,,,,,,,1.2,0.9,0.8,1") + sentence("GNGSA,A,3,70,,,,,,,,,,,,1.2,0.9,0.8,2") +
        sentence("GNGSA,A,3,11,,,,,,,,,,,,1.2,0.9,0.8,3") +
        sentence("GPGSV,2,1,05,05,30,120,44,12,,,20,33,10,200,,07,-1,010,1,1") + sentence("GPGSV,2,2,05,99,30,120,44,1") +
        sentence("GPGSV,1,1,01,05,30,120,47,6") + sentence("GLGSV,1,1,01,70,80,300,39,1") +
        sentence("GAGSV,1,1,01,11,05,359,,7") + "$GPGSV,1,1,01,31,05,359,,7*00\r\n";
    const Names expected{"G05 30/120 47 used", "G07 -1/10 1",      "G12 -/- 20 used",
                         "R06 80/300 39 used", "E11 5/359 - used", "S20 10/200 -"};
    for (const std::size_t size : {std::size_t{1}, std::size_t{50}, std::size_t{5000}}) {
        const auto decoder = make_decoder(StreamFormat::Nmea, Instrument::Gnss, {});
        EXPECT_EQ(decoded(*decoder, epoch_of(0, sky), size).size(), 1U);
        EXPECT_EQ(satellites_of(*decoder), expected);
        EXPECT_EQ(satellites_of(*decoder), Names{"nothing new"});
        // none of the second system is used, then it is silent; a sequence without one of its sentences does not count
        const std::string fewer = sentence("GNGSA,A,3,12,,,,,,,,,,,,1.2,0.9,0.8,1") +
                                  sentence("GNGSA,A,3,,,,,,,,,,,,,1.2,0.9,0.8,2") + sentence("GPGSV,2,2,05,31,30,120,44,1") +
                                  sentence("GPGSV,3,1,09,31,30,120,44,8") + sentence("GPGSV,3,3,09,30,30,120,44,8") +
                                  sentence("GPGSV,1,1,01,12,31,121,21,1");
        for (int k = 1; k < 9; ++k) {
            (void)decoded(*decoder, epoch_of(k, fewer), size);
            const Names now = satellites_of(*decoder);
            EXPECT_EQ(now.front(), k > 3 ? "G12 31/121 21 used" : "G05 30/120 47") << k;
            EXPECT_EQ(now.size(), k > 3 ? 1U : 4U) << k;
        }
    }
}

TEST(LiveSatellites, NumbersOfOlderReceivers) {
    const auto decoder = make_decoder(StreamFormat::Nmea, Instrument::Gnss, {});
    const std::string sky =
        sentence("GPGSA,A,3,05,40,193,,,,,,,,,,1.2,0.9,0.8") + sentence("GNGSA,A,3,88,301,401,,,,,,,,,,1.2,0.9,0.8") +
        sentence("GBGSV,1,1,02,214,45,100,40,03,20,90,30") + sentence("GPGSV,x,1,02,1") + sentence("GPGSV,1,0");
    (void)decoded(*decoder, epoch_of(0, sky), 7);
    EXPECT_EQ(satellites_of(*decoder), (Names{"G05 -/- - used", "R24 -/- - used", "E01 -/- - used", "C01 -/- - used",
                                              "C03 20/90 30", "C14 45/100 40", "J01 -/- - used", "S27 -/- - used"}));
}

TEST(LiveSatellites, UbxAlsoWithSentencesBetween) {
    const std::string stream =
        nav_pvt(1) + sentence("GPGSV,1,1,01,31,05,359,,7") +
        nav_sat(
            {{0, 5, 44, 30, 120, true}, {6, 255, 30, 10, 10, false}, {2, 11, 0, -91, 0, false}, {1, 123, 20, 33, 359, false}});
    std::string cut = nav_sat({{0, 9, 44, 30, 120, true}});
    cut[11] = 2;  // says two, has one; the checksum says so too
    for (const std::size_t size : {std::size_t{1}, stream.size()}) {
        const auto decoder = make_decoder(StreamFormat::Ubx, Instrument::Gnss, {});
        EXPECT_EQ(decoded(*decoder, stream, size).size(), 1U);
        EXPECT_EQ(satellites_of(*decoder), (Names{"G05 30/120 44 used", "E11 -/- -", "S23 33/359 20"}));
        (void)decoded(*decoder, cut + sentence("GPGSV,1,1,01,31,05,359,,7"), size);
        EXPECT_EQ(satellites_of(*decoder), Names{"nothing new"});
        (void)decoded(*decoder, nav_sat({}), size);
        EXPECT_EQ(satellites_of(*decoder), Names{});
    }
    const auto sentences = make_decoder(StreamFormat::Ubx, Instrument::Gnss, {});
    (void)decoded(*sentences, sentence("GPGSV,1,1,01,31,05,359,,7"), 9);
    EXPECT_EQ(satellites_of(*sentences), Names{"G31 5/359 -"});
}

TEST(LiveSatellites, SkyReportsOfGpsd) {
    const auto decoder = make_decoder(StreamFormat::Gpsd, Instrument::Gnss, {});
    (void)decoded(*decoder,
                  R"({"class":"SKY","satellites":[{"PRN":5,"el":30.0,"az":120.0,"ss":44.0,"used":true,"gnssid":0,"svid":5},)"
                  R"({"PRN":70,"ss":0,"used":false,"gnssid":6,"svid":6},{"gnssid":1e300,"svid":-3},7]})"
                  "\n{\"class\":\"SKY\",\"hdop\":1.0}\n",
                  11);
    EXPECT_EQ(satellites_of(*decoder), (Names{"G05 30/120 44 used", "R06 -/- -"}));
    EXPECT_EQ(decoder->counters().garbage, 0U);
}

TEST(LiveMessage, SatellitesAsJson) {
    EXPECT_EQ(
        satellites_json(
            12.5, {{{gnss::System::Gps, 5}, 30.0 * units::deg, 120.0 * units::deg, 44.0, true}, {{gnss::System::Glonass, 6}}}),
        "{\"type\":\"satellites\",\"time_s\":12.500,\"satellites\":[{\"name\":\"G05\",\"elevation_deg\":30,\"azimuth_deg\":120,"
        "\"cn0_db_hz\":44,\"used\":true},{\"name\":\"R06\",\"elevation_deg\":null,\"azimuth_deg\":null,\"cn0_db_hz\":null,"
        "\"used\":false}]}\n");
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
