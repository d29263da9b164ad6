// Inertial sensors and solutions of receivers: NovAtel, u-blox ESF; SBET, GPX, MAT, KITTI, Inertial Explorer, OB_GINS.
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/io/formats.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/solution/rtklib_pos.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;
using test::put;

class ReceiverSensors : public test::IoTest {
protected:
    static StreamLog read(const std::filesystem::path& file, const char* name, WarningLog& warnings) {
        const Format* format = format_of(file);
        if (format == nullptr || format->read == nullptr || format->name != name) {
            ADD_FAILURE() << file << " was recognised as " << (format == nullptr ? "nothing" : format->name);
            return {};
        }
        return format->read(TextInput(file), warnings);
    }
};

double at(const Stream& s, std::string_view column, std::size_t row) {
    const Stream::Column* c = s.find(column);
    return c == nullptr ? std::nan("") : c->values.at(row);
}

std::string novatel_ascii(const std::string& content) {
    return fmt::format("{}*{:08x}\r\n", content, test::novatel_crc(std::string_view(content).substr(1)));
}

/// RAWIMUSX with its short header.
std::string rawimusx(double seconds, std::int32_t az, std::int32_t minus_ay, std::int32_t ax, std::int32_t gz,
                     std::int32_t minus_gy, std::int32_t gx, unsigned char type) {
    std::string body(1, '\0');
    body += static_cast<char>(type);
    put(body, std::uint16_t{2200});
    put(body, seconds);
    put(body, std::uint32_t{0});
    for (const std::int32_t v : {az, minus_ay, ax, gz, minus_gy, gx}) put(body, v);
    std::string m("\xaa\x44\x13", 3);
    m += static_cast<char>(body.size());
    put(m, std::uint16_t{1462});
    put(m, std::uint16_t{2200});
    put(m, static_cast<std::uint32_t>(seconds * 1000.0));
    m += body;
    const std::uint32_t crc = test::novatel_crc(m);
    put(m, crc);
    return m;
}

