// IGC files of flight recorders, made from the specification of their records.
#include "schuler/core/time.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;

class Igc : public test::IoTest {
protected:
    StreamLog read(const std::string& text) {
        const auto file = write("flight.igc", text);
        const Format* format = format_of(file);
        if (format == nullptr || format->name != "igc") {
            ADD_FAILURE() << "recognised as " << (format == nullptr ? "nothing" : format->name);
            return {};
        }
        return format->read(TextInput(file), log);
    }
    static double at(const Stream& s, std::string_view column, std::size_t row) {
        const Stream::Column* c = s.find(column);
        return c == nullptr ? std::nan("") : c->values.at(row);
    }
    WarningLog log;
};

TEST_F(Igc, FixesHaveTheirAdditionsAndGoOnAfterMidnight) {
    const StreamLog flight = read(
        "AXYZ001 TEST\r\nHFDTEDATE:310323,01\r\nHFALGALTGPS:ELL\r\nI053638FXA3940SIU4142TDS4344LAD4546LOD\r\n"
        "F235950010203\r\n"
        "B2359584807038N01131000EA0049700512014092512"
        "99\r\n"
        "B2359594807039S01131000WA-00120051301409003"
        "400\r\n"
        "B2359584807038NxxxxxxxxEA0049700512014090000"
        "00\r\n"
        "B0000014807038N01131000EV0049700000999000000"
        "00\r\nG1234\r\n");
    ASSERT_EQ(flight.streams.size(), 2U);
    EXPECT_EQ(flight.clock, Clock::Gps);
    const Stream &gnss = flight.streams[0], &baro = flight.streams[1];
    ASSERT_EQ(gnss.rows(), 3U);
    EXPECT_EQ(gnss.time_ns[0], gps_from_utc({2023, 3, 31, 23, 59, 58.25}).ns);
    EXPECT_EQ(gnss.time_ns[2], gps_from_utc({2023, 4, 1, 0, 0, 1.0}).ns);
    EXPECT_NEAR(at(gnss, "lat_deg", 0), 48.0 + 7.03812 / 60.0, 1e-12);
    EXPECT_NEAR(at(gnss, "lon_deg", 0), 11.0 + 31.00099 / 60.0, 1e-12);
    EXPECT_NEAR(at(gnss, "lat_deg", 1), -48.0 - 7.03934 / 60.0, 1e-12);
    EXPECT_NEAR(at(gnss, "lon_deg", 1), -11.0 - 31.0 / 60.0, 1e-12);
    EXPECT_EQ(at(gnss, "height_ellipsoidal_m", 0), 512.0);
    EXPECT_EQ(at(gnss, "std_h_m", 0), 7.0);
    EXPECT_EQ(at(gnss, "satellites", 0), 9.0);
    EXPECT_EQ(gnss.fix[0], FixType::Autonomous);
    EXPECT_EQ(gnss.fix[2], FixType::None);
    EXPECT_TRUE(std::isnan(at(gnss, "height_ellipsoidal_m", 2)));
    EXPECT_TRUE(std::isnan(at(gnss, "std_h_m", 2)));
    EXPECT_EQ(at(baro, "height_m", 0), 497.0);
    EXPECT_EQ(at(baro, "height_m", 1), -12.0);
    ASSERT_EQ(log.summary().size(), 1U);
    expect_parts(log.summary().front(), {"flight.igc", "damaged B records", "line 8"});
}

TEST_F(Igc, ARecorderWithoutSensorAndReferenceHasFixesAlone) {
    const StreamLog flight =
        read("AXCT\nHFDTE010298\nB1200004807038N01131000EA0000000512\nB1200014807038N01131000EA0000000513\n");
    ASSERT_EQ(flight.streams.size(), 1U);
    EXPECT_EQ(at(flight.streams[0], "height_m", 1), 513.0);  // above the ellipsoid or the sea: recorders differ
    EXPECT_EQ(flight.streams[0].time_ns[0], gps_from_utc({1998, 2, 1, 12, 0, 0.0}).ns);
    EXPECT_TRUE(log.empty());
}

TEST_F(Igc, AFileWithoutDateOrFixesSaysSo) {
    const Format* format = format_named("igc");
    const auto told = [&](const std::string& text) {
        return message_of([&] { (void)format->read(TextInput::memory(text, "flight.igc"), log); });
    };
    expect_parts(told("AXCT\nB1200004807038N01131000EA0000000512\n"), {"flight.igc:2", "before a date", "HFDTE"});
    expect_parts(told("AXCT\nHFDTE010298\nB12000048\n"), {"flight.igc:3", "holds no fix"});
}

}  // namespace
}  // namespace schuler::io
