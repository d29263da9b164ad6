// The seeds of the fuzz targets are files the readers accept whole: otherwise the search would start outside the door. What they hold
// is known from tests/fuzz/make_corpus.py, which shares no code with the readers.
#include "schuler/io/receiver/novatel_raw.h"
#include "schuler/io/receiver/rtcm3.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/rinex/antex.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/rinex/sp3.h"

#include "io/io_fixture.h"

#include <cmath>
#include <numbers>
#include <set>

namespace schuler::io {
namespace {

using gnss::System;

const Time reference = Time::from_gps(2244, 36000.0);

class FuzzSeeds : public test::IoTest {
protected:
    /// A seed without the byte that chooses the reader.
    TextInput seed(const std::string& name) {
        content_ = content_of(std::filesystem::path(SCHULER_SOURCE_DIR) / "tests/fuzz/corpus" / name).substr(1);
        return TextInput::memory(content_, name);
    }
    void TearDown() override {
        EXPECT_TRUE(log.empty()) << log.summary().at(0);
        test::IoTest::TearDown();
    }
    WarningLog log;

private:
    std::string content_;
};

/// The orbit of all seeds; the angles of the binary ones are so many half turns as the texts' are rad.
void expect_orbit(const gnss::KeplerEphemeris& k, double angle_unit) {
    EXPECT_EQ(k.toe, k.satellite.system == System::BeiDou ? reference + Duration{14'000'000'000} : reference);
    EXPECT_EQ(k.toc, k.toe);
    EXPECT_EQ(k.sqrt_a, 5153.5);
    EXPECT_NEAR(k.e, 0.01, 1e-10);
    EXPECT_NEAR(k.m0 / angle_unit, angle_unit == 1.0 ? 0.25 : 0.125, 1e-9);
    EXPECT_NEAR(k.omega0 / angle_unit, angle_unit == 1.0 ? 1.0 : 0.375, 1e-9);
    EXPECT_EQ(k.crs, 50.0);
    EXPECT_EQ(k.crc, 250.0);
    EXPECT_NEAR(k.cus, 8e-6, 1e-9);
    EXPECT_NEAR(k.cis, -1e-7, 1e-9);
    EXPECT_NEAR(k.af0, 1e-4, 1e-9);
    EXPECT_NEAR(k.af1, 1e-12, 1e-13);
    EXPECT_NEAR(k.group_delay[0], 5e-9, 3e-10);
}

void expect_state(const gnss::GlonassEphemeris& g) {
    EXPECT_EQ(g.toe, gps_from_utc({2023, 1, 8, 9, 45, 0.0}));
    EXPECT_LT((g.position - Eigen::Vector3d(10e6, -15e6, 18e6)).norm(), 1e-6);
    EXPECT_LT((g.velocity - Eigen::Vector3d(1000.0, 2000.0, -2000.0)).norm(), 1e-6);
    EXPECT_NEAR(g.acceleration.z(), -2e-6, 5e-7);
    EXPECT_NEAR(std::abs(g.clock), 1e-4, 1e-9);
    EXPECT_EQ(g.channel, 1);
}

struct ExpectedSeed {
    const char* name;
    std::size_t kepler, glonass, sbas, foreign;
};

TEST_F(FuzzSeeds, NavigationRecordsAreAllRead) {
    for (const ExpectedSeed& e : {ExpectedSeed{"rinex/navigation2_gps", 2, 0, 0, 0},
                                  {"rinex/navigation2_glonass", 0, 2, 0, 0},
                                  {"rinex/navigation3", 5, 1, 1, 0},
                                  {"rinex/navigation4", 7, 1, 1, 1}}) {
        SCOPED_TRACE(e.name);
        const RinexNavigation n = read_rinex_navigation(seed(e.name), log);
        EXPECT_EQ(n.navigation.kepler.size(), e.kepler);
        EXPECT_EQ(n.navigation.glonass.size(), e.glonass);
        EXPECT_EQ(n.navigation.sbas.size(), e.sbas);
        EXPECT_EQ(n.records.foreign, e.foreign);
        EXPECT_EQ(n.records.bad, 0U) << n.records.first_bad_line;
        EXPECT_EQ(n.navigation.klobuchar[0].has_value(), e.glonass == 0 || e.sbas > 0);
        EXPECT_EQ(n.navigation.galileo_ionosphere.has_value(), e.sbas > 0);
        for (const auto& k : n.navigation.kepler) expect_orbit(k, 1.0);
        for (const auto& g : n.navigation.glonass) expect_state(g);
    }
}

TEST_F(FuzzSeeds, ObservationsAndOrbitsAreAllRead) {
    const RinexObservations two = read_rinex_observations(seed("rinex/observation2"), log);
    EXPECT_EQ(two.log.epochs.size(), 2U);
    EXPECT_EQ(two.records.foreign, 1U);
    EXPECT_EQ(two.log.observations.size(), 2U * 14U * 2U);
    for (const char* name : {"rinex/observation3", "rinex/observation4"}) {
        const RinexObservations r = read_rinex_observations(seed(name), log);
        ASSERT_EQ(r.log.epochs.size(), 3U) << name;
        EXPECT_EQ(r.log.epochs[0].time, reference);
        EXPECT_TRUE(r.log.epochs[2].power_failure);
        EXPECT_EQ(r.log.observations.size(), 3U * 8U) << name;
        EXPECT_EQ(r.log.approximate.r.x(), 6378137.0);
        EXPECT_EQ(r.log.channels.of_slot[5], 1);
        EXPECT_EQ(r.log.observations[0].loss_of_lock, 1);
    }
    const Sp3File sp3 = read_sp3(seed("rinex/sp3"), log);
    EXPECT_EQ(sp3.epochs, 3U);
    EXPECT_EQ(sp3.records.read, 9U);
    const AntexFile antex = read_antex(seed("rinex/antex"), log);
    EXPECT_EQ(antex.antennas.receivers.size(), 1U);
    ASSERT_EQ(antex.antennas.satellites.size(), 1U);
    EXPECT_EQ(antex.antennas.satellites[0].antenna.carriers[0].variation.rows.size(), 3U);
}

TEST_F(FuzzSeeds, MessagesAreAllRead) {
    const UbxLog ubx = read_ubx(seed("receiver_logs/ubx"), log);
    EXPECT_EQ(ubx.observations.epochs.size(), 2U);
    EXPECT_EQ(ubx.observations.observations.size(), 2U * 8U);
    EXPECT_EQ(ubx.records.foreign, 1U);
    EXPECT_EQ(ubx.fixes.size(), 1U);
    EXPECT_EQ(ubx.records.bad, 0U) << ubx.records.first_bad_line;
    // subframes of G03, pages of E11, D1 of C21 and D2 of C03, strings of R05
    std::set<gnss::NavMessage> messages;
    for (const auto& k : ubx.navigation.kepler) {
        SCOPED_TRACE(gnss::name_of(k.satellite));
        expect_orbit(k, std::numbers::pi);
        EXPECT_NEAR(k.delta_n, 1.5e-9 * std::numbers::pi, 1e-12);
        EXPECT_NEAR(k.i0, 0.3125 * std::numbers::pi, 1e-8);
        EXPECT_NEAR(k.omega, -0.25 * std::numbers::pi, 1e-8);
        EXPECT_NEAR(k.omega_dot, -2.5e-9 * std::numbers::pi, 1e-12);
        EXPECT_NEAR(k.idot, 5e-11 * std::numbers::pi, 1e-12);
        EXPECT_NEAR(k.cuc, 1e-6, 1e-9);
        EXPECT_NEAR(k.cic, 1e-7, 1e-9);
        EXPECT_EQ(k.iode, 11);
        EXPECT_EQ(k.transmission - k.toe, Duration{});
        messages.insert(k.message);
    }
    using enum gnss::NavMessage;
    EXPECT_EQ(messages, (std::set{Lnav, Inav, D1, D2}));
    ASSERT_EQ(ubx.navigation.glonass.size(), 1U);
    expect_state(ubx.navigation.glonass[0]);
    EXPECT_NEAR(ubx.navigation.glonass[0].l2_delay, 2e-9, 1e-9);
    EXPECT_NEAR(ubx.navigation.glonass[0].clock, 1e-4, 1e-9);
    ASSERT_TRUE(ubx.navigation.klobuchar[0] && ubx.navigation.klobuchar[3] && ubx.navigation.galileo_ionosphere);
    EXPECT_EQ(ubx.navigation.klobuchar[3]->alpha, ubx.navigation.klobuchar[0]->alpha);
    EXPECT_EQ(ubx.navigation.galileo_ionosphere->a[0], 50.0);
    EXPECT_EQ(ubx.navigation.leap_seconds, 18);

    const Rtcm3Log rtcm = read_rtcm3(seed("receiver_logs/rtcm3"), Time::from_gps(2244, 0.0), log);
    EXPECT_EQ(rtcm.records.bad, 0U) << rtcm.records.first_bad_line;
    EXPECT_EQ(rtcm.records.read, 3U + 2U * 4U + 4U);
    EXPECT_EQ(rtcm.records.foreign, 1U);
    ASSERT_EQ(rtcm.observations.epochs.size(), 3U);
    EXPECT_EQ(rtcm.observations.epochs[0].time, reference);
    EXPECT_EQ(rtcm.observations.observations.size(), 2U * (2U * 2U + 1U + 2U + 1U) + 6U);
    EXPECT_EQ(rtcm.observations.epochs[2].time, reference + Duration::from_seconds(2.0));
    for (const gnss::SignalObservation& o : rtcm.observations.of(rtcm.observations.epochs[2])) {
        const bool first = o.signal.band == '1';
        const double wavelength = gnss::speed_of_light / gnss::frequency_of(o.satellite.system, o.signal.band, 1);
        EXPECT_NEAR(o.pseudorange, first ? 21e6 : 21e6 + 6.0, 0.011);
        EXPECT_NEAR(o.phase * wavelength, 21e6 - (first ? 3.0 : 4.0), 0.011);
        EXPECT_EQ(o.cn0, first ? 45.0 : 40.0);
    }
    EXPECT_EQ(rtcm.observations.approximate.r, Eigen::Vector3d(6378137.0, 0.0, 0.0));
    EXPECT_EQ(rtcm.observations.antenna, "SEED            NONE");
    EXPECT_EQ(rtcm.observations.channels.of_slot[5], 1);
    EXPECT_EQ(rtcm.navigation.kepler.size(), 2U);
    for (const auto& k : rtcm.navigation.kepler) expect_orbit(k, std::numbers::pi);
    ASSERT_EQ(rtcm.navigation.glonass.size(), 1U);
    expect_state(rtcm.navigation.glonass[0]);

    const NovatelRaw novatel = read_novatel_raw(seed("receiver_logs/novatel"), log);
    ASSERT_EQ(novatel.observations.epochs.size(), 3U);
    EXPECT_EQ(novatel.observations.channels.of_slot[5], 1);
    for (std::size_t i = 0; i < 6; ++i) {
        const gnss::SignalObservation& o = novatel.observations.observations[i];
        const double number = o.satellite.system == System::Gps ? 3.0 : 42.0;
        EXPECT_NEAR(o.pseudorange, 20e6 + 1e5 * number + 100.0 * static_cast<double>(i / 2), 0.004);
        EXPECT_NEAR(o.phase * gnss::speed_of_light / gnss::frequency_of(o.satellite.system, '1', 1), o.pseudorange, 0.01)
            << "in full and compressed";
        EXPECT_EQ(o.loss_of_lock, i < 2 ? 1 : 0);
    }
}

}  // namespace
}  // namespace schuler::io
