// RINEX observations and navigation, compressed or damaged.
#include "schuler/io/rinex/rinex.h"

#include "schuler/io/rinex/compact_rinex.h"
#include "schuler/io/rinex/sp3.h"

#include "io/io_fixture.h"

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

using gnss::SatelliteId;
using gnss::Signal;
using gnss::System;
using test::expect_parts;
using test::message_of;

std::string label(const std::string& text, const std::string& name) {
    return text + std::string(60 - text.size(), ' ') + name + "\n";
}

std::string header3() {
    return label("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE") +
           label("  4000000.1250   700000.2500  4900000.5000", "APPROX POSITION XYZ") +
           label("G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES") + label("R    2 C1C C2P", "SYS / # / OBS TYPES") +
           label("C    2 C1I C7I", "SYS / # / OBS TYPES") + label("  2 R05  1 R06 -4", "GLONASS SLOT / FRQ #") +
           label("", "END OF HEADER");
}
const std::string epoch1 = "> 2023 01 08 10 00  0.1234567  0  2\n";
const std::string g08 = "G08  25000123.456 9 131000456.78919     -1500.125 9        45.625 9\n";
const std::string r06 = "R06  20000000.125                  \n";

class Rinex : public test::IoTest {
protected:
    RinexObservations read(const std::string& text) { return read_rinex_observations(TextInput::memory(text, "a.obs"), log); }
    RinexNavigation navigation(const std::string& text) { return read_rinex_navigation(TextInput::memory(text, "a.nav"), log); }
    WarningLog log;
};

