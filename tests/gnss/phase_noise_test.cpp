// The noise of phases found in a log of which it is known.
#include "schuler/gnss/phase_noise.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace schuler::gnss {
namespace {

using units::deg;
const Time beginning = Time::from_gps(2300, 3 * 86'400.0);

/// Distance from a satellite, seen from the Earth as it turns during the light time, in closed form, m.
double distance(const Eigen::Vector3d& satellite, const Eigen::Vector3d& receiver, double flight) {
    const double turned = 7.2921151467e-5 * flight;
    const Eigen::Vector3d rotated(std::cos(turned) * satellite.x() + std::sin(turned) * satellite.y(),
                                  -std::sin(turned) * satellite.x() + std::cos(turned) * satellite.y(), satellite.z());
    return (rotated - receiver).norm();
}

/// A minute of a receiver that moves at 30 m/s and turns, at 1 Hz. Every fifth change of the first satellite is a slip of a cycle.
RangingLog log_with(double sigma, bool slips) {
    const BroadcastSource source(nominal_gps(beginning, beginning + Duration::from_seconds(600.0)));
    math::Random random(7, "phases");
    RangingLog log;
    std::map<int, double> before;
    for (int t = 0; t < 60; ++t) {
        const Time now = beginning + Duration::from_seconds(t);
        Ecef receiver = earth::ecef_from_geodetic(earth::wgs84, {52.3 * deg, 104.3 * deg, 300.0});
        receiver.r += 300.0 * Eigen::Vector3d(std::cos(0.1 * t), std::sin(0.1 * t), 0.2 * std::sin(0.3 * t));
        const double clock = 40.0 + 3.0 * t + 0.5 * random.normal();
        log.epochs.push_back({now, log.samples.size(), 0, 0, 0});
        for (int prn = 1; prn <= 32; ++prn) {
            double flight = 0.075;
            std::optional<Transmitter> sent;
            for (int i = 0; i < 4; ++i) {
                sent = source.at({System::Gps, static_cast<std::uint8_t>(prn)}, {}, now - Duration::from_seconds(flight));
                if (!sent) break;
                flight = distance(sent->state.position.r, receiver.r, flight) / speed_of_light;
            }
            if (!sent) continue;
            const double range = distance(sent->state.position.r, receiver.r, flight);
            const double sine = (sent->state.position.r - receiver.r).normalized().dot(receiver.r.normalized());
            if (sine < std::sin(5.0 * deg)) continue;
            RangeSample m;
            m.source = log.source(name_of(SatelliteId{System::Gps, static_cast<std::uint8_t>(prn)}), false);
            m.tx = sent->state.position;
            m.tx_velocity = sent->state.velocity;
            m.tx_clock = sent->state.clock;
            m.pseudorange = range + clock - speed_of_light * m.tx_clock + random.normal();
            m.cn0 = 45.0;
            const double phase = range + clock - speed_of_light * m.tx_clock;
            if (const auto old = before.find(prn); old != before.end()) {
                m.range_rate = phase - old->second + sigma * noise_factor(std::asin(sine), m.cn0) * random.normal();
                if (slips && log.epochs.back().count == 0 && t % 5 == 0) m.range_rate += 0.19;
                m.phase_span = 1.0;
            }
            before[prn] = phase;
            log.samples.push_back(m);
            ++log.epochs.back().count;
        }
    }
    return log;
}

TEST(PhaseNoise, IsThatOfTheLog) {
    SinglePointSettings settings;
    settings.ranges.troposphere = TroposphereModel::None;
    for (const double sigma : {0.01, 0.03}) {
        EXPECT_NEAR(phase_change_sigma(log_with(sigma, false), settings), sigma, 0.15 * sigma);
        EXPECT_NEAR(phase_change_sigma(log_with(sigma, true), settings), sigma, 0.3 * sigma);
    }
    // metres of the single-point position are a millimetre or two of a change
    EXPECT_LT(phase_change_sigma(log_with(0.002, false), settings), 0.004);
}

TEST(PhaseNoise, IsNotKnownFromDopplers) {
    RangingLog log = log_with(0.01, false);
    for (RangeSample& m : log.samples) m.phase_span = RangeSample::none;
    EXPECT_TRUE(std::isnan(phase_change_sigma(log, {})));
}

}  // namespace
}  // namespace schuler::gnss
