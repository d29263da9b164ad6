// RTKLIB .pos files and NMEA logs.
#include "schuler/core/units.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/solution/rtklib_pos.h"

#include "io/io_fixture.h"

#include <GeographicLib/Geocentric.hpp>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

using units::deg;
constexpr double knot = 1852.0 / 3600.0;
// 2023-01-08 10:00:00 GPS time is second 36000 of week 2244.
constexpr std::int64_t ten = (std::int64_t{2244} * 604800 + 36000) * 1'000'000'000;

const std::string names =
    "  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio    "
    "vn(m/s)    "
    "ve(m/s)    vu(m/s)      sdvn     sdve     sdvu    sdvne    sdveu    sdvun\n";
const std::string values =
    "   30.123456789   95.987654321    -9.7500   5   8   2.5000   2.2500   7.1250   0.7500  -2.0000  -2.6250   0.00    0.0    "
    "0.01250    "
    "0.00450   -0.00325   0.14500  0.13500  0.44500  0.03900 -0.13000 -0.18\n";

class Pos : public test::IoTest {
protected:
    RtklibPos read(const std::string& text) { return read_rtklib_pos(TextInput::memory(text, "a.pos"), log); }
    WarningLog log;
};

void expect_first_fix(const GnssFix& f) {
    EXPECT_EQ(f.time.ns, ten);
    EXPECT_NEAR(f.position.lat, 30.123456789 * deg, 1e-11 * deg);
    EXPECT_NEAR(f.position.lon, 95.987654321 * deg, 1e-11 * deg);
    EXPECT_EQ(f.position.h, -9.75);
    EXPECT_EQ(f.fix, FixType::Autonomous);
    EXPECT_EQ(f.satellites, 8);
    EXPECT_EQ(f.std_position, Eigen::Vector3d(2.5, 2.25, 7.125));
    EXPECT_EQ(f.velocity_n, Eigen::Vector3d(0.0125, 0.0045, 0.00325));
    EXPECT_EQ(f.std_velocity, Eigen::Vector3d(0.145, 0.135, 0.445));
}

TEST_F(Pos, TimesOfAllSystems) {
    expect_first_fix(
        read("% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix)\n%  GPST" + names + "2023/01/08 10:00:00.000" + values).fixes.at(0));
    expect_first_fix(read("%  UTC " + names + "2023/01/08 09:59:42.000" + values).fixes.at(0));
    expect_first_fix(read("%  JST " + names + "2023/01/08 18:59:42.000" + values).fixes.at(0));
    expect_first_fix(read("%  GPST" + names + "2244  36000.000" + values).fixes.at(0));
    expect_first_fix(read("%  UTC " + names + "2244  35982.000" + values).fixes.at(0));
    EXPECT_EQ(read("%  GPST" + names + "2023/01/08 10:00:00.123456789" + values).fixes.at(0).time.ns, ten + 123456789);
    EXPECT_TRUE(log.empty());
}

TEST_F(Pos, HeightsAndSeparators) {
    EXPECT_EQ(read("% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix)\n%  GPST" + names + "2244 36000.0" + values).height,
              HeightKind::Ellipsoidal);
    EXPECT_EQ(read("% (lat/lon/height=WGS84/geodetic,Q=1:fix)\n%  GPST" + names + "2244 36000.0" + values).height,
              HeightKind::Msl);
    const RtklibPos comma = read(
        "%  GPST, latitude(deg),longitude(deg), height(m), Q, ns, sdn(m), sde(m), sdu(m), sdne(m), sdeu(m), sdun(m),age(s), "
        "ratio\n"
        "2023/01/08 10:00:00.000, 30.123456789, 95.987654321, -9.7500, 1, 8, 2.5000, 2.2500, 7.1250, 0.7500,-2.0000,-2.6250, "
        "0.00, 0.0\n");
    EXPECT_EQ(comma.fixes.at(0).time.ns, ten);
    EXPECT_EQ(comma.fixes.at(0).position.h, -9.75);
    EXPECT_EQ(comma.fixes.at(0).fix, FixType::RtkFixed);
    EXPECT_EQ(comma.fixes.at(0).std_position.z(), 7.125);
    EXPECT_TRUE(std::isnan(comma.fixes.at(0).velocity_n.x()));
}