TEST_F(Rinex, ObservationsOfVersion3) {
    const RinexObservations r = read(header3() + epoch1 + g08 + r06);
    ASSERT_EQ(r.log.epochs.size(), 1U);
    EXPECT_EQ(r.log.epochs[0].time.ns, (std::int64_t{2244} * 604800 + 36000) * 1'000'000'000 + 123'456'700);
    ASSERT_EQ(r.log.observations.size(), 2U);
    const gnss::SignalObservation& o = r.log.observations[0];
    EXPECT_EQ(o.satellite, (SatelliteId{System::Gps, 8}));
    EXPECT_EQ(o.signal, (Signal{'1', 'C'}));
    EXPECT_EQ(o.pseudorange, 25000123.456);
    EXPECT_EQ(o.phase, 131000456.789);
    EXPECT_EQ(o.loss_of_lock, 1);
    EXPECT_EQ(o.strength, 9);
    EXPECT_EQ(o.doppler, -1500.125);
    EXPECT_EQ(o.cn0, 45.625);
    EXPECT_EQ(r.log.observations[1].pseudorange, 20000000.125);
    EXPECT_TRUE(std::isnan(r.log.observations[1].phase));
    EXPECT_EQ(r.log.channels.of_slot[6], -4);
    EXPECT_EQ(r.log.channels.of_slot[7], gnss::unknown_channel);
    EXPECT_EQ(r.log.approximate.r, Eigen::Vector3d(4000000.1250, 700000.2500, 4900000.5000));
    EXPECT_TRUE(log.empty());
    // some writers call QZSS Q
    const RinexObservations q = read(label("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE") +
                                     label("Q    1 C1C", "SYS / # / OBS TYPES") + label("", "END OF HEADER") +
                                     "> 2023 01 08 10 00  0.0000000  0  1\nQ02  38000000.000\n");
    EXPECT_EQ(q.log.observations.at(0).satellite, (SatelliteId{System::Qzss, 2}));
    // the first band of BeiDou in early files is B1I
    const RinexObservations c = read(header3() + "> 2023 01 08 10 00  0.0000000  0  1\nC07  36000000.000    36000001.000\n");
    EXPECT_EQ(c.log.observations.at(0).signal, (Signal{'2', 'I'}));
}

TEST_F(Rinex, DamageIsSkippedCountedAndPlaced) {
    std::string torn = g08;
    torn[8] = 'x';
    const std::string later = "> 2023 01 08 10 00  1.0000000  0  1\n", cut = "> 2023 01 08 10 00  2.0000000  0  3\n";
    const RinexObservations r = read(header3() + epoch1 + torn + r06 + "> 2023 13 08 10 00  0.5000000  0  1\n" + g08 + later +
                                     g08 + later + g08 + cut + g08 + "> 2023 01 08 10 00  3.0000000  4  1\n" +
                                     label("an event", "COMMENT") + "> 2023 01 08 10 00  4.0000000  0  2\n" + g08);
    // the epochs at 0.12, 1, 2 and 4 s; the second one at 1 s is a repetition
    EXPECT_EQ(r.log.epochs.size(), 4U);
    EXPECT_EQ(r.bad_lines, 1U);
    EXPECT_EQ(r.records.repeated, 1U);
    EXPECT_EQ(r.records.foreign, 1U);
    EXPECT_EQ(r.records.first_bad_line, 9);
    EXPECT_GE(r.records.bad, 3U);
    EXPECT_EQ(r.log.observations.size(), 4U);
    expect_parts(log.summary().at(0), {"a.obs", "line 9"});
}

TEST_F(Rinex, FilesOfVersion2) {
    SKIP_WITHOUT_DATA();
    const RinexObservations r = read_rinex_observations(test::data_folder() / "rtklib_geonet_pair" / "07590920.05o", log);
    EXPECT_EQ(r.log.epochs.size(), 120U);
    EXPECT_EQ(r.log.epochs[0].time, gps_from_calendar({2005, 4, 2, 0, 0, 0.0}));
    const auto first = r.log.of(r.log.epochs[0]);
    ASSERT_EQ(first.size(), 16U);  // eight satellites, L1 C/A and L2 P
    EXPECT_EQ(first[0].satellite, (SatelliteId{System::Gps, 3}));
    EXPECT_EQ(first[0].signal, (Signal{'1', 'C'}));
    EXPECT_EQ(first[0].phase, 55923622.160);
    EXPECT_EQ(first[0].pseudorange, 24767686.375);
    EXPECT_EQ(first[1].signal, (Signal{'2', 'W'}));
    EXPECT_EQ(first[1].phase, 43647388.242);
    EXPECT_EQ(first[1].loss_of_lock, 4);
    EXPECT_EQ(first[1].pseudorange, 24767684.822);
}

TEST_F(Rinex, CompressedFilesGiveTheSame) {
    const std::string text = header3() + epoch1 + g08 + r06;
    const auto path = write_gz("a.obs.gz", text);
    EXPECT_EQ(read_rinex_observations(path, log).log.observations.size(), 2U);
    const std::string whole = content_of(path);
    const auto cut = write("cut.obs.gz", whole.substr(0, whole.size() - 12));
    expect_parts(message_of([&] { (void)read_rinex_observations(cut, log); }), {"cut.obs.gz", "damaged or cut"});
    // Hatanaka: a program of that name stands in for the real one and shows that input, output and failure are passed on
    const std::string compact = label("1.0                 COMPACT RINEX FORMAT", "CRINEX VERS   / TYPE") + text;
    const std::string path_before = std::getenv("PATH");
    write("crx2rnx", "#!/bin/sh\ntail -n +2\n");
    std::filesystem::permissions(folder() / "crx2rnx", std::filesystem::perms::owner_all);
    setenv("PATH", (folder().string() + ":" + path_before).c_str(), 1);
    EXPECT_EQ(read(compact).log.observations.size(), 2U);
    write("crx2rnx", "#!/bin/sh\nexit 3\n");
    expect_parts(message_of([&] { (void)read(compact); }), {"a.obs", "could not decompress"});
    setenv("PATH", "/nowhere", 1);
    expect_parts(message_of([&] { (void)read(compact); }), {"a.obs:1", "crx2rnx is not installed"});
    setenv("PATH", path_before.c_str(), 1);
}

/// Counts of one navigation file of the corpus: Keplerian, GLONASS, SBAS, damaged.
struct Expected {
    const char* file;
    std::size_t kepler, glonass, sbas, bad;
};

TEST_F(Rinex, NavigationOfAllVersionsAndSystems) {
    SKIP_WITHOUT_DATA();
    const auto corpus = test::data_folder() / "parser_corpus";
    for (const Expected& e : std::initializer_list<Expected>{
             {"instinct/RinexNavFile/v2_01/brdc0990.22g", 0, 4, 0, 0},
             {"instinct/RinexNavFile/v2_10/bako3540.22n", 3, 0, 0, 0},
             {"instinct/RinexNavFile/v3_02/INSA11DEU_R_20223182100_01H_01S_EN.rnx", 15, 0, 0, 0},
             {"instinct/RinexNavFile/v3_04/Allo223mA.22h", 0, 0, 3, 0},
             {"instinct/RinexNavFile/v4_00/INS_1581.19P", 9, 1, 2, 0},
             {"rtklib_raw/brdc0910.09g", 0, 912, 0, 0},
             {"rtklib_raw/brdc3050.12q", 96, 0, 0, 0},
         }) {
        const RinexNavigation n = read_rinex_navigation(corpus / e.file, log);
        EXPECT_EQ(n.navigation.kepler.size(), e.kepler) << e.file;
        EXPECT_EQ(n.navigation.glonass.size(), e.glonass) << e.file;
        EXPECT_EQ(n.navigation.sbas.size(), e.sbas) << e.file;
        EXPECT_EQ(n.records.bad, e.bad) << e.file << " line " << n.records.first_bad_line;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus / "instinct/RinexNavFile")) {
        if (!entry.is_regular_file()) continue;
        const bool corrupt = entry.path().string().find("corrupt") != std::string::npos;
        try {
            const RinexNavigation n = read_rinex_navigation(entry.path(), log);
            EXPECT_EQ(n.records.bad > 0, corrupt) << entry.path();
        } catch (const Error& e) {
            EXPECT_TRUE(corrupt) << e.what();
        }
    }
}

