// NovAtel logs: raw measurements and ephemerides, alike in ASCII and binary; which fixes and IMU logs are taken. Waypoint IMR.
#include "schuler/core/units.h"
#include "schuler/io/formats.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/text/csv/csv_recording.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

using test::expect_parts;
using test::message_of;
using test::put;

constexpr int log_week = 2244;

std::string ascii(const std::string& name, double tow, const std::string& content) {
    const std::string log =
        fmt::format("{},COM1,0,83.5,FINESTEERING,{},{:.3f},02000000,cdba,16809;{}", name, log_week, tow, content);
    return fmt::format("#{}*{:08x}\r\n", log, test::novatel_crc(log));
}
std::string binary(std::uint16_t id, double tow, const std::string& body, char form = 0) {
    std::string m("\xaa\x44\x12\x1c", 4);
    put(m, id);
    m += form;
    m += '\x20';
    put(m, static_cast<std::uint16_t>(body.size()));
    m += std::string("\0\0\x64\xb4", 4);
    put(m, std::uint16_t{log_week});
    put(m, static_cast<std::uint32_t>(tow * 1000.0 + 0.5));
    m += std::string(8, '\0');
    const std::string all = m + body;
    std::string out = all;
    put(out, test::novatel_crc(all));
    return out;
}

struct Range {
    std::uint16_t prn, frequency;
    double psr, adr;
    float doppler, cn0, locked;
    std::uint32_t status;
};
constexpr std::uint32_t locked_all = 1U << 10 | 1U << 11 | 1U << 12;
const std::vector<Range> ranges = {
    {7, 0, 21'485'793.442, -112'908'605.801, 651.783F, 44.0F, 3.0F, locked_all},
    {56, 9, 20'848'881.420, -111'486'221.5, -100.0F, 40.0F, 3.0F, locked_all | 1U << 16},
    {12, 0, 29'078'098.874, -152'806'440.9, 2842.2F, 44.0F, 3.0F, locked_all | 3U << 16 | 2U << 21},
    {7, 0, 21'485'795.0, -84'311'000.0, 486.0F, 39.0F, 0.0F, (locked_all & ~(1U << 11)) | 14U << 21},
    {135, 0, 38'000'000.0, -199'000'000.0, 1.0F, 38.0F, 3.0F, (locked_all & ~(1U << 10)) | 2U << 16},
    {9, 0, 24'000'000.0, -1.0, 1.0F, 38.0F, 3.0F, locked_all | 31U << 21}};  // a signal that does not exist

std::string range_ascii(double tow) {
    std::string text = std::to_string(ranges.size());
    for (const Range& r : ranges)
        text += fmt::format(",{},{},{:.3f},0.050,{:.3f},0.010,{:.3f},{:.1f},{:.3f},{:08x}", r.prn, r.frequency, r.psr, r.adr,
                            r.doppler, r.cn0, r.locked, r.status);
    return ascii("RANGEA", tow, text);
}
std::string range_binary(double tow, char form = 0) {
    std::string body;
    put(body, static_cast<std::uint32_t>(ranges.size()));
    for (const Range& r : ranges) {
        put(body, r.prn), put(body, r.frequency), put(body, r.psr), put(body, 0.05F), put(body, r.adr), put(body, 0.01F);
        put(body, r.doppler), put(body, r.cn0), put(body, r.locked), put(body, r.status);
    }
    return binary(43, tow, body, form);
}

class Novatel : public test::IoTest {};