TEST_F(Pos, DegreesMinutesSecondsSouthAndWestOfZero) {
    const std::string header =
        "%  GPST latitude(d'\") longitude(d'\") height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n";
    const RtklibPos p = read(header + "2244 36000.0 -0 30 36.0 -94 59 59.97412 5.5 2 7 1 2 3 0 0 0 0 0\n");
    EXPECT_NEAR(p.fixes.at(0).position.lat, -0.51 * deg, 1e-15);
    EXPECT_NEAR(p.fixes.at(0).position.lon, -(94.0 + 59.0 / 60.0 + 59.97412 / 3600.0) * deg, 1e-14);
    EXPECT_EQ(p.fixes.at(0).position.h, 5.5);
    EXPECT_EQ(p.fixes.at(0).satellites, 7);
}

TEST_F(Pos, EarthFixedSigmasAreTurned) {
    const RtklibPos p = read(
        "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) age(s) ratio vx(m/s) vy(m/s) "
        "vz(m/s)\n"
        "2244 36000.0 -480000.1250 5500000.2500 3180000.5000 5 8 2.2500 6.7500 3.5000 0.4500 3.9500 -0.3500 0.00 0.0 -0.5 0.25 "
        "1.0\n");
    const GnssFix& f = p.fixes.at(0);
    double lat, lon, h;
    GeographicLib::Geocentric::WGS84().Reverse(-480000.1250, 5500000.2500, 3180000.5000, lat, lon, h);
    EXPECT_NEAR(f.position.lat, lat * deg, 1e-14);
    EXPECT_NEAR(f.position.lon, lon * deg, 1e-14);
    EXPECT_NEAR(f.position.h, h, 1e-7);
    // GeographicLib's local axes (east, north, up) are the oracle: columns of M are the axes in Earth-fixed components.
    std::vector<double> m(9);
    double x, y, z;
    GeographicLib::Geocentric::WGS84().Forward(lat, lon, h, x, y, z, m);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> M(m.data());
    const Eigen::Matrix3d C = M;  // Earth-fixed from east-north-up
    const Eigen::Vector3d v = C.transpose() * Eigen::Vector3d(-0.5, 0.25, 1.0);
    EXPECT_LT((f.velocity_n - Eigen::Vector3d(v.y(), v.x(), -v.z())).norm(), 1e-12);
    Eigen::Matrix3d P;
    // clang-format off
    P << 2.25 * 2.25, 0.45 * 0.45, -0.35 * 0.35, 0.45 * 0.45, 6.75 * 6.75, 3.95 * 3.95, -0.35 * 0.35,
        3.95 * 3.95, 3.5 * 3.5;
    // clang-format on
    const Eigen::Matrix3d enu = C.transpose() * P * C;
    EXPECT_NEAR(f.std_position.x(), std::sqrt(enu(1, 1)), 1e-12);
    EXPECT_NEAR(f.std_position.y(), std::sqrt(enu(0, 0)), 1e-12);
    EXPECT_NEAR(f.std_position.z(), std::sqrt(enu(2, 2)), 1e-12);
    EXPECT_EQ(p.height, HeightKind::Ellipsoidal);
}

TEST_F(Pos, BadRowsAndFiles) {
    const std::string row = "2244 36000.0" + values;
    std::string bad = row;
    bad.replace(bad.find("30.1"), 4, "abcd");
    const RtklibPos p =
        read("%  GPST" + names + row + bad + row.substr(0, 40) + "\n" + "2244 36001.0" + values + "2244 36002.0" + values);
    EXPECT_EQ(p.fixes.size(), 3U);
    EXPECT_EQ(p.rows.bad, 2U);
    expect_parts(log.summary().at(0), {"a.pos", "line 3", "(2 times)"});
    expect_parts(message_of([&] { (void)read("%  GPST" + names + bad + bad + row); }), {"a.pos:2", "cannot be read", "RTKLIB"});
    expect_parts(message_of([&] {
                     (void)read("%  GPST e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m)\n2244 36000.0 1 2 3 1 8 0\n");
                 }),
                 {"a.pos:1", "baselines", "llh"});
    expect_parts(message_of([&] { (void)read("% program : x\n"); }), {"a.pos", "no usable row"});
    WarningLog guessed;
    const RtklibPos g = read_rtklib_pos(TextInput::memory("2023/01/08 10:00:00.000" + values, "a.pos"), guessed);
    expect_first_fix(g.fixes.at(0));
    EXPECT_FALSE(g.header_found);
    EXPECT_EQ(guessed.count("gnss.pos.header"), 1U);
}

