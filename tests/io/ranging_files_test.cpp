// ranges.csv and stations.csv written and read back, damaged; 1090 MHz logs by published messages and by an encoder of their own.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/receiver/adsb.h"
#include "schuler/io/text/csv/csv_ranges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

namespace schuler::io {
namespace {

using units::deg;

RangingLog example() {
    RangingLog log;
    for (int k = 1; k <= 3; ++k) {
        log.epochs.push_back({Time::from_seconds(0.5 * k), log.samples.size(), 2});
        RangeSample satellite, station;
        satellite.source = log.source("G05", false);
        satellite.pseudorange = 2.0345e7 + k;
        satellite.range_rate = -312.25;
        satellite.std = 1.5;
        satellite.tx.r = {1.56e7, 7.54e6, 2.014e7};
        satellite.tx_velocity = {-1530, -2060, 1302};
        satellite.tx_clock = 1.25e-5;
        satellite.frequency = 1575.42e6;
        station.source = log.source("ADSB-URKK", true);
        station.pseudorange = 109840.964406;
        log.samples.push_back(satellite);
        log.samples.push_back(station);
    }
    return log;
}

TEST(RangesCsv, ReadsWhatItWrites) {
    const RangingLog log = example();
    const std::string text = ranges_csv(log);
    WarningLog warnings;
    const RangingLog back = read_ranges_csv(TextInput::memory(text, "ranges.csv"), {}, warnings).log;
    EXPECT_TRUE(warnings.empty());
    ASSERT_EQ(back.epochs.size(), 3U);
    ASSERT_EQ(back.sources.size(), 2U);
    EXPECT_FALSE(back.sources[0].station);
    EXPECT_TRUE(back.sources[1].station);
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
        EXPECT_EQ(back.samples[i].pseudorange, log.samples[i].pseudorange);
        EXPECT_EQ(back.samples[i].tx_clock, log.samples[i].tx_clock);
    }
    EXPECT_EQ(back.samples[0].tx.r, log.samples[0].tx.r);
    EXPECT_TRUE(std::isnan(back.samples[1].tx.r.x()));
    EXPECT_TRUE(std::isnan(back.samples[1].range_rate));
}

TEST(RangesCsv, SkipsRepeatedAndAbsurdRows) {
    const std::string text =
        "time_s,source,pseudorange_m\n1,G05,2e7\n1,G05,2.1e7\n1,R03,-5\n2,G05,2e7\n1.5,E01,2.2e7\n"
        "3,G05,2e7\n4,G05,2e7\n5,G05,2e7\n6,G05,2e7\n7,G05,2e7\n8,G05,2e7\n9,G05,2e7\n";
    WarningLog warnings;
    const RangingLog log = read_ranges_csv(TextInput::memory(text, "ranges.csv"), {}, warnings).log;
    ASSERT_EQ(log.epochs.size(), 10U);
    EXPECT_EQ(log.epochs[0].count, 1U);
    EXPECT_EQ(log.samples[0].pseudorange, 2e7);
    EXPECT_EQ(log.epochs[1].time, Time::from_seconds(1.5));
    EXPECT_EQ(warnings.count("stations.repeated"), 1U);
    EXPECT_EQ(warnings.count("stations.absurd"), 1U);
}

TEST(StationsCsv, RefusesTwinsAndNoPlaces) {
    WarningLog warnings;
    const auto read = [&](const std::string& text) {
        return read_stations_csv(TextInput::memory(text, "stations.csv"), {}, warnings);
    };
    const auto rows = read("id,lat_deg,lon_deg,height_m\nURKK,53.1,103.4,450\n");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_NEAR(rows[0].position.lat, 53.1 * deg, 1e-12);
    EXPECT_THROW((void)read("id,lat_deg,lon_deg,height_m\nA,53,103,1\nA,54,103,1\n"), Error);
    EXPECT_THROW((void)read("id,lat_deg,lon_deg,height_m\nA,153,103,1\n"), Error);
    EXPECT_THROW((void)read("id,lat_deg,height_m\nA,53,1\n"), Error);
}

/// A published pair of messages of one aircraft.
TEST(Adsb, DecodesThePublishedPair) {
    WarningLog warnings;
    const std::string text = "@0000000000008D40621D58C386435CC412692AD6;\n@000000B71B008D40621D58C382D690C8AC2863A7;\n";
    const AdsbLog log = read_adsb(TextInput::memory(text, "avr"), std::nullopt, warnings);
    ASSERT_EQ(log.positions.size(), 1U);
    const SquitterPosition& p = log.positions[0];
    EXPECT_EQ(p.address, 0x40621dU);
    EXPECT_NEAR(p.position.lat / deg, 52.2572021484375, 1e-9);
    EXPECT_NEAR(p.position.lon / deg, 3.91937255859375, 1e-9);
    EXPECT_NEAR(p.position.h, 38000 * 0.3048, 1e-6);
    EXPECT_EQ(p.time.ns, 1'000'000'000);
}

/// Encodes as the standard defines: fraction of a zone, nearest of 2^17 steps.
CompactPosition encoded(const Geodetic& p, bool odd, bool surface) {
    const double whole = surface ? 90.0 : 360.0, zone = whole / (odd ? 59 : 60), steps = 131072.0;
    const auto part = [](double x, double z) { return x / z - std::floor(x / z); };
    CompactPosition out;
    out.odd = odd;
    const double lat = std::floor(steps * part(p.lat / deg, zone) + 0.5);
    const double rounded = zone * (lat / steps + std::floor(p.lat / deg / zone));
    const double lon_zone = whole / std::max(longitude_zones(rounded * deg) - (odd ? 1 : 0), 1);
    out.lat = static_cast<std::uint32_t>(lat) % 131072;
    out.lon = static_cast<std::uint32_t>(std::floor(steps * part(p.lon / deg, lon_zone) + 0.5)) % 131072;
    return out;
}

TEST(Adsb, DecodesWhatIsEncodedAnywhere) {
    std::mt19937_64 generator(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    int solved = 0;
    for (int k = 0; k < 3000; ++k) {
        const Geodetic p{std::asin(unit(generator)) * 0.95, 179.9 * deg * unit(generator), 0.0};
        const CompactPosition even = encoded(p, false, false), odd = encoded(p, true, false);
        const auto near = [&](const Geodetic& q, double size) {
            EXPECT_NEAR(q.lat, p.lat, size);
            EXPECT_NEAR(std::remainder(q.lon - p.lon, 360 * deg) * std::cos(p.lat), 0.0, 2.0 * size);
        };
        for (const bool later : {false, true}) {
            const auto g = global_position(even, odd, later);
            if (!g) continue;  // zones of latitude differ
            ++solved;
            near(*g, 3e-5 * deg);
        }
        const Geodetic about{p.lat + 0.2 * deg * unit(generator), p.lon + 0.2 * deg * unit(generator), 0.0};
        near(local_position(odd, about, false), 3e-5 * deg);
        near(local_position(encoded(p, k % 2 == 0, true), about, true), 1e-5 * deg);
    }
    EXPECT_GT(solved, 5900);
}

TEST(Adsb, CountsDamageAndNeverInventsPositions) {
    WarningLog warnings;
    std::string text;
    for (int k = 0; k < 112; ++k) {  // each bit wrong once
        unsigned char m[14] = {0x8D, 0x40, 0x62, 0x1D, 0x58, 0xC3, 0x82, 0xD6, 0x90, 0xC8, 0xAC, 0x28, 0x63, 0xA7};
        m[k / 8] ^= static_cast<unsigned char>(0x80 >> k % 8);
        text += '*';
        for (const unsigned char byte : m) {
            constexpr char digits[] = "0123456789ABCDEF";
            text += {digits[byte >> 4], digits[byte & 15]};
        }
        text += ";\n";
    }
    text += "*8D40621D58C386435CC412692AD6;\n*8D4062;\n";
    const AdsbLog log = read_adsb(TextInput::memory(text, "avr"), std::nullopt, warnings);
    EXPECT_TRUE(log.positions.empty());
    EXPECT_EQ(log.messages.read, 1U);
    EXPECT_EQ(log.messages.bad + log.messages.foreign, 113U);
}

}  // namespace
}  // namespace schuler::io