TEST_F(Novatel, RangesAreAlikeInAsciiAndBinary) {
    for (const bool text : {true, false}) {
        const auto one = [&](double t) { return text ? range_ascii(t) : range_binary(t); };
        const auto file = write("oem.gps", one(100.0) + one(101.0) + one(101.0) +
                                               (text ? std::string() : range_binary(102.0, '\x01')));  // the last: second antenna
        ASSERT_EQ(raw_format(file), RawFormat::Novatel);
        WarningLog warnings;
        const RawInput raw = read_raw_input(file, {}, warnings);
        ASSERT_EQ(raw.observations.epochs.size(), 2U);
        EXPECT_EQ(raw.observations.epochs[0].time, Time::from_gps(log_week, 100.0));
        const auto all = raw.observations.of(raw.observations.epochs[1]);
        ASSERT_EQ(all.size(), 5U);
        EXPECT_EQ(gnss::name_of(all[0].satellite), "G07");
        EXPECT_EQ(all[0].signal, (gnss::Signal{'1', 'C'}));
        EXPECT_NEAR(all[0].pseudorange, 21'485'793.442, 1e-6);
        EXPECT_NEAR(all[0].phase, 112'908'605.801, 1e-6) << "grows with the range";
        EXPECT_NEAR(all[0].doppler, 651.783, 1e-3);
        EXPECT_EQ(all[0].loss_of_lock, 1) << "the time of lock did not grow with the time";
        EXPECT_EQ(all[1].signal, (gnss::Signal{'5', 'Q'}));
        EXPECT_EQ(all[1].loss_of_lock & 2, 2) << "parity not known: half a cycle is open";
        EXPECT_EQ(gnss::name_of(all[2].satellite), "R19");
        EXPECT_EQ(raw.observations.channels.of_slot[19], 2);
        EXPECT_EQ(gnss::name_of(all[3].satellite), "E12");
        EXPECT_EQ(gnss::name_of(all[4].satellite), "S35");
        EXPECT_TRUE(std::isnan(all[4].phase)) << "not locked";
        expect_parts(fmt::format("{}", fmt::join(warnings.summary(), " ")), {"unknown signals", "not later"});
    }
}

/// The record of RANGECMP as the manual's table has it: bits in the order of the table, the lowest of each field first.
std::string compressed_record(const Range& r, std::uint64_t lock_units, int glonass_field) {
    std::string bits;
    const auto field = [&](std::int64_t value, int count) {
        for (int i = 0; i < count; ++i) bits += (static_cast<std::uint64_t>(value) >> i & 1U) != 0 ? '1' : '0';
    };
    field(r.status, 32);
    field(std::llround(static_cast<double>(r.doppler) * 256.0), 28);
    field(std::llround(r.psr * 128.0), 36);
    field(std::llround(r.adr * 256.0), 32);  // what is beyond 32 bits is lost
    field(1, 4), field(2, 4);
    field(r.prn, 8);
    field(static_cast<std::int64_t>(lock_units), 21);
    field(std::llround(static_cast<double>(r.cn0)) - 20, 5);
    field(glonass_field, 6);
    field(0, 16);
    std::string bytes;
    for (std::size_t i = 0; i < bits.size(); i += 8) {
        int byte = 0;
        for (std::size_t k = 8; k-- > 0;) byte = 2 * byte + (bits[i + k] - '0');
        bytes += static_cast<char>(byte);
    }
    return bytes;
}
std::string compressed(double tow, const std::vector<std::string>& records, bool text) {
    std::string body, cells = std::to_string(records.size());
    put(body, static_cast<std::uint32_t>(records.size()));
    for (const std::string& r : records) {
        body += r;
        cells += ',';
        for (const char c : r) cells += fmt::format("{:02x}", static_cast<unsigned char>(c));
    }
    return text ? ascii("RANGECMPA", tow, cells) : binary(140, tow, body);
}
std::string compressed_ranges(double tow, bool text) {
    std::vector<std::string> records;
    for (const Range& r : ranges)
        records.push_back(compressed_record(r, static_cast<std::uint64_t>(static_cast<double>(r.locked) * 32.0), r.frequency));
    return compressed(tow, records, text);
}

