// Broadcast orbits and clocks against a signal generator's truth, precise orbits, and their own derivatives.
#include "schuler/gnss/satellite_source.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/rinex/sp3.h"
#include "schuler/io/text/table.h"

#include "gnss/spirent_truth.h"
#include "io/io_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

namespace schuler::gnss {
namespace {

Navigation spirent_navigation() {
    Navigation all;
    WarningLog log;
    for (const char* name : {"nav_GN.23N", "nav_RN.23G", "nav_EN.23L", "nav_CN.23C", "nav_JN.23J", "nav_IN.23I"})
        all.add(io::read_rinex_navigation(io::test::data_folder() / "spirent_static_4h" / name, log).navigation);
    return all;
}

/// Axes of an instant tau earlier, turned to those of now.
Eigen::Vector3d turned(const Eigen::Vector3d& r, double tau) {
    const double a = 7.2921151467e-5 * tau;
    return {std::cos(a) * r.x() + std::sin(a) * r.y(), -std::sin(a) * r.x() + std::cos(a) * r.y(), r.z()};
}

TEST(Orbit, SignalGeneratorPositionsVelocitiesRanges) {
    SKIP_WITHOUT_DATA();
    const BroadcastSource source(spirent_navigation());
    std::map<System, int> count;
    for (const Truth& t : spirent_truth()) {
        // The generator logs where the satellite was when it sent, in the axes of reception. Its geostationary BeiDou ephemerides
        // contradict each other by thousands of kilometres from one hour to the next; its GLONASS ones are another test.
        if (t.satellite.system == System::Glonass || (t.satellite.system == System::BeiDou && t.satellite.number <= 5)) continue;
        const double tau = t.range / speed_of_light;
        const Signal first{t.satellite.system == System::BeiDou ? '2' : t.satellite.system == System::Navic ? '5' : '1', 'X'};
        const auto s = source.at(t.satellite, first, t.time - Duration::from_seconds(tau));
        if (!s) continue;  // E14 and E18, marked unhealthy
        ++count[t.satellite.system];
        EXPECT_LT((turned(s->state.position.r, tau) - t.position).norm(), 2e-4) << name_of(t.satellite);
        EXPECT_LT((turned(s->state.velocity, tau) - t.velocity).norm(), 1e-3) << name_of(t.satellite);
        // range, satellite clock with relativity and the delay of the signal make the pseudorange
        // (E11's messages forget the second order of its clock from one to the next)
        if (t.pseudorange > 0.0 && t.satellite != SatelliteId{System::Galileo, 11}) {
            EXPECT_NEAR(t.range + speed_of_light * (s->group_delay - s->state.clock), t.pseudorange, 2e-3)
                << name_of(t.satellite);
        }
    }
    for (const System system : {System::Gps, System::Galileo, System::BeiDou, System::Qzss, System::Navic})
        EXPECT_GT(count[system], 100) << letter_of(system);
}

TEST(Orbit, SignalGeneratorGlonass) {
    SKIP_WITHOUT_DATA();
    // From the first message on: the generator's orbit leaves its own later messages, by 10 m after 30 min and kilometres after hours.
    Navigation first = spirent_navigation();
    std::erase_if(first.glonass, [&](const GlonassEphemeris& g) { return g.toe > Time::from_gps(2244, 36000.0); });
    std::map<SatelliteId, GlonassEphemeris> messages;
    for (const GlonassEphemeris& g : first.glonass) messages.try_emplace(g.satellite, g);
    int count = 0;
    for (const Truth& t : spirent_truth()) {
        if (t.satellite.system != System::Glonass || t.time > Time::from_gps(2244, 36000.0 + 1800.0)) continue;
        const double tau = t.range / speed_of_light;
        const SatelliteState s = satellite_state(messages.at(t.satellite), t.time - Duration::from_seconds(tau));
        ++count;
        EXPECT_LT((turned(s.position.r, tau) - t.position).norm(), 3.0) << name_of(t.satellite);
        EXPECT_LT((turned(s.velocity, tau) - t.velocity).norm(), 5e-3) << name_of(t.satellite);
    }
    EXPECT_GT(count, 30);
}

TEST(Orbit, BroadcastGlonassAgainstPreciseOrbits) {
    SKIP_WITHOUT_DATA();
    WarningLog log;
    const auto folder = io::test::data_folder() / "parser_corpus" / "rtklib_raw";
    const BroadcastSource broadcast(io::read_rinex_navigation(folder / "brdc0910.09g", log).navigation);
    io::Sp3File sp3 = io::read_sp3(folder / "igl15253.sp3", log);
    double sum = 0.0;
    int count = 0;
    for (std::size_t number = 1; number < 25; ++number) {
        const SatelliteId id{System::Glonass, static_cast<std::uint8_t>(number)};
        for (const PreciseSource::Node& node : sp3.nodes[index_of(id)]) {
            const auto s = broadcast.at(id, {'1', 'C'}, node.time);
            if (!s) continue;
            const double error = (s->state.position.r - node.position).norm();
            EXPECT_LT(error, 40.0) << name_of(id);
            sum += error * error;
            ++count;
        }
    }
    EXPECT_GT(count, 1000);
    std::printf("broadcast GLONASS against IGS orbits: %.1f m RMS\n", std::sqrt(sum / count));
    EXPECT_LT(std::sqrt(sum / count), 8.0);  // PZ-90.02 of 2009 and its broadcast accuracy
    // leaving out every second node, the interpolation finds it again
    auto thinned = sp3.nodes;
    for (auto& nodes : thinned) {
        for (std::size_t i = 0; 2 * i < nodes.size(); ++i) nodes[i] = nodes[2 * i];
        nodes.resize((nodes.size() + 1) / 2);
    }
    const PreciseSource fine(sp3.nodes), coarse(thinned);
    const SatelliteId id{System::Glonass, 10};
    const Time between = sp3.nodes[index_of(id)][41].time;
    const auto node = fine.at(id, {'1', 'C'}, between), found = coarse.at(id, {'1', 'C'}, between);
    ASSERT_TRUE(node && found);
    EXPECT_LT((node->state.position.r - sp3.nodes[index_of(id)][41].position).norm(), 1e-3);
    EXPECT_LT((found->state.position.r - node->state.position.r).norm(), 0.5);
    EXPECT_LT((found->state.velocity - node->state.velocity).norm(), 1e-3);
}

TEST(Orbit, GeostationaryBeiDouStandsStill) {
    // A circle with the Earth's period whose plane the frame's tilt of 5 degrees lays into the equator: it stands above 80 deg east.
    // Without the tilt it would swing by 5 degrees of latitude, with the other sign by 10.
    constexpr double rate = 7.292115e-5, tow = 36000.0, degree = std::numbers::pi / 180.0;
    KeplerEphemeris k;
    k.satellite = {System::BeiDou, 5};
    k.toe = k.toc = Time::from_gps(2244, tow + 14.0);
    const double radius = std::cbrt(3.986004418e14 / (rate * rate));
    k.sqrt_a = std::sqrt(radius), k.i0 = 5.0 * degree, k.omega0 = std::numbers::pi + rate * tow;
    k.omega = 30.0 * degree, k.m0 = (80.0 - 180.0 - 30.0) * degree;
    const Eigen::Vector3d above = radius * Eigen::Vector3d(std::cos(80.0 * degree), std::sin(80.0 * degree), 0.0);
    for (int hour = -3; hour <= 3; ++hour) {
        const SatelliteState s = satellite_state(k, k.toe + Duration::from_seconds(3600.0 * hour));
        EXPECT_LT((s.position.r - above).norm(), 1e-3) << hour;
        EXPECT_LT(s.velocity.norm(), 1e-6) << hour;
    }
}

TEST(Orbit, VelocityIsTheDerivativeOfPosition) {
    SKIP_WITHOUT_DATA();
    const Navigation n = spirent_navigation();
    const Duration step{50'000'000};
    const auto check = [&](const auto& ephemeris, Time t, double tolerance) {
        const SatelliteState s = satellite_state(ephemeris, t), before = satellite_state(ephemeris, t - step),
                             after = satellite_state(ephemeris, t + step);
        const double dt = 2.0 * step.seconds();
        EXPECT_LT((s.velocity - (after.position.r - before.position.r) / dt).norm(), tolerance);
        EXPECT_NEAR(s.clock_rate, (after.clock - before.clock) / dt, 1e-15);
    };
    for (std::size_t i = 0; i < n.kepler.size(); i += 20)
        check(n.kepler[i], n.kepler[i].toe + Duration::from_seconds(1234.5), 1e-6);
    for (const GlonassEphemeris& g : n.glonass) check(g, g.toe + Duration::from_seconds(-456.7), 1e-5);  // of the integration
}

}  // namespace
}  // namespace schuler::gnss