TEST_F(Pos, Corpus) {
    SKIP_WITHOUT_DATA();
    const auto corpus = test::data_folder() / "parser_corpus/instinct/RtklibPosFile";
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus)) {
        if (entry.path().extension() != ".pos") continue;
        ++files;
        const RtklibPos p = read_rtklib_pos(entry.path(), log);
        EXPECT_TRUE(is_rtklib_pos(entry.path())) << entry.path();
        EXPECT_EQ(p.fixes.size(), 2U) << entry.path();
        // All start at ten, GPS time; the one without a header has UTC, which nothing in it says.
        EXPECT_EQ(p.fixes[0].time.ns, p.header_found ? ten : ten - 18'000'000'000) << entry.path();
        EXPECT_NEAR(p.fixes[0].position.lat, 30.0 * deg, 1e-6) << entry.path();
        EXPECT_NEAR(p.fixes[0].position.lon, 95.0 * deg, 1e-6) << entry.path();
        EXPECT_NEAR(p.fixes[0].position.h, -9.36, 0.01) << entry.path();
        EXPECT_EQ(p.fixes[0].satellites, 8);
        EXPECT_NEAR(p.fixes[0].std_position.z(), 7.1259, 2e-3) << entry.path();
    }
    EXPECT_EQ(files, 8U);
    const RtklibPos rose = read_rtklib_pos(test::data_folder() / "spirent_rose_noatm/rtklib_rtk_fixandhold.pos", log);
    EXPECT_GT(rose.fixes.size(), 500U);
    EXPECT_EQ(rose.fixes.back().fix, FixType::RtkFixed);
}

std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body) sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

class Nmea : public test::IoTest {
protected:
    NmeaLog read(const std::string& text) { return read_nmea(TextInput::memory(text, "a.nmea"), log); }
    WarningLog log;
};