TEST_F(Novatel, CompressedRangesAreThoseOfRange) {
    WarningLog told;
    const RawInput full = read_raw_input(write("full.gps", range_binary(100.0) + range_binary(103.0)), {}, told);
    for (const bool text : {true, false}) {
        const auto file = write("packed.gps", compressed_ranges(100.0, text) + compressed_ranges(103.0, text));
        ASSERT_EQ(raw_format(file), RawFormat::Novatel);
        WarningLog warnings;
        const RawInput raw = read_raw_input(file, {}, warnings);
        ASSERT_EQ(raw.observations.epochs.size(), 2U);
        ASSERT_EQ(raw.observations.observations.size(), full.observations.observations.size());
        for (std::size_t i = 0; i < raw.observations.observations.size(); ++i) {
            const gnss::SignalObservation &a = raw.observations.observations[i], &b = full.observations.observations[i];
            SCOPED_TRACE(gnss::name_of(b.satellite));
            EXPECT_EQ(a.satellite, b.satellite);
            EXPECT_EQ(a.signal, b.signal);
            EXPECT_NEAR(a.pseudorange, b.pseudorange, 0.5 / 128.0 + 1e-9);
            EXPECT_EQ(std::isnan(a.phase), std::isnan(b.phase));
            EXPECT_FALSE(std::abs(a.phase - b.phase) > 0.5 / 256.0 + 1e-9);
            EXPECT_NEAR(a.doppler, b.doppler, 0.5 / 256.0 + 1e-9);
            EXPECT_EQ(a.cn0, b.cn0);
            EXPECT_EQ(a.loss_of_lock, b.loss_of_lock);
        }
        EXPECT_EQ(raw.observations.channels.of_slot[19], 2);
        EXPECT_EQ(warnings.summary().size(), 1U);
        expect_parts(fmt::format("{}", fmt::join(warnings.summary(), " ")), {"unknown signals"});
        // Where RANGE has the same epoch, its resolution wins in whichever order they stand.
        for (const std::string& both : {compressed_ranges(100.0, text) + range_binary(100.0) + compressed_ranges(103.0, text),
                                        range_binary(100.0) + compressed_ranges(100.0, text) + compressed_ranges(103.0, text)}) {
            WarningLog none;
            const RawInput mixed = read_raw_input(write("mixed.gps", both), {}, none);
            ASSERT_EQ(mixed.observations.epochs.size(), 2U);
            EXPECT_EQ(mixed.observations.observations[0].pseudorange, ranges[0].psr);
            EXPECT_EQ(none.summary().size(), 1U) << "only the unknown signals";
        }
    }
}

