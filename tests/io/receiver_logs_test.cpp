// UBX and RTCM 3 against other programs' decoding of the same logs, and damaged.
#include "schuler/gnss/orbit.h"
#include "schuler/io/receiver/rtcm3.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/rinex/rinex_write.h"

#include "io/io_fixture.h"
#include "io/log_bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

#define SKIP_WITHOUT_CONVBIN() \
    if (std::system("command -v convbin > /dev/null 2>&1") != 0) GTEST_SKIP() << "convbin (package rtklib) is not installed"

namespace schuler::io {
namespace {

using gnss::SatelliteId;
using gnss::SignalObservation;
using gnss::System;
using test::expect_parts;
using test::message_of;

class ReceiverLogs : public test::IoTest {
protected:
    WarningLog log;
};

/// Difference below half of the last digit of RINEX, or both missing.
bool same(double a, double b, double tolerance = 0.00051) {
    return (std::isnan(a) && std::isnan(b)) || std::abs(a - b) < tolerance;
}

/// Compares logs epoch by epoch; indicators of the phase too. `only` limits to one system; `later`: their times are so much later.
void expect_same(const gnss::ObservationLog& ours, const gnss::ObservationLog& theirs, std::optional<System> only = {},
                 Duration later = {}) {
    ASSERT_EQ(ours.epochs.size(), theirs.epochs.size());
    std::size_t differing = 0, indicators = 0, compared = 0;
    // Doppler and C/N0 come as short binary fractions, whose ties (0.0005) the other programs round away from zero
    for (std::size_t i = 0; i < ours.epochs.size(); ++i) {
        ASSERT_EQ(ours.epochs[i].time + later, theirs.epochs[i].time) << i;
        std::map<std::pair<SatelliteId, gnss::Signal>, SignalObservation> known;
        for (const SignalObservation& o : ours.of(ours.epochs[i])) {
            if (!only || o.satellite.system == *only) known[{o.satellite, o.signal}] = o;
        }
        for (const SignalObservation& o : theirs.of(theirs.epochs[i])) {
            if (only && o.satellite.system != *only) continue;
            const auto at = known.find({o.satellite, o.signal});
            ASSERT_NE(at, known.end()) << "epoch " << i << " " << gnss::name_of(o.satellite) << o.signal.band
                                       << o.signal.attribute;
            const SignalObservation& x = at->second;
            // convbin writes Doppler of the first band only
            const bool doppler = (only && std::isnan(o.doppler)) || same(x.doppler, o.doppler, 0.00101);
            const bool equal =
                same(x.pseudorange, o.pseudorange) && same(x.phase, o.phase) && doppler && same(x.cn0, o.cn0, 0.00101);
            if (!equal && differing++ < 3)
                ADD_FAILURE() << "epoch " << i << " " << gnss::name_of(o.satellite) << " " << x.pseudorange - o.pseudorange << " "
                              << x.phase - o.phase << " " << x.doppler - o.doppler << " " << x.cn0 - o.cn0;
            if (std::isfinite(o.phase) && x.loss_of_lock != o.loss_of_lock && indicators++ < 3)
                ADD_FAILURE() << "epoch " << i << " " << gnss::name_of(o.satellite) << o.signal.band << " indicator "
                              << int{x.loss_of_lock} << " and " << int{o.loss_of_lock};
            known.erase(at);
            ++compared;
        }
        EXPECT_TRUE(known.empty()) << "epoch " << i << " " << gnss::name_of(known.begin()->first.first);
    }
    EXPECT_EQ(differing, 0U);
    EXPECT_EQ(indicators, 0U);
    EXPECT_GT(compared, 1000U);
}

TEST_F(ReceiverLogs, UbxBecomesTheReferenceConversion) {
    SKIP_WITHOUT_DATA();
    const auto data = test::data_folder() / "spirent_f9p_static_ubx";
    const UbxLog ubx = read_ubx(data / "f9p.ubx", log);
    EXPECT_EQ(ubx.empty_epochs, 713U);
    EXPECT_EQ(ubx.observations.epochs.size(), 931U);
    EXPECT_EQ(ubx.records.bad, 0U) << ubx.records.first_bad_line;
    // through our own RINEX text and reader, against the other program's text
    const std::string text = rinex_observations_text(ubx.observations);
    const gnss::ObservationLog ours = read_rinex_observations(TextInput::memory(text, "ours.obs"), log).log;
    expect_same(ours, read_rinex_observations(data / "f9p.obs", log).log);
}

TEST_F(ReceiverLogs, UbxSubframesBecomeTheReferenceEphemerides) {
    SKIP_WITHOUT_DATA();
    const auto data = test::data_folder() / "spirent_f9p_static_ubx";
    const std::string text = rinex_navigation_text(read_ubx(data / "f9p.ubx", log).navigation);
    const gnss::Navigation ours = read_rinex_navigation(TextInput::memory(text, "ours.nav"), log).navigation;
    const gnss::Navigation theirs = read_rinex_navigation(data / "f9p.nav", log).navigation;
    std::size_t found = 0, lacking = 0;
    for (const gnss::KeplerEphemeris& t : theirs.kepler) {
        const auto at = std::ranges::find_if(ours.kepler, [&](const gnss::KeplerEphemeris& k) {
            return k.satellite == t.satellite && k.toe == t.toe && k.iode == t.iode && k.message == t.message;
        });
        if (at == ours.kepler.end()) {
            ++lacking;
            continue;
        }
        ++found;
        const auto near = [&](double a, double b) {
            return std::abs(a - b) <= 1e-11 * std::max(std::abs(a), std::abs(b)) + 1e-30;
        };
        EXPECT_TRUE(at->toc == t.toc && near(at->af0, t.af0) && near(at->af1, t.af1) && near(at->af2, t.af2))
            << gnss::name_of(t.satellite);
        EXPECT_TRUE(near(at->sqrt_a, t.sqrt_a) && near(at->e, t.e) && near(at->i0, t.i0) && near(at->omega0, t.omega0) &&
                    near(at->omega, t.omega) && near(at->m0, t.m0) && near(at->delta_n, t.delta_n) &&
                    near(at->omega_dot, t.omega_dot) && near(at->idot, t.idot))
            << gnss::name_of(t.satellite);
        EXPECT_TRUE(near(at->cuc, t.cuc) && near(at->cus, t.cus) && near(at->crc, t.crc) && near(at->crs, t.crs) &&
                    near(at->cic, t.cic) && near(at->cis, t.cis))
            << gnss::name_of(t.satellite);
        EXPECT_TRUE(near(at->group_delay[0], t.group_delay[0]) && near(at->group_delay[1], t.group_delay[1]))
            << gnss::name_of(t.satellite);
        EXPECT_EQ(at->health, t.health) << gnss::name_of(t.satellite);
    }
    EXPECT_EQ(found, 47U);
    EXPECT_EQ(lacking, 0U);
    ASSERT_TRUE(ours.galileo_ionosphere && theirs.galileo_ionosphere);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(ours.galileo_ionosphere->a[i] / theirs.galileo_ionosphere->a[i], 1.0, 1e-3);
    ASSERT_TRUE(ours.klobuchar[0] && theirs.klobuchar[0]);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(ours.klobuchar[0]->alpha[i] / theirs.klobuchar[0]->alpha[i], 1.0, 1e-3);
        EXPECT_NEAR(ours.klobuchar[0]->beta[i] / theirs.klobuchar[0]->beta[i], 1.0, 1e-3);
    }
}

/// A seed of the fuzz target, without the byte that chooses the reader.
std::string seed(const char* name) {
    return schuler::test::content_of(std::filesystem::path(SCHULER_SOURCE_DIR) / "tests/fuzz/corpus/receiver_logs" / name)
        .substr(1);
}

/// Writes the checksum of the message that starts at `at` anew.
void checksum(std::string& bytes, std::size_t at) {
    unsigned a = 0, b = 0;
    const std::size_t end = at + 6 + static_cast<unsigned char>(bytes[at + 4]);
    for (std::size_t i = at + 2; i < end; ++i) {
        a += static_cast<unsigned char>(bytes[i]);
        b += a;
    }
    bytes[end] = static_cast<char>(a), bytes[end + 1] = static_cast<char>(b);
}

TEST_F(ReceiverLogs, UbxFramesOfGlonassAndBeiDouAgainstConvbin) {
    SKIP_WITHOUT_CONVBIN();
    const auto file = write("seed.ubx", seed("ubx"));
    const std::string command = "convbin -r ubx -v 3.04 -o " + (folder() / "s.obs").string() + " -n " +
                                (folder() / "s.nav").string() + " " + file.string() + " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const gnss::Navigation ours = read_ubx(file, log).navigation;
    const gnss::Navigation theirs = read_rinex_navigation(folder() / "s.nav", log).navigation;
    std::size_t compared = 0;
    for (const gnss::KeplerEphemeris& t : theirs.kepler) {
        const auto k = std::ranges::find(ours.kepler, t.satellite, &gnss::KeplerEphemeris::satellite);
        ASSERT_NE(k, ours.kepler.end()) << gnss::name_of(t.satellite);
        ++compared;
        EXPECT_TRUE(k->toe == t.toe && k->toc == t.toc && k->iode == t.iode && k->iodc == t.iodc && k->health == t.health);
        const auto numbers = [](const gnss::KeplerEphemeris& e) {
            return std::array{
                e.af0, e.af1, e.m0,  e.delta_n, e.e,   e.sqrt_a, e.omega0,    e.i0,       e.omega,          e.cuc,
                e.cus, e.cic, e.cis, e.crc,     e.crs, e.idot,   e.omega_dot, e.accuracy, e.group_delay[0], e.group_delay[1]};
        };
        const auto a = numbers(*k), b = numbers(t);
        for (std::size_t i = 0; i < a.size(); ++i)
            EXPECT_NEAR(a[i], b[i], 1e-11 * std::abs(b[i])) << gnss::name_of(t.satellite) << " " << i;
    }
    EXPECT_EQ(compared, 3U);  // G03, C03 (D2), C21 (D1)
    ASSERT_EQ(theirs.glonass.size(), 1U);
    const gnss::GlonassEphemeris &a = ours.glonass.at(0), &b = theirs.glonass[0];
    EXPECT_EQ(a.toe, b.toe);
    EXPECT_LT((a.position - b.position).norm(), 1e-3);
    EXPECT_LT((a.velocity - b.velocity).norm(), 1e-6);
    EXPECT_LT((a.acceleration - b.acceleration).norm(), 1e-15);
    EXPECT_NEAR(a.clock, b.clock, 1e-15);
    EXPECT_NEAR(a.clock_rate, b.clock_rate, 1e-24);
    EXPECT_TRUE(a.channel == b.channel && a.health == b.health && a.age_days == b.age_days);
}

TEST_F(ReceiverLogs, UbxEphemeridesSurviveRinex) {
    const gnss::Navigation before = read_ubx(TextInput::memory(seed("ubx"), "a.ubx"), log).navigation;
    const std::string text = rinex_navigation_text(before);
    const gnss::Navigation after = read_rinex_navigation(TextInput::memory(text, "a.nav"), log).navigation;
    ASSERT_EQ(after.kepler.size(), before.kepler.size());
    for (const gnss::KeplerEphemeris& b : before.kepler) {
        const auto a = std::ranges::find(after.kepler, b.satellite, &gnss::KeplerEphemeris::satellite);
        ASSERT_NE(a, after.kepler.end());
        EXPECT_TRUE(a->message == b.message && a->toe == b.toe && a->toc == b.toc && a->transmission == b.transmission)
            << gnss::name_of(b.satellite);
        EXPECT_TRUE(a->iode == b.iode && a->iodc == b.iodc && a->health == b.health && a->fit_interval == b.fit_interval)
            << gnss::name_of(b.satellite);
    }
    // the time of a GLONASS frame is written in seconds of the week of UTC
    EXPECT_NE(text.find("R05 2023 01 08 09 45 00"), std::string::npos);
    EXPECT_EQ(text.substr(text.find("R05 ") + 61, 19), " 3.598200000000E+04");
}

/// F/NAV has the orbits of I/NAV, and clocks of another pair of carriers; CNAV is another fit of the same orbit and clock.
TEST_F(ReceiverLogs, UbxFramesOfOtherCarriersAgreeWithThoseOfTheFirst) {
    SKIP_WITHOUT_DATA();
    const gnss::Navigation n = read_ubx(test::data_folder() / "walk_0827/gnss.ubx", log).navigation;
    using gnss::NavMessage;
    int galileo = 0, gps = 0;
    for (const gnss::KeplerEphemeris& a : n.kepler) {
        for (const gnss::KeplerEphemeris& b : n.kepler) {
            if (a.satellite != b.satellite) continue;
            const Time t = a.transmission;
            const gnss::SatelliteState one = satellite_state(a, t), other = satellite_state(b, t);
            const auto clock = [&](const gnss::SatelliteState& s, const gnss::KeplerEphemeris& k) {
                return gnss::speed_of_light * (s.clock - group_delay(k, {'1', 'C'}));
            };
            if (a.message == NavMessage::Fnav && b.message == NavMessage::Inav && a.iode == b.iode) {
                ++galileo;
                EXPECT_EQ(a.toe, b.toe);
                EXPECT_EQ(one.position.r, other.position.r) << gnss::name_of(a.satellite);
                EXPECT_NEAR(clock(one, a), clock(other, b), 0.5);
                EXPECT_EQ(a.group_delay[0], b.group_delay[0]);
                EXPECT_EQ(a.health == 0, b.health == 0) << gnss::name_of(a.satellite);  // E14, on its eccentric orbit, is marked
            }
            if (a.message == NavMessage::Cnav && b.message == NavMessage::Lnav) {
                ++gps;
                EXPECT_LT((one.position.r - other.position.r).norm(), 1.0) << gnss::name_of(a.satellite);
                EXPECT_LT((one.velocity - other.velocity).norm(), 1e-3);
                EXPECT_NEAR(clock(one, a), clock(other, b), 0.5);
            }
        }
    }
    EXPECT_GT(galileo, 2);
    EXPECT_GT(gps, 1);
}

TEST_F(ReceiverLogs, UbxFramesAreDatedByTheFixToo) {
    // without RXM-RAWX
    std::string bytes = seed("ubx");
    const std::string rawx("\xb5\x62\x02\x15", 4);
    for (std::size_t at = bytes.find(rawx); at != std::string::npos; at = bytes.find(rawx)) {
        const std::size_t length = static_cast<unsigned char>(bytes[at + 4]) + 256U * static_cast<unsigned char>(bytes[at + 5]);
        bytes.erase(at, length + 8);
    }
    const UbxLog r = read_ubx(TextInput::memory(bytes, "a.ubx"), log);
    EXPECT_TRUE(r.observations.epochs.empty());
    EXPECT_EQ(r.navigation.kepler.size(), 4U);
    EXPECT_EQ(r.navigation.kepler.at(0).toe, Time::from_gps(2244, 36000.0));
}

TEST_F(ReceiverLogs, GlonassStringsWithAWrongBitAreDamaged) {
    const std::string good = seed("ubx"), head("\xb5\x62\x02\x13\x18\x00\x06\x05", 8);
    std::size_t strings = 0;
    for (std::size_t at = good.find(head); at != std::string::npos; at = good.find(head, at + 1), ++strings) {
        std::string bytes = good;
        const std::size_t payload = at + 6, first_word = payload + 8;
        bytes[first_word + strings] = static_cast<char>(bytes[first_word + strings] ^ 0x10);
        checksum(bytes, at);
        const UbxLog r = read_ubx(TextInput::memory(bytes, "a.ubx"), log);
        EXPECT_EQ(r.records.bad, 1U);
        EXPECT_EQ(r.records.first_bad_line, static_cast<long>(at));
        EXPECT_TRUE(r.navigation.glonass.empty());
    }
    EXPECT_EQ(strings, 4U);
}

TEST_F(ReceiverLogs, UbxDamageIsSkippedAndPlaced) {
    const std::string good = seed("ubx");
    const auto read = [&](const std::string& bytes) { return read_ubx(TextInput::memory(bytes, "a.ubx"), log); };
    const UbxLog whole = read(good);
    EXPECT_EQ(whole.observations.epochs.size(), 2U);
    ASSERT_EQ(whole.fixes.size(), 1U);
    EXPECT_EQ(whole.fixes[0].time, Time::from_gps(2244, 36000.0));
    EXPECT_NEAR(whole.fixes[0].position.lat, 30.0 * 0.017453292519943295, 1e-12);
    EXPECT_EQ(whole.fixes[0].velocity_n, Eigen::Vector3d(0.010, -0.020, 0.005));
    EXPECT_TRUE(log.empty());
    std::string flipped = good;
    flipped[20] = static_cast<char>(flipped[20] ^ 1);
    const UbxLog one = read(flipped + good.substr(0, 40));
    EXPECT_EQ(one.observations.epochs.size(), 1U);
    EXPECT_EQ(one.records.bad, 2U);
    EXPECT_EQ(one.records.first_bad_line, 0);
    expect_parts(log.summary().at(0), {"a.ubx", "damaged UBX", "byte 0"});
    EXPECT_EQ(read(good + good).records.repeated, 2U);
    expect_parts(message_of([&] { (void)read("$GPGGA,no ubx here"); }), {"a.ubx", "no usable UBX message"});
    const std::string sensors = test::ubx(0x10, 0x02, std::string(12, '\0')) + test::ubx(0x28, 0x00, std::string(72, '\0'));
    expect_parts(message_of([&] { (void)read(sensors + sensors + test::ubx(0x0a, 0x77, "x")); }),
                 {"a.ubx", "neither raw measurements (RXM-RAWX) nor fixes (NAV-PVT)", "ESF-MEAS (2), HNR-PVT (2), 0A-77 (1)"});
}

TEST_F(ReceiverLogs, Rtcm3AgainstConvbin) {
    SKIP_WITHOUT_DATA();
    SKIP_WITHOUT_CONVBIN();
    const auto file = test::data_folder() / "parser_corpus/rtklib_raw/GMSD7_20121014.rtcm3";
    // the ephemerides date the stream, though it is read in another year
    const Rtcm3Log rtcm = read_rtcm3(file, gps_from_utc({2026, 11, 21, 0, 0, 0.0}), log);
    ASSERT_EQ(rtcm.observations.epochs.size(), 257U);
    EXPECT_GE(rtcm.records.bad, 1U);
    EXPECT_GT(rtcm.records.first_bad_line, 261'000);
    const std::string command = "convbin -r rtcm3 -tr 2012/10/13 23:59:00 -v 3.04 -f 5 -od -os -o " +
                                (folder() / "g.obs").string() + " -n " + (folder() / "g.nav").string() + " " + file.string() +
                                " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    // convbin takes the sender's BeiDou messages by the letter, 14 s after the others of their epoch, and keeps those only
    const std::string text = rinex_observations_text(rtcm.observations);
    const gnss::ObservationLog ours = read_rinex_observations(TextInput::memory(text, "ours.obs"), log).log;
    expect_same(ours, read_rinex_observations(folder() / "g.obs", log).log, System::BeiDou, Duration{14'000'000'000});
    const gnss::Navigation theirs = read_rinex_navigation(folder() / "g.nav", log).navigation;
    std::size_t found = 0;
    for (const gnss::KeplerEphemeris& t : theirs.kepler) {
        for (const gnss::KeplerEphemeris& k : rtcm.navigation.kepler) {
            if (k.satellite != t.satellite || k.toe != t.toe) continue;
            ++found;
            EXPECT_NEAR(k.m0, t.m0, 1e-11);
            EXPECT_NEAR(k.af0, t.af0, 1e-15);
            EXPECT_NEAR(k.crs, t.crs, 1e-9);
            EXPECT_EQ(k.iode, t.iode);
            EXPECT_EQ(k.toc, t.toc);
        }
    }
    EXPECT_EQ(found, theirs.kepler.size());
    EXPECT_GT(found, 5U);
    for (const gnss::GlonassEphemeris& t : theirs.glonass) {
        const auto at = std::ranges::find_if(rtcm.navigation.glonass,
                                             [&](const auto& g) { return g.satellite == t.satellite && g.toe == t.toe; });
        ASSERT_NE(at, rtcm.navigation.glonass.end()) << gnss::name_of(t.satellite);
        EXPECT_LT((at->position - t.position).norm(), 1e-3);
        EXPECT_LT((at->velocity - t.velocity).norm(), 1e-6);
        EXPECT_NEAR(at->clock, t.clock, 1e-15);
        EXPECT_EQ(at->channel, t.channel);
    }
    EXPECT_GT(theirs.glonass.size(), 5U);
}

/// Messages 1012 and 1005 of a base station.
TEST_F(ReceiverLogs, Rtcm3BeforeMultipleSignalMessagesAgainstConvbin) {
    SKIP_WITHOUT_DATA();
    SKIP_WITHOUT_CONVBIN();
    const auto file = test::data_folder() / "parser_corpus/rtklib_raw/testglo.rtcm3";
    const Rtcm3Log rtcm = read_rtcm3(file, gps_from_utc({2026, 11, 21, 0, 0, 0.0}), log);
    EXPECT_EQ(rtcm.observations.epochs.size(), 186U);
    EXPECT_EQ(rtcm.records.bad, 0U);
    EXPECT_GT(rtcm.navigation.glonass.size(), 3U);
    EXPECT_GT(rtcm.navigation.kepler.size(), 3U);
    EXPECT_LT((rtcm.observations.approximate.r - Eigen::Vector3d(-3869297.5138, 3436571.3345, 3717369.3757)).norm(), 1e-4);
    const std::string command = "convbin -r rtcm3 -tr 2009/12/18 00:00:01 -v 3.04 -f 5 -od -os -o " +
                                (folder() / "l.obs").string() + " " + file.string() + " > /dev/null 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const std::string text = rinex_observations_text(rtcm.observations);
    const gnss::ObservationLog ours = read_rinex_observations(TextInput::memory(text, "ours.obs"), log).log;
    const gnss::ObservationLog theirs = read_rinex_observations(folder() / "l.obs", log).log;
    for (const System system : {System::Gps, System::Glonass}) expect_same(ours, theirs, system);  // convbin leaves SBAS out
}

TEST_F(ReceiverLogs, Rtcm3IsDatedByItsEphemeridesOrByTheCaller) {
    const std::string whole = seed("rtcm3");
    const Time recorded = Time::from_gps(2244, 36000.0);
    const auto first_epoch = [&](std::string_view bytes, Time near) {
        return read_rtcm3(TextInput::memory(bytes, "a.rtcm3"), near, log).observations.epochs.at(0).time;
    };
    EXPECT_EQ(first_epoch(whole, recorded), recorded);
    EXPECT_EQ(first_epoch(whole, Time::from_gps(2244 + 500, 0.0)), recorded);
    EXPECT_EQ(first_epoch(whole, Time::from_gps(2244 + 3000, 0.0)), recorded);  // by Galileo's weeks, GPS's have begun anew twice
    // the frame of 1019 alone, and nothing but measurements
    const std::size_t galileo = whole.find('\xd3', 1), text = whole.find("text between"), glonass = whole.find('\xd3', text);
    ASSERT_EQ(galileo, 67U);
    EXPECT_EQ(first_epoch(whole.substr(0, galileo) + whole.substr(text), Time::from_gps(2244 + 900, 0.0)), recorded);
    EXPECT_TRUE(log.empty());
    EXPECT_EQ(first_epoch(whole.substr(glonass), Time::from_gps(2300, 0.0)), Time::from_gps(2300, 36000.0));
    EXPECT_EQ(log.count("a.rtcm3 rtcm.date"), 1U);
    expect_parts(log.summary().at(0), {"a.rtcm3", "no ephemeris dates", "2024-02-04"});
}

TEST_F(ReceiverLogs, ForeignFormatsAreRefused) {
    SKIP_WITHOUT_DATA();
    const auto raw = test::data_folder() / "parser_corpus/rtklib_raw";
    for (const char* name : {"oemv_200911218.gps", "javad_20110115.jps", "gw10_20110121.sbas", "testglo.rtcm2"}) {
        EXPECT_FALSE(is_ubx(raw / name)) << name;
        EXPECT_FALSE(is_rtcm3(raw / name)) << name;
    }
    EXPECT_TRUE(is_rtcm3(raw / "testglo.rtcm3"));
    EXPECT_TRUE(is_ubx(raw / "ubx_20080526.ubx"));
    // old messages only: said, not guessed
    expect_parts(message_of([&] { (void)read_ubx(raw / "ubx_20080526.ubx", log); }),
                 {"neither raw measurements (RXM-RAWX) nor", "RXM-RAW ("});
}

}  // namespace
}  // namespace schuler::io
