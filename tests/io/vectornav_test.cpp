// VectorNav logs: which of the inertial data, times and fixes are taken; damage; that any message can be skipped.
#include "schuler/io/receiver/vectornav.h"
#include "schuler/core/units.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;
using test::VectorNav;

enum Group : unsigned { Common, Times, Imu, Gnss, Attitude, Ins, Gnss2 };

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t week = 2200, gps_begin = week * 604'800 * second;

class VectorNavLog : public test::IoTest {
protected:
    StreamLog read(const std::string& bytes) {
        const auto file = write("log.vnb", bytes);
        const Format* format = format_of(file);
        EXPECT_EQ(format, format_named("vectornav")) << "recognised by its content";
        return format == nullptr ? StreamLog{} : format->read(TextInput(file), warnings);
    }
    WarningLog warnings;
};

/// A message of a unit with a receiver: times, uncompensated and compensated inertial data, field and pressure, solution.
std::string whole(int k, bool has_time, float bias = 0.1F) {
    const auto startup = static_cast<std::uint64_t>(k) * second / 100;
    VectorNav m;
    m.field(Common, 0, startup).field(Common, 1, has_time ? gps_begin + 5 * second + startup : std::uint64_t{0});
    m.field(Common, 3, 90.0F, -2.0F, 1.0F);  // yaw, pitch, roll
    m.field(Common, 5, 0.01F, 0.02F, 0.03F).field(Common, 6, 48.0, 11.0, 500.0).field(Common, 7, 1.0F, 2.0F, -3.0F);
    m.field(Common, 8, 0.0F, 0.0F, -9.8F);
    m.field(Common, 9, 0.5F, 0.25F, -9.75F, 0.01F + bias, 0.02F, 0.03F);  // accelerations first
    m.field(Common, 10, 0.2F, -0.05F, 0.4F, 25.0F, 95.5F).field(Common, 12, std::uint16_t{2});
    return m.message();
}

std::string fix(std::uint64_t tow, double lat, unsigned char type, unsigned char satellites = 12) {
    VectorNav m;
    m.field(Gnss, 1, tow).field(Gnss, 2, static_cast<std::uint16_t>(week)).field(Gnss, 3, satellites).field(Gnss, 4, type);
    m.field(Gnss, 5, lat, 11.0, 500.0).field(Gnss, 7, 3.0F, 4.0F, 0.5F).field(Gnss, 9, 0.5F, 0.6F, 1.5F).field(Gnss, 10, 0.05F);
    return m.message();
}