TEST_F(Novatel, TheCompressedRecordOfTheManual) {
    // Example of RANGECMP, GPS 26; that of RANGE is 38 s earlier [NovAtelOEM7:RANGE, RANGECMP]
    const double psr = 24'101'771.233, adr = -126'655'684.483, doppler = 2806.247;
    WarningLog warnings;
    const RawInput raw = read_raw_input(
        write("m.gps", ascii("RANGECMPA", 512'487.0, "1,04dc1018c2e70a40d6a37b0b9fb702f5531a616f20030000")), {}, warnings);
    ASSERT_EQ(raw.observations.observations.size(), 1U);
    const gnss::SignalObservation& o = raw.observations.observations[0];
    EXPECT_EQ(gnss::name_of(o.satellite), "G26");
    EXPECT_EQ(o.cn0, 45.0);
    const double cycles = 38.0 * 0.5 * (doppler + o.doppler);
    EXPECT_NEAR(-o.phase, adr + cycles, 3.0);
    EXPECT_NEAR(o.pseudorange, psr - cycles * gnss::speed_of_light / gnss::l1_frequency, 2.0);
}

TEST_F(Novatel, WhatACompressedRecordLeavesOpen) {
    constexpr std::uint64_t longest = (1U << 21) - 1;
    const auto at = [&](double t, std::uint64_t lock) { return compressed(t, {compressed_record(ranges[0], lock, 0)}, false); };
    WarningLog warnings;
    const RawInput held = read_raw_input(
        write("lock.gps", at(100.0, longest - 32) + at(101.0, longest) + at(102.0, longest) + at(103.0, 16) + at(104.0, 48)), {},
        warnings);
    std::vector<int> lost;
    for (const gnss::SignalObservation& o : held.observations.observations) lost.push_back(o.loss_of_lock);
    EXPECT_EQ(lost, (std::vector{1, 0, 0, 1, 0})) << "the counter of the time of lock stops at 18 h";
    // a frequency number of zero: old firmware has none, new firmware means channel -7
    Range other = ranges[1];
    other.prn = 38;
    for (const int field : {0, 8}) {
        const RawInput raw = read_raw_input(
            write("glo.gps", compressed(100.0, {compressed_record(ranges[1], 1, 0), compressed_record(other, 1, field)}, false)),
            {}, warnings);
        EXPECT_EQ(raw.observations.channels.of_slot[19], field == 0 ? gnss::unknown_channel : -7);
        EXPECT_EQ(raw.observations.channels.of_slot[1], field == 0 ? gnss::unknown_channel : 1);
        EXPECT_NEAR(raw.observations.observations[1].phase, -ranges[1].adr, 0.01);
    }
    std::string cut;
    put(cut, std::uint32_t{2});
    cut += compressed_record(ranges[0], 1, 0) + "abc";
    EXPECT_EQ(read_raw_input(write("cut.gps", binary(140, 1.0, cut)), {}, warnings).observations.observations.size(), 1U);
    EXPECT_TRUE(read_raw_input(write("bad.gps", ascii("RANGECMPA", 1.0, "1,04dc10zz") + range_ascii(2.0)), {}, warnings)
                    .observations.epochs.size() == 1U);
}

std::string one_range(double tow, double locked) {
    return ascii("RANGEA", tow,
                 fmt::format("1,7,0,21485793.442,0.050,-112908605.801,0.010,651.783,44.0,{:.3f},{:08x}", locked, locked_all));
}

TEST_F(Novatel, OneEpochStampedTooLateIsLeftOutAndNotAllBehindIt) {
    WarningLog warnings;
    const RawInput raw =
        read_raw_input(write("late.gps", one_range(100.0, 50.0) + one_range(101.0, 51.0) + one_range(9000.0, 1.0) +
                                             one_range(102.0, 2.0) + one_range(103.0, 3.0)),
                       {}, warnings);
    ASSERT_EQ(raw.observations.epochs.size(), 4U);
    EXPECT_EQ(raw.observations.observations.size(), 4U);
    EXPECT_EQ(raw.observations.epochs[2].time, Time::from_gps(log_week, 102.0));
    std::vector<int> lost;
    for (const gnss::ObservationEpoch& e : raw.observations.epochs) lost.push_back(raw.observations.of(e)[0].loss_of_lock);
    EXPECT_EQ(lost, (std::vector{1, 0, 1, 0})) << "the loss of lock in the epoch that is left out is told by the next";
    expect_parts(fmt::format("{}", fmt::join(warnings.summary(), " ")), {"stamped later"});
}

TEST_F(Novatel, TheTimeOfLockHasSinglePrecision) {
    WarningLog warnings;  // steps of a sixteenth of a second beyond six days
    const RawInput raw = read_raw_input(
        write("lock.gps", one_range(100.0, 600'000.094) + one_range(100.06, 600'000.154) + one_range(101.0, 0.5)), {}, warnings);
    std::vector<int> lost;
    for (const gnss::ObservationEpoch& e : raw.observations.epochs) lost.push_back(raw.observations.of(e)[0].loss_of_lock);
    EXPECT_EQ(lost, (std::vector{1, 0, 1}));
}

TEST_F(Novatel, EphemeridesAreAlikeInAsciiAndBinary) {
    const std::vector<double> orbit = {36'000.0, 26'560'211.4, 4.83e-9, -2.3,    2.5e-3, 2.7,      -3.7e-7, 8.6e-6,
                                       209.4,    -7.3,         -4.5e-8, -5.4e-8, 0.95,   -5.0e-10, 1.1,     -8.0e-9};
    std::string body, text = "14,35856.0,0,54,54,2244,2244";
    put(body, std::uint32_t{14}), put(body, 35'856.0);
    for (const std::uint32_t v : {0U, 54U, 54U, 2244U, 2244U}) put(body, v);
    for (const double v : orbit) put(body, v), text += fmt::format(",{:.15e}", v);
    put(body, std::uint32_t{566});
    for (const double v : {36'000.0, -7.9e-9, -5.35e-5, 7.4e-12, 0.0}) put(body, v);
    put(body, std::uint32_t{1}), put(body, 1.45e-4), put(body, 4.0);
    text += ",566,36000.0,-7.9e-09,-5.35e-05,7.4e-12,0.0,TRUE,1.45e-04,4.0";
    const std::string glonass =
        "43,8,1,0,2244,35118000,10782,792,0,0,87,0,9.02e+06,-6.145e+06,2.307e+07,-1.5e+03,2.3e+03,1.2e+03,2.7e-06,-2.7e-06,-1.8e-06,-2.0e-04,-5.5e-09,1.8e-12,78810,3,2,2,13";
    for (const bool ascii_form : {true, false}) {
        const auto file = write("eph.gps", (ascii_form ? ascii("GPSEPHEMA", 35'200.0, text) : binary(7, 35'200.0, body)) +
                                               ascii("GLOEPHEMERISA", 35'200.0, glonass));
        WarningLog warnings;
        const RawInput raw = read_raw_input(file, {}, warnings);
        ASSERT_EQ(raw.navigation.kepler.size(), 1U);
        const gnss::KeplerEphemeris& k = raw.navigation.kepler[0];
        EXPECT_EQ(gnss::name_of(k.satellite), "G14");
        EXPECT_EQ(k.toe, Time::from_gps(log_week, 36'000.0));
        EXPECT_EQ(k.toc, k.toe);
        EXPECT_NEAR(k.sqrt_a, std::sqrt(26'560'211.4), 1e-9);
        EXPECT_EQ(k.omega_dot, -8.0e-9);
        EXPECT_EQ(k.group_delay[0], -7.9e-9);
        EXPECT_EQ(k.af0, -5.35e-5);
        EXPECT_EQ(k.iodc, 566);
        EXPECT_EQ(k.accuracy, 2.0);
        ASSERT_EQ(raw.navigation.glonass.size(), 1U);
        const gnss::GlonassEphemeris& g = raw.navigation.glonass[0];
        EXPECT_EQ(g.satellite.number, 6);
        EXPECT_EQ(g.channel, 1);
        EXPECT_EQ(g.toe, Time::from_gps(log_week, 35'118.0));
        EXPECT_EQ(g.clock, 2.0e-4) << "minus tau";
        EXPECT_EQ(g.position.z(), 2.307e7);
        EXPECT_TRUE(warnings.empty());
    }
}

std::string best(const char* name, const char* type, double lat) {
    return ascii(
        name, 100.0,
        fmt::format("SOL_COMPUTED,{},{},-114.0,1000.0,-16.0,WGS84,0.5,0.5,1.0,\"\",0.0,0.0,20,18,18,0,00,00,00,11", type, lat));
}

TEST_F(Novatel, FixesWithoutTheReceiversOwnIntegrationComeFirst) {
    const auto file = write(
        "span.gps", best("BESTPOSA", "INS_PPP", 51.0) + best("BESTGNSSPOSA", "PPP", 52.0) + best("BESTPOSA_1", "SINGLE", 50.0));
    WarningLog warnings;
    const StreamLog log = format_named("novatel")->read(TextInput(file), warnings);
    ASSERT_EQ(log.streams.size(), 2U);
    EXPECT_EQ(log.streams[0].name, "gnss");
    EXPECT_EQ(log.streams[0].find("lat_deg")->values, std::vector<double>{52.0});
    EXPECT_EQ(log.streams[1].rows(), 1U) << "that of the second antenna is left out";
    EXPECT_EQ(log.streams[1].fix.at(0), FixType::Differential);
}

TEST_F(Novatel, VelocitiesAreOlderThanTheirLogsByTheirLatency) {
    std::string body;
    for (const std::uint32_t v : {0U, 8U}) put(body, v);
    put(body, 0.15F), put(body, 0.0F);
    for (const double v : {5.0, 90.0, 0.25}) put(body, v);
    put(body, 0.0F);
    for (const bool text : {true, false}) {
        const std::string velocity = text
                                         ? ascii("BESTVELA", 100.0, "SOL_COMPUTED,DOPPLER_VELOCITY,0.150,0.000,5.0,90.0,0.25,0.0")
                                         : binary(99, 100.0, body);
        WarningLog warnings;
        const StreamLog log =
            format_named("novatel")->read(TextInput(write("oem.gps", best("BESTPOSA", "SINGLE", 51.0) + velocity)), warnings);
        const std::string table = table_text(*log.find("gnss"), log.clock);
        const std::vector<GnssFix> fixes = read_gnss_csv(TextInput::memory(table, "fixes"), {}, warnings).fixes;
        ASSERT_EQ(fixes.size(), 1U);
        EXPECT_NEAR(fixes[0].velocity_n.y(), 5.0, 1e-9);
        EXPECT_NEAR(fixes[0].velocity_age, 0.15, 1e-6);
        EXPECT_EQ(fixes[0].position_age, 0.0);
    }
}

TEST_F(Novatel, ImuLogsThatCannotBeUsedAreNotTakenForOnes) {
    const std::string raw = ascii("RAWIMUA", 100.0, "2244,100.005,00000077,98067,0,0,0,0,0"),
                      sol = best("BESTPOSA", "SINGLE", 51.0);
    const auto read = [&](const std::string& text) {
        WarningLog warnings;
        const StreamLog log = format_named("novatel")->read(TextInput(write("x.gps", text)), warnings);
        return std::pair(log, fmt::format("{}", fmt::join(warnings.summary(), " ")));
    };
    const auto [corrected, why] = read(sol + ascii("CORRIMUDATAA", 100.0, "2244,100.0,1e-5,2e-5,3e-5,1e-4,2e-4,3e-4"));
    EXPECT_EQ(corrected.find("imu"), nullptr) << "gravity is taken out of it";
    expect_parts(why, {"without gravity"});
    const auto [unknown, reason] = read(sol + raw);
    EXPECT_EQ(unknown.find("imu"), nullptr);
    expect_parts(reason, {"does not state the type of its IMU"});
    const auto [known, nothing] = read(
        sol + "#RXCONFIGA,COM1,0,80.0,APPROXIMATE,2244,1.0,0,0,0;#CONNECTIMUA,COM1,0;COM3,IMU_HG4930_AN01*00000000\r\n" + raw);
    ASSERT_NE(known.find("imu"), nullptr);
    EXPECT_NEAR(known.find("imu")->find("dv_z_m_s")->values.at(0), -98'067.0 * 0x1p-29, 1e-15);
    const auto [aligning, none] =
        read(sol + ascii("INSPVAA", 100.0, "2244,100.0,51.0,-114.0,1000.0,0.0,0.0,0.0,0.0,0.0,0.0,INS_ALIGNING"));
    EXPECT_EQ(aligning.find("reference"), nullptr) << "an attitude that is only being found";
}

TEST_F(Novatel, ALogThatHoldsAnotherIsNotDamaged) {
    const std::string held = "#COMA,COM1,71,47.5,APPROXIMATE,2244,1.0,02020000,0,16809;COM1,115200,N,8,1,N,OFF,ON";
    const std::string config =
        ascii("RXCONFIGA", 99.0, fmt::format("{}*{:08x}", held, ~test::novatel_crc(std::string_view(held).substr(1))));
    std::string damaged = config;
    damaged[damaged.find("115200")] = '9';
    WarningLog warnings;
    (void)format_named("novatel")->read(TextInput(write("a.gps", config + best("BESTPOSA", "SINGLE", 51.0))), warnings);
    EXPECT_TRUE(warnings.empty()) << fmt::format("{}", fmt::join(warnings.summary(), " "));
    const StreamLog log =
        format_named("novatel")->read(TextInput(write("b.gps", damaged + best("BESTPOSA", "SINGLE", 51.0))), warnings);
    EXPECT_EQ(log.find("gnss")->rows(), 1U);
    expect_parts(fmt::format("{}", fmt::join(warnings.summary(), " ")), {"b.gps", "damaged logs"});
}

TEST_F(Novatel, RawImuBeforeTheLogNamesTheImuIsKept) {
    const auto raw = [](double t) { return ascii("RAWIMUA", t, fmt::format("2244,{},00000077,98067,0,0,0,0,0", t)); };
    WarningLog warnings;
    const StreamLog log = format_named("novatel")->read(
        TextInput(
            write("x.gps", raw(100.0) + raw(101.0) + ascii("INSCONFIGA", 101.5, "HG4930_AN01,0,20,20,AUTOMOTIVE") + raw(102.0))),
        warnings);
    ASSERT_NE(log.find("imu"), nullptr);
    EXPECT_EQ(log.find("imu")->rows(), 3U);
    EXPECT_TRUE(warnings.empty()) << fmt::format("{}", fmt::join(warnings.summary(), " "));
}

TEST_F(Novatel, WhatIsNoFixOfItsOwnIsSaid) {
    const auto read = [&](const std::string& text) {
        WarningLog warnings;
        const StreamLog log = format_named("novatel")->read(TextInput(write("x.gps", text)), warnings);
        return std::pair(log.find("gnss")->fix.at(0), fmt::format("{}", fmt::join(warnings.summary(), " ")));
    };
    EXPECT_EQ(read(best("BESTPOSA", "PROPAGATED", 51.0)).first, FixType::None) << "without measurements";
    const auto [fix, blended] = read(best("BESTPOSA", "INS_RTKFIXED", 51.0));
    EXPECT_EQ(fix, FixType::RtkFixed);
    expect_parts(blended, {"own integration", "BESTGNSSPOS"});
    EXPECT_EQ(read(best("BESTPOSA", "INS_RTKFIXED", 51.0) + best("BESTGNSSPOSA", "NARROW_INT", 51.0)).second, "");
    const std::string packed = binary(1273, 100.0, std::string(28, '\0'));
    expect_parts(read(best("BESTPOSA", "SINGLE", 51.0) + packed).second, {"RANGECMP2", "not read"});
    EXPECT_EQ(read(best("BESTPOSA", "SINGLE", 51.0) + packed + one_range(100.0, 1.0)).second, "") << "the same is there in full";
}

std::string imr(bool big, std::int32_t increments, double time, std::int32_t utc = 2) {
    std::string out("$IMURAW\0", 8);
    const auto number = [&](auto value) {
        std::string bytes;
        put(bytes, value);
        if (big) std::ranges::reverse(bytes);
        out += bytes;
    };
    out += big ? '\1' : '\0';
    number(8.8), number(increments), number(increments), number(100.0), number(2.0e-6), number(1.0e-6), number(utc),
        number(std::int32_t{0}), number(0.0);
    out.resize(512, '\0');
    for (int i = 0; i < 3; ++i) {
        number(time + 0.01 * i);
        for (const std::int32_t v : {100, -200, 300, 4000, -5000, -98067}) number(v);
    }
    return out;
}

TEST_F(Novatel, WaypointImrInBothByteOrders) {
    for (const bool big : {false, true}) {
        WarningLog warnings;
        const auto file = write("x.imr", imr(big, 1, 1000.0));
        ASSERT_EQ(format_of(file)->name, "imr");
        const StreamLog log = format_of(file)->read(TextInput(file), warnings);
        const Stream& s = *log.find("imu");
        EXPECT_EQ(log.clock, Clock::SecondsOfWeek);
        EXPECT_EQ(s.rows(), 3U);
        EXPECT_EQ(s.time_ns[1], 1'000'010'000'000);
        EXPECT_NEAR(s.find("dtheta_y_rad")->values[0], -200.0 * 2e-6 * units::deg, 1e-18);
        EXPECT_NEAR(s.find("dv_z_m_s")->values[0], -0.098067, 1e-12);
        EXPECT_TRUE(warnings.empty());
    }
    WarningLog warnings;
    const auto rates = write("r.imr", imr(false, 0, 1000.0, 1) + "abc");
    const StreamLog log = format_of(rates)->read(TextInput(rates), warnings);
    EXPECT_NEAR(log.find("imu")->find("gyro_x_rad_s")->values[0], 2e-4 * units::deg, 1e-18);
    EXPECT_EQ(log.find("imu")->time_ns[0], 1'018'000'000'000) << "UTC";
    expect_parts(fmt::format("{}", fmt::join(warnings.summary(), " ")), {"cut at byte 608", "18 leap seconds added"});
    std::string broken = imr(false, 1, 1000.0);
    broken.replace(33, 8, std::string(8, '\xff'));
    expect_parts(message_of([&] { (void)format_named("imr")->read(TextInput(write("b.imr", broken)), warnings); }),
                 {"b.imr", "byte 25", "cannot be"});
    expect_parts(message_of([&] { (void)format_named("imr")->read(TextInput(write("c.imr", broken.substr(0, 500))), warnings); }),
                 {"c.imr", "cut", "500 bytes"});
}

}  // namespace
}  // namespace schuler::io