TEST_F(Nmea, EpochsAreAssembled) {
    const NmeaLog n = read(sentence("GNRMC,100000.25,A,4830.12345678,N,00915.87654321,W,10.0,30.0,080123,,,R") +
                           sentence("GNGGA,100000.25,4830.12345678,N,00915.87654321,W,4,19,0.6,300.125,M,48.250,M,1.0,0123") +
                           "noise $GPGGA,1000*00\n" + sentence("GNGST,100000.25,1.0,0.5,0.4,30,0.011,0.012,0.023") +
                           sentence("GNGSA,A,3,01,02,,,,,,,,,,,1,1,1") +
                           sentence("GNGGA,100001.25,4830.12345678,S,00915.87654321,E,5,19,0.6,300.125,M,48.250,M,1.0,0123") +
                           sentence("GNVTG,90.0,T,,M,19.4384,N,36.0,K,F"));
    ASSERT_EQ(n.fixes.size(), 2U);
    const GnssFix& f = n.fixes[0];
    EXPECT_EQ(f.time.ns, ten + 18'250'000'000);  // UTC to GPS time
    EXPECT_NEAR(f.position.lat, (48.0 + 30.12345678 / 60.0) * deg, 1e-15);
    EXPECT_NEAR(f.position.lon, -(9.0 + 15.87654321 / 60.0) * deg, 1e-15);
    EXPECT_NEAR(f.position.h, 300.125 + 48.250, 1e-12);
    EXPECT_EQ(f.fix, FixType::RtkFixed);
    EXPECT_EQ(f.satellites, 19);
    EXPECT_EQ(f.std_position, Eigen::Vector3d(0.011, 0.012, 0.023));
    EXPECT_NEAR(f.velocity_n.x(), 10.0 * knot * std::cos(30.0 * deg), 1e-12);
    EXPECT_NEAR(f.velocity_n.y(), 10.0 * knot * std::sin(30.0 * deg), 1e-12);
    EXPECT_TRUE(std::isnan(f.velocity_n.z()));
    EXPECT_LT(n.fixes[1].position.lat, 0.0);
    EXPECT_EQ(n.fixes[1].fix, FixType::RtkFloat);
    EXPECT_NEAR(n.fixes[1].velocity_n.y(), 10.0, 1e-12);
    EXPECT_EQ(n.fixes[1].time.ns - f.time.ns, 1'000'000'000);
    EXPECT_EQ(n.bad_sentences, 1U);
    EXPECT_EQ(n.height, HeightKind::Ellipsoidal);
}

TEST_F(Nmea, MidnightAndLateDate) {
    const auto gga = [](const std::string& time) { return sentence("GPGGA," + time + ",4800.0,N,00900.0,E,1,9,1,100,M,48,M,,"); };
    // The date comes after midnight only: the epochs before it belong to the day before.
    const NmeaLog n = read(gga("235958.00") + gga("235959.00") + gga("000000.00") + sentence("GPZDA,000000.00,01,01,2017,00,00") +
                           gga("000001.00"));
    ASSERT_EQ(n.fixes.size(), 4U);
    EXPECT_TRUE(n.has_date);
    EXPECT_EQ(n.fixes[1].time.ns - n.fixes[0].time.ns, 1'000'000'000);
    EXPECT_EQ(n.fixes[2].time.ns - n.fixes[1].time.ns, 2'000'000'000);  // the leap second at the end of 2016
    EXPECT_EQ(n.fixes[3].time.ns - n.fixes[2].time.ns, 1'000'000'000);
    EXPECT_EQ(n.fixes[2].time, gps_from_utc({2017, 1, 1, 0, 0, 0.0}));
    const NmeaLog undated = read(gga("235959.00") + gga("000000.00"));
    EXPECT_FALSE(undated.has_date);
    EXPECT_EQ(undated.fixes[1].time.ns - undated.fixes[0].time.ns, 1'000'000'000);
    EXPECT_EQ(log.count("gnss.nmea.date"), 1U);
}

TEST_F(Nmea, NoFixNoSeparationNoChecksum) {
    const NmeaLog n = read(sentence("GPGGA,100000.00,,,,,0,00,,,M,,M,,") + sentence("GPRMC,100001.00,V,,,,,,,080123,,,N") +
                           sentence("GPGGA,100002.00,4800.0,N,00900.0,E,2,9,1,100,M,,M,,") +
                           sentence("GPGNS,100003.00,4800.0,N,00900.0,E,AD,9,1,100,48,,") +
                           "$GPGGA,100004.00,4800.0,N,00900.0,E,1,9,1,100,M,48,M,,\n");
    ASSERT_EQ(n.fixes.size(), 2U);
    EXPECT_EQ(n.rows.without_fix, 2U);
    EXPECT_EQ(n.bad_sentences, 1U);
    EXPECT_EQ(n.height, HeightKind::Msl);
    EXPECT_EQ(n.fixes[0].fix, FixType::Differential);
    EXPECT_EQ(n.fixes[1].fix, FixType::Differential);
    EXPECT_EQ(n.fixes[1].position.h, 148.0);
    expect_parts(message_of([&] { (void)read("hello\n$GPGGA,1*00\n"); }),
                 {"a.nmea", "no sentence with a right checksum", "NMEA"});
    expect_parts(message_of([&] { (void)read(sentence("GPGGA,100000.00,,,,,0,00,,,M,,M,,")); }),
                 {"a.nmea", "none of the 1 epochs has a fix"});
}

TEST_F(Nmea, Corpus) {
    SKIP_WITHOUT_DATA();
    const auto path = test::data_folder() / "parser_corpus/instinct/NmeaFile/test.nmea";
    EXPECT_TRUE(is_nmea(path));
    const NmeaLog n = read_nmea(path, log);
    EXPECT_EQ(n.fixes.size(), 5U);
    EXPECT_EQ(n.bad_sentences, 1U);  // 16:16:03 has a wrong checksum
    // In order of time the epoch of 3 November 2022 comes first.
    EXPECT_EQ(n.fixes.front().time, gps_from_utc({2022, 11, 3, 14, 5, 18.0}));
    EXPECT_NEAR(n.fixes.front().position.h, 279.827 + 47.985, 1e-9);
    EXPECT_EQ(n.fixes[1].time.ns, gps_from_utc({2022, 11, 5, 16, 15, 59.0}).ns + 756'000'000);
    EXPECT_NEAR(std::hypot(n.fixes[1].velocity_n.x(), n.fixes[1].velocity_n.y()), 830.0 * knot, 1e-9);
}

}  // namespace
}  // namespace schuler::io