TEST_F(ReceiverSensors, NovatelAsciiAndBinaryMixed) {
    std::string log = "[COM1]OK\r\n";
    for (int i = 0; i < 20; ++i) {
        const double t = 1000.0 + i;
        log += novatel_ascii(fmt::format(
            "#BESTPOSA,COM1,0,85.0,FINESTEERING,2200,{:.3f},02040008,b1f6,32768;SOL_COMPUTED,NARROW_INT,51.116,-114.038,1059.7,-16.9,WGS84,0.018,0.015,0.028,"
            "\"\",0.0,0.0,20,18,18,0,00,00,00,11",
            t));
        log += novatel_ascii(fmt::format(
            "#BESTVELA,COM1,0,85.0,FINESTEERING,2200,{:.3f},02040008,b1f6,32768;SOL_COMPUTED,DOPPLER_VELOCITY,0.15,0.0,5.0,90.0,0.25,0.0",
            t));
        log += novatel_ascii(fmt::format(
            "%INSPVASA,2200,{:.3f};2200,{:.3f},51.116,-114.038,1042.8,1.0,2.0,0.5,1.5,-2.5,90.0,INS_SOLUTION_GOOD", t, t));
        for (int k = 0; k < 10; ++k) log += rawimusx(t + 0.1 * k, 1000, -200, 300, 50, -60, 70, 31);
    }
    WarningLog warnings;
    const StreamLog read_log = read(write("oem.gps", log), "novatel", warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(read_log.clock, Clock::Gps);
    const Stream &gnss = *read_log.find("gnss"), &imu = *read_log.find("imu"), &reference = *read_log.find("reference");
    EXPECT_EQ(gnss.rows(), 20U);
    EXPECT_EQ(gnss.time_ns[0], Time::from_gps(2200, 1000.0).ns);
    EXPECT_NEAR(at(gnss, "height_ellipsoidal_m", 0), 1042.8, 1e-9) << "with the undulation";
    EXPECT_NEAR(at(gnss, "vel_e_m_s", 0), 5.0, 1e-9);
    EXPECT_NEAR(at(gnss, "vel_d_m_s", 0), -0.25, 1e-12);
    EXPECT_EQ(gnss.fix.at(0), FixType::RtkFixed);
    // x right, y forward, z up of the log; forward, right, down here; the log has the negative y
    EXPECT_NEAR(at(imu, "dv_x_m_s", 3), 200.0 * 200.0 / 2147483648.0, 1e-15);
    EXPECT_NEAR(at(imu, "dv_y_m_s", 3), 300.0 * 200.0 / 2147483648.0, 1e-15);
    EXPECT_NEAR(at(imu, "dv_z_m_s", 3), -1000.0 * 200.0 / 2147483648.0, 1e-15);
    EXPECT_NEAR(at(imu, "dtheta_x_rad", 3), 60.0 * 720.0 / 2147483648.0 * units::deg, 1e-15);
    EXPECT_EQ(at(reference, "vel_d_m_s", 0), -0.5);
    EXPECT_EQ(at(reference, "roll_deg", 0), 1.5);

    std::string damaged = log;
    damaged[damaged.find("51.116") + 1] = '9';
    EXPECT_EQ(read(write("bad.gps", damaged), "novatel", warnings).find("gnss")->rows(), 19U);
    expect_parts(warnings.summary().at(0), {"bad.gps", "damaged logs", "at byte 10"});
    WarningLog others;
    const auto unknown = write("unknown.gps", rawimusx(1.0, 1, 2, 3, 4, 5, 6, 200) +
                                                  novatel_ascii("#VERSIONA,COM1,0,85.0,FINESTEERING,2200,1.0,0,0,0;1"));
    expect_parts(message_of([&] { (void)read(unknown, "novatel", others); }), {"unknown.gps", "no position", "VERSION"});
    expect_parts(others.summary().at(0), {"IMU type 200"});
}

template <class Value>
void set(std::string& payload, std::size_t where, Value value) {
    std::memcpy(payload.data() + where, &value, sizeof value);
}

/// The payload of a message that begins with the time of the week and a date, as NAV-PVT and HNR-PVT do.
std::string dated_payload(std::size_t size, std::uint32_t tow_ms, int second) {
    std::string p(size, '\0');
    set(p, 0, tow_ms);
    set(p, 4, std::uint16_t{2024});
    p[6] = 5;
    p[7] = 1;
    p[8] = 12;
    p[10] = static_cast<char>(second);
    return p;
}

std::string nav_pvt(std::uint32_t tow_ms, int second) {
    std::string p = dated_payload(92, tow_ms, second);
    p[11] = 7;
    p[20] = 3;
    p[21] = 1;
    p[23] = 12;
    set(p, 24, std::int32_t{85'000'000});
    set(p, 28, std::int32_t{473'000'000});
    set(p, 32, std::int32_t{500'000});
    set(p, 40, std::uint32_t{1500});
    set(p, 44, std::uint32_t{2500});
    return test::ubx(0x01, 0x07, p);
}

/// Records of an SBET: travel to the north-east, falling, in a wander frame, with velocities along x, +-y and +-z.
std::string sbet(double wander, double y_sign, double z_sign, double fallen = 1.0) {
    std::string out;
    const double north = 20.0, east = 10.0, down = 1.0, heading = 0.5;
    for (int i = 0; i < 200; ++i) {
        const double t = 0.01 * i, c = std::cos(wander), s = std::sin(wander);
        for (const double v : {302'400.0 + t, 0.5 + north * t / 6'350'000.0, -1.0 + east * t / (6'383'000.0 * std::cos(0.5)),
                               500.0 - fallen * t, c * north - s * east, y_sign * (s * north + c * east), z_sign * down, 0.01,
                               0.02, heading + wander, wander, 0.0, 0.0, -9.8, 0.0, 0.0, 0.0})
            put(out, v);
    }
    return out;
}

TEST_F(ReceiverSensors, SbetVelocitiesOfEveryFrame) {
    for (const double wander : {0.0, 0.4, -2.0})
        for (const double y : {-1.0, 1.0})
            for (const double z : {-1.0, 1.0}) {  // north, west, up is Applanix's
                WarningLog warnings;
                const StreamLog log = read(write("a.sbet", sbet(wander, y, z)), "sbet", warnings);
                const Stream& s = log.streams.at(0);
                EXPECT_NEAR(at(s, "vel_n_m_s", 50), 20.0, 1e-9) << wander << y << z;
                EXPECT_NEAR(at(s, "vel_e_m_s", 50), 10.0, 1e-9) << wander << y << z;
                EXPECT_NEAR(at(s, "vel_d_m_s", 50), 1.0, 1e-9) << wander << y << z;
                EXPECT_NEAR(at(s, "heading_deg", 50), 0.5 / units::deg, 1e-9);
                EXPECT_TRUE(warnings.empty());
            }
    WarningLog warnings;
    const StreamLog log = read(write("a.sbet", sbet(0.4, 1.0, 1.0, 0.0)), "sbet", warnings);
    EXPECT_NEAR(at(log.streams.at(0), "vel_d_m_s", 50), -1.0, 1e-9);
    ASSERT_EQ(warnings.summary().size(), 1U) << "the heights do not show it";
    expect_parts(warnings.summary().at(0), {"a.sbet", "third", "up"});
}

TEST_F(ReceiverSensors, UbloxSensorsAreOnTheTimeOfTheFixes) {
    std::string log;
    std::uint32_t ticks = 0xFFFFF000U;  // the counter begins anew in between
    for (int i = 0; i < 30; ++i) {
        log += nav_pvt(302'400'000U + 1000U * static_cast<std::uint32_t>(i), i);
        log += "$GNTXT,01,01,02,between*00\r\n";
        for (int m = 0; m < 10; ++m) {
            std::string p(4, '\0');
            for (int k = 0; k < 10; ++k) {
                const auto word = [&](unsigned type, std::int32_t value) {
                    put(p, (type << 24) | (static_cast<std::uint32_t>(value) & 0xFFFFFFU));
                    put(p, ticks);
                };
                word(14, 4096);
                word(13, -4096);
                word(5, 8192);
                word(16, 1024);
                word(17, -1024);
                word(18, 10'045);
                word(12, 2500);
                ticks += 256;
            }
            log += test::ubx(0x10, 0x03, p);
        }
    }
    WarningLog warnings;
    const StreamLog read_log = read(write("f9r.ubx", log), "ubx", warnings);
    const Stream &imu = *read_log.find("imu"), &gnss = *read_log.find("gnss");
    EXPECT_EQ(read_log.clock, Clock::Gps);
    EXPECT_EQ(gnss.rows(), 30U);
    ASSERT_EQ(imu.rows(), 3000U);
    EXPECT_NEAR(at(imu, "gyro_x_rad_s", 5), units::deg, 1e-12);
    EXPECT_NEAR(at(imu, "gyro_z_rad_s", 5), 2.0 * units::deg, 1e-12);
    EXPECT_NEAR(at(imu, "accel_z_m_s2", 5), 10'045.0 / 1024.0, 1e-12);
    for (std::size_t i = 1; i < imu.rows(); ++i)
        ASSERT_NEAR(static_cast<double>(imu.time_ns[i] - imu.time_ns[i - 1]), 1e7, 10.0) << i;
    // the first message behind an epoch ends 0.09 s behind it, and is taken to be of it
    EXPECT_NEAR(static_cast<double>(imu.time_ns[9] - gnss.time_ns[0]) * 1e-9, 0.0, 0.001);
}

TEST_F(ReceiverSensors, MeasurementsOfMessagesComeWithTheirSigns) {
    std::string log;
    for (std::uint32_t i = 0; i < 20; ++i) {
        for (const bool gyro : {true, false}) {
            std::string p;
            put(p, 5000 + 10 * i);
            put(p, static_cast<std::uint16_t>(3U << 11));
            put(p, std::uint16_t{0});
            for (const unsigned type : gyro ? std::array{14U, 13U, 5U} : std::array{16U, 17U, 18U})
                put(p, type << 24 | 0xFFF000U);
            put(p, 5000 + 10 * i);
            log += test::ubx(0x10, 0x02, p);
        }
    }
    WarningLog warnings;
    const StreamLog read_log = read(write("esf.ubx", log), "ubx", warnings);
    EXPECT_EQ(read_log.clock, Clock::Boot) << "nothing gives the time";
    EXPECT_NEAR(at(*read_log.find("imu"), "gyro_y_rad_s", 2), -units::deg, 1e-12);
    EXPECT_NEAR(at(*read_log.find("imu"), "accel_x_m_s2", 2), -4.0, 1e-12);
}

std::string hnr_pvt(std::uint32_t tow_ms) {
    std::string p = dated_payload(72, tow_ms, static_cast<int>(tow_ms / 1000U % 60U));
    p[16] = 3;
    set(p, 20, std::int32_t{85'000'000});
    set(p, 24, std::int32_t{473'000'000});
    return test::ubx(0x28, 0x00, p);
}

TEST_F(ReceiverSensors, DamageOfAUbxLogWithoutFixesIsTold) {
    std::string log;
    for (std::uint32_t i = 0; i < 10; ++i) log += hnr_pvt(302'400'000U + 1000U * i);
    const std::size_t one = log.size() / 10;
    const auto told = [&](const std::string& bytes, std::size_t rows) {
        WarningLog warnings;
        EXPECT_EQ(read(write("hnr.ubx", bytes), "ubx", warnings).find("hnr")->rows(), rows);
        return warnings.summary();
    };
    EXPECT_TRUE(told(log, 10).empty());
    const auto cut = told(log.substr(0, log.size() - 7), 9);
    ASSERT_EQ(cut.size(), 1U);
    expect_parts(cut[0], {"hnr.ubx", "cut in its last message", fmt::format("at byte {}", 9 * one)});
    std::string damaged = log;
    damaged[3 * one + 30] = static_cast<char>(damaged[3 * one + 30] ^ 1);
    damaged[5 * one + 5] = '\x70';  // a length beyond the end of the log
    const auto bad = told(damaged, 8);
    ASSERT_EQ(bad.size(), 1U);
    expect_parts(bad[0], {"hnr.ubx", "damaged UBX messages", fmt::format("the first at byte {}", 3 * one), "(2 times)"});
}

TEST_F(ReceiverSensors, GpxTracksHaveTheirTimes) {
    WarningLog warnings;
    const auto file = write(
        "walk.gpx",
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\"><trk><trkseg>\n<trkpt lon='11.5' lat='48.1'><ele>512.5</ele><time>2024-05-01T12:00:00.25Z</time></trkpt>\n"
        "<trkpt lat=\"48.2\" lon=\"11.6\"><time>2024-05-01T14:00:01+02:00</time></trkpt><trkpt lat=\"48.2\" lon=\"11.6\"/></trkseg></trk></gpx>");
    const Stream gnss = read(file, "gpx", warnings).streams.at(0);
    ASSERT_EQ(gnss.rows(), 2U);
    EXPECT_EQ(gnss.time_ns[1] - gnss.time_ns[0], 750'000'000);
    EXPECT_EQ(gnss.time_ns[1], gps_from_utc({2024, 5, 1, 12, 0, 1.0}).ns);
    EXPECT_EQ(at(gnss, "lat_deg", 0), 48.1);
    EXPECT_EQ(warnings.summary().size(), 1U);
}

TEST_F(ReceiverSensors, InertialExplorerExportsInBothAngleForms) {
    WarningLog warnings;
    const auto file = write(
        "export.txt",
        "Project: test\n\nGPSTime Week Latitude Longitude H-Ell VNorth VEast VUp Heading Pitch Roll\n(sec) (wks) (+/-D M S) (+/-D M S) (m) (m/s) (m/s) (m/s) (deg) (deg) (deg)\n"
        "100.000 2200 -48 30 36.0 11 15 0.0 512.5 1.0 2.0 0.5 90.0 1.5 -0.5\n101.000 2200 -48.51 11.25 512.5 1.0 2.0 0.5 90.0 1.5 -0.5\n");
    const Stream s = read(file, "waypoint", warnings).streams.at(0);
    ASSERT_EQ(s.rows(), 2U);
    EXPECT_NEAR(at(s, "lat_deg", 0), -48.51, 1e-12);
    EXPECT_NEAR(at(s, "lon_deg", 0), 11.25, 1e-12);
    EXPECT_EQ(at(s, "vel_d_m_s", 1), -0.5);
    EXPECT_EQ(at(s, "roll_deg", 1), -0.5);
    EXPECT_EQ(s.time_ns[1], Time::from_gps(2200, 101.0).ns);
    EXPECT_EQ(warnings.summary().size(), 0U);
    const auto damaged =
        write("damaged.txt",
              "GPSTime Week Latitude Longitude H-Ell Heading Pitch Roll\n100.0 1101100 -48.5 11.2 512.5 90.0 1.5 -0.5\n"
              "101.0 2200 -48.5 11.2 512.5 90.0 1.5 -0.5\n");
    EXPECT_EQ(read(damaged, "waypoint", warnings).streams.at(0).rows(), 1U) << "no such week";
    EXPECT_EQ(warnings.summary().size(), 1U);
}

TEST_F(ReceiverSensors, KittiFoldersAreOneLog) {
    std::filesystem::create_directories(folder() / "oxts/data");
    std::string times;
    for (int i = 0; i < 20; ++i) {
        times += fmt::format("2011-09-26 13:02:{:02}.{:01}00000000\n", 25 + i / 10, i % 10);
        std::string row = "49.0 8.4 116.4 0.02 0.01 1.5707963267948966 3.0 4.0 5.0 0.1 0.2";
        for (int k = 11; k < 30; ++k) row += fmt::format(" {}", 0.1 * k);
        (void)write(fmt::format("oxts/data/{:010}.txt", i), row + "\n");
    }
    (void)write("oxts/timestamps.txt", times);
    WarningLog warnings;
    const StreamLog log = read(folder() / "oxts", "kitti", warnings);
    EXPECT_EQ(log.find("imu")->rows(), 20U);
    EXPECT_NEAR(at(*log.find("imu"), "accel_y_m_s2", 0), -1.2, 1e-12) << "left becomes right";
    EXPECT_NEAR(at(*log.find("reference"), "heading_deg", 0), 0.0, 1e-9) << "a quarter turn from east";
    EXPECT_EQ(at(*log.find("gnss"), "vel_e_m_s", 0), 4.0);
    EXPECT_EQ(log.find("imu")->time_ns[1] - log.find("imu")->time_ns[0], 100'000'000);
}

TEST_F(ReceiverSensors, ObGinsProjectsAreReadAsKfGinsProjects) {
    (void)write(
        "gnss.pos",
        "99.0 30.0 114.0 20.0 0.01 0.01 0.03\n100.0 30.5 114.5 23.0 0.008 0.011 0.036\n101.0 30.6 114.6 23.0 0.008 0.011 0.036\n");
    const auto file = write(
        "ob.yaml",
        "imufile: \"x/imu.txt\"\ngnssfile: \"dataset/gnss.pos\"\noutputpath: \"x/\"\nwindows: 30\nstarttime: 100\nendtime: 200\ninitvel: [ 0, 0, 0 ]\ninitatt: [ 0, 0, 276 ]\n"
        "imudatalen: 8\nimudatarate: 200\nantlever: [ -0.1, 0.3, 0.1 ]\nodometer:\n    std: [ 1, 1, 1 ]\nimumodel:\n    arw: 0.1\n    vrw: 0.1\n    gbstd: 25.0\n    abstd: 200.0\n"
        "    corrtime: 1.0\nisuseoutage: true\n");
    ASSERT_TRUE(is_kfgins_project(TextInput(file)));
    const KfGinsProject p = read_kfgins_project(TextInput(file));
    EXPECT_EQ(p.gnss_path, folder() / "gnss.pos") << "beside the project where its own path is not there";
    // the first fix from the start on is that of the antenna: 0.3 m to the right of a unit that heads west is to its north
    const Geodetic antenna = earth::moved_by_ned({}, p.position, {0.288, 0.131, 0.1});
    EXPECT_NEAR((antenna.lat - 30.5 * units::deg) * 6.4e6, 0.0, 2e-3);
    EXPECT_NEAR((antenna.lon - 114.5 * units::deg) * 5.5e6, 0.0, 2e-3);
    EXPECT_NEAR(antenna.h, 23.0, 1e-6);
    EXPECT_GT(p.std_position.x(), 0.03) << "of the lever arm, whose direction is as uncertain as the heading";
    EXPECT_EQ(p.lever_arm_b.y(), 0.3);
    EXPECT_NEAR(p.rpy.z(), 276.0 * units::deg, 1e-12);
}

TEST_F(ReceiverSensors, QualitiesWrittenAsDoublesAreNumbers) {
    WarningLog warnings;
    const auto file = write(
        "a.pos",
        "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m)\n2200 100.000 48.1 11.5 512.0 1.0000000 12.000 0.01 0.01 0.02\n"
        "2200 101.000 48.1 11.5 512.0 2.0000000 12.000 0.01 0.01 0.02\n");
    const RtklibPos pos = read_rtklib_pos(TextInput(file), warnings);
    ASSERT_EQ(pos.fixes.size(), 2U);
    EXPECT_EQ(pos.fixes[0].fix, FixType::RtkFixed);
    EXPECT_EQ(pos.fixes[1].fix, FixType::RtkFloat);
}

TEST_F(ReceiverSensors, RealSamples) {
    SKIP_WITHOUT_DATA();
    const auto samples = test::data_folder() / "format_samples";
    if (!std::filesystem::exists(samples)) GTEST_SKIP() << "no format samples (set SCHULER_DATA to the folder of the data sets)";
    WarningLog warnings;
    EXPECT_EQ(read(samples / "novatel/BESTPOS.GPS", "novatel", warnings).streams.at(0).kind, TableKind::Gnss);
    EXPECT_FALSE(read(samples / "novatel/ins1.gps", "novatel", warnings).streams.empty());
    const StreamLog sbet_log = read(samples / "novatel/2-points.sbet", "sbet", warnings);
    const Stream& two = sbet_log.streams.at(0);
    EXPECT_EQ(two.rows(), 2U);
    // the way between the two points, in 5 ms: 0.29 m/s to the east, 0.03 m/s downwards
    const double dt = 1e-9 * static_cast<double>(two.time_ns[1] - two.time_ns[0]), north = 6'353'000.0 * units::deg / dt,
                 east = north * std::cos(0.568);
    EXPECT_NEAR(at(two, "vel_n_m_s", 0), (at(two, "lat_deg", 1) - at(two, "lat_deg", 0)) * north, 0.03);
    EXPECT_NEAR(at(two, "vel_e_m_s", 0), (at(two, "lon_deg", 1) - at(two, "lon_deg", 0)) * east, 0.03);
    EXPECT_NEAR(at(two, "vel_d_m_s", 0), (at(two, "height_ellipsoidal_m", 0) - at(two, "height_ellipsoidal_m", 1)) / dt, 0.001);
    EXPECT_EQ(read(samples / "ubx/esf_raw.ubx", "ubx", warnings).streams.at(0).rows(), 10U);
    EXPECT_FALSE(read(samples / "ubx/pygpsdata-HNR.log", "ubx", warnings).streams.empty());
    EXPECT_EQ(read(samples / "mat/gnss.mat", "mat", warnings).find("gnss")->rows(), 2187U);
    EXPECT_EQ(read(samples / "mat/ref.mat", "mat", warnings).find("reference")->rows(), 1260U);
    EXPECT_EQ(read(samples / "mat/imu_transfer.mat", "mat", warnings).find("imu")->rows(), 2302U);
    const KfGinsProject p = read_kfgins_project(TextInput(samples / "kfgins/ob_gins.yaml"));
    EXPECT_NEAR(p.position.lat / units::deg, 30.46, 0.01);
}

}  // namespace
}  // namespace schuler::io