TEST_F(VectorNavLog, AllThatIsUsed) {
    std::string bytes = "$VNRRG,01,VN-300*5A\r\n" + whole(0, false) + whole(1, false);
    for (int k = 2; k < 6; ++k) bytes += whole(k, true) + (k < 4 ? fix(6 * second, 48.5, 3) : fix(7 * second, 48.5001, 8));
    const StreamLog log = read(bytes);
    EXPECT_EQ(log.clock, Clock::Gps);
    ASSERT_EQ(log.streams.size(), 5U);
    const Stream& imu = *log.find("imu");
    ASSERT_EQ(imu.rows(), 6U) << "those before the first GPS time by the time since power-on";
    EXPECT_EQ(imu.time_ns[0], static_cast<std::int64_t>(gps_begin + 5 * second));
    EXPECT_EQ(imu.time_ns[5], static_cast<std::int64_t>(gps_begin + 5 * second + second / 20));
    EXPECT_NEAR(imu.find("gyro_x_rad_s")->values[3], 0.11, 1e-7) << "without the unit's own corrections";
    EXPECT_EQ(imu.find("accel_z_m_s2")->values[3], -9.75);
    const Stream& gnss = *log.find("gnss");
    ASSERT_EQ(gnss.rows(), 2U) << "repeated fixes are one";
    EXPECT_EQ(gnss.time_ns[1], static_cast<std::int64_t>(gps_begin + 7 * second));
    EXPECT_NEAR(gnss.find("lat_deg")->values[1], 48.5001, 1e-12);
    EXPECT_EQ(gnss.find("vel_d_m_s")->values[0], 0.5);
    EXPECT_EQ(gnss.find("std_d_m")->values[0], 1.5);
    EXPECT_NEAR(gnss.find("std_vn_m_s")->values[0], 0.05, 1e-8);
    EXPECT_EQ(gnss.find("satellites")->values[0], 12.0);
    EXPECT_EQ(gnss.fix[0], FixType::Autonomous);
    EXPECT_EQ(gnss.fix[1], FixType::RtkFixed);
    EXPECT_NEAR(log.find("mag")->find("mag_z_ut")->values[0], 40.0, 1e-5);
    EXPECT_NEAR(log.find("baro")->find("pressure_pa")->values[0], 95'500.0, 1e-2);
    const Stream& own = *log.find("reference");
    EXPECT_NEAR(own.find("heading_deg")->values[0], 90.0, 1e-9);
    EXPECT_NEAR(own.find("pitch_deg")->values[0], -2.0, 1e-9);
    EXPECT_NEAR(own.find("roll_deg")->values[0], 1.0, 1e-9);
    EXPECT_TRUE(warnings.empty());
}

TEST_F(VectorNavLog, AUnitWithoutReceiver) {
    std::string rates, increments;
    for (int k = 0; k < 3; ++k) {
        const auto startup = static_cast<std::uint64_t>(k) * second / 100;
        rates += VectorNav()
                     .field(Times, 0, startup)
                     .field(Imu, 9, 0.0F, 0.1F, -9.8F)
                     .field(Imu, 10, 0.01F, 0.02F, 0.03F)
                     .field(Attitude, 0, std::uint16_t{0})
                     .field(Attitude, 8, 1.0F, 1.0F, 1.0F)
                     .message();
        increments +=
            VectorNav().field(Common, 0, startup).field(Common, 11, 0.01F, 0.5F, 0.0F, -1.0F, 0.0F, 0.0F, -0.098F).message();
    }
    const StreamLog log = read(rates);
    EXPECT_EQ(log.clock, Clock::Boot);
    ASSERT_EQ(log.streams.size(), 1U);
    EXPECT_EQ(log.find("imu")->time_ns[2], 20'000'000);
    EXPECT_NEAR(log.find("imu")->find("gyro_z_rad_s")->values[1], 0.03, 1e-8);
    const StreamLog other = read(increments);
    EXPECT_NEAR(other.find("imu")->find("gyro_x_rad_s")->values[1], 50.0 * units::deg, 1e-7);
    EXPECT_NEAR(other.find("imu")->find("accel_z_m_s2")->values[1], -9.8, 1e-6);
}

TEST_F(VectorNavLog, DamageAndTheEndOfTheLog) {
    std::string bytes;
    for (int k = 0; k < 6; ++k) bytes += whole(k, true);
    const std::size_t size = bytes.size() / 6;
    std::string damaged = bytes;
    damaged[2 * size + 40] ^= 1;
    EXPECT_EQ(read(damaged).find("imu")->rows(), 5U);
    expect_parts(warnings.summary().at(0), {"damaged messages", std::to_string(2 * size)});
    EXPECT_EQ(read(bytes.substr(0, 6 * size - 1)).find("imu")->rows(), 5U);
    const std::string undated = VectorNav().field(Common, 9, 0.0F, 0.0F, -9.8F, 0.0F, 0.0F, 0.0F).message();
    expect_parts(message_of([&] { (void)read(undated + undated + undated); }), {"log.vnb", "TimeGps"});
}

/// The receiver's fields alone: dated by GpsTow and GpsWeek; without these there is no time.
TEST_F(VectorNavLog, AReceiverAlone) {
    const StreamLog log = read(fix(second, 48.0, 3) + fix(second, 48.0, 3) + fix(2 * second, 48.0, 3));
    EXPECT_EQ(log.clock, Clock::Gps);
    ASSERT_EQ(log.streams.size(), 1U);
    ASSERT_EQ(log.find("gnss")->rows(), 2U);
    EXPECT_EQ(log.find("gnss")->time_ns[1], static_cast<std::int64_t>(week * 604'800 * second + 2 * second));
    const std::string undated =
        VectorNav().field(Gnss, 4, static_cast<unsigned char>(3)).field(Gnss, 5, 48.0, 11.0, 500.0).message();
    expect_parts(message_of([&] { (void)read(undated + undated); }), {"log.vnb", "with a time"});
}

/// The types of the fields: bytes of integers, f and d with the number of floats and doubles. Satellites and measurements: one each.
const std::array<std::vector<std::string>, 7> types{{
    {"8", "8", "8", "f3", "f4", "f3", "d3", "f3", "f3", "f6", "f5", "f7", "2", "4", "8"},
    {"8", "8", "8", "2", "8", "8", "8", "4", "4", "1"},
    {"2", "f3", "f3", "f3", "f1", "f1", "f4", "f3", "f3", "f3", "f3", "2", "f10"},
    {"8", "8", "2", "1", "1", "d3", "d3", "f3", "f3", "f3", "f1", "f1", "2", "f7", "10", "40"},
    {"2", "f3", "f4", "f9", "f3", "f3", "f3", "f3", "f3", "f3", "f7", "f6"},
    {"2", "d3", "d3", "f3", "f3", "f3", "f3", "f3", "f3", "f1", "f1", "f17", "f16"},
    {"8", "8", "2", "1", "1", "d3", "d3", "f3", "f3", "f3", "f1", "f1", "2", "f7", "10", "40"},
}};

TEST_F(VectorNavLog, SizesOfAllFields) {
    for (unsigned group = 0; group < types.size(); ++group)
        for (unsigned bit = 0; bit < 16; ++bit) {
            std::size_t expected = 0;
            if (bit < types[group].size()) {
                const std::string& type = types[group][bit];
                expected = type[0] == 'f'   ? 4 * std::stoul(type.substr(1))
                           : type[0] == 'd' ? 8 * std::stoul(type.substr(1))
                                            : std::stoul(type);
            }
            VectorNav m;
            for (std::size_t i = 0; i < std::max<std::size_t>(expected, 1); ++i) m.field(group, bit, '\x01');  // counts of one
            const std::string bytes = m.message();
            EXPECT_EQ(vectornav_size(bytes), expected == 0 ? 0 : bytes.size()) << group << ' ' << bit;
            for (std::size_t cut = 1; expected > 0 && cut < bytes.size(); ++cut)
                EXPECT_EQ(vectornav_size(std::string_view(bytes).substr(0, cut)), vectornav_incomplete)
                    << group << ' ' << bit << ' ' << cut;
        }
}

}  // namespace
}  // namespace schuler::io