TEST_F(Rinex, EphemerisFields) {
    SKIP_WITHOUT_DATA();
    const auto folder = test::data_folder() / "parser_corpus/instinct/RinexNavFile/v4_00";
    const gnss::Navigation n = read_rinex_navigation(folder / "INS_1581.19P", log).navigation;
    const gnss::KeplerEphemeris& g = n.kepler.at(0);
    EXPECT_EQ(g.satellite, (SatelliteId{System::Gps, 1}));
    EXPECT_EQ(g.toe, Time::from_gps(2056, 424800.0));
    EXPECT_EQ(g.toc, g.toe);
    EXPECT_EQ(g.transmission, Time::from_gps(2056, 417618.0));
    EXPECT_EQ(g.af0, -3.462424501777e-05);
    EXPECT_EQ(g.group_delay[0], 5.587935447693e-09);
    EXPECT_EQ(g.iodc, 41);
    EXPECT_EQ(g.fit_interval, 4.0 * 3600.0);
    EXPECT_EQ(n.kepler.at(1).message, gnss::NavMessage::Inav);
    EXPECT_EQ(n.kepler.at(2).message, gnss::NavMessage::Fnav);
    const auto c05 = std::ranges::find(n.kepler, SatelliteId{System::BeiDou, 5}, &gnss::KeplerEphemeris::satellite);
    ASSERT_NE(c05, n.kepler.end());
    EXPECT_EQ(c05->toe, Time::from_gps(2056, 424800.0 + 14.0));
    EXPECT_EQ(c05->group_delay[1], -8.9e-09);
    const gnss::GlonassEphemeris& r = n.glonass.at(0);
    EXPECT_EQ(r.toe, gps_from_utc({2019, 6, 6, 21, 15, 0.0}));
    EXPECT_EQ(r.position.x(), -4091.441894531 * 1000.0);
    EXPECT_EQ(r.velocity.z(), -2.484695434570 * 1000.0);
    EXPECT_EQ(r.clock, 3.091366961598e-04);
    EXPECT_EQ(r.channel, 6);
    EXPECT_EQ(r.l2_delay, -2.793967723846e-09);
    ASSERT_TRUE(n.galileo_ionosphere);
    EXPECT_EQ(n.galileo_ionosphere->a[2], 1.116943359375e-02);
    EXPECT_EQ(n.leap_seconds, 18);
}

TEST_F(Rinex, OtherFilesAreRefusedInOneLine) {
    expect_parts(message_of([&] { (void)read("time_s,lat_deg\n1,2\n"); }), {"a.obs:1", "not a RINEX observation file"});
    expect_parts(message_of([&] { (void)navigation(header3()); }), {"a.nav:1", "not a RINEX navigation file"});
    expect_parts(message_of([&] { (void)read(header3()); }), {"a.obs", "no usable epoch"});
    expect_parts(message_of([&] { (void)read_sp3(TextInput::memory("#x", "a.sp3"), log); }), {"a.sp3:1", "not an SP3"});
}

}  // namespace
}  // namespace schuler::io
