// Delays of ionosphere and troposphere at worked examples and against their own limits.
#include "schuler/gnss/atmosphere.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/ranges.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::gnss {
namespace {

using units::deg;

TEST(Atmosphere, KlobucharAtNightAtNoonAndOverTheDay) {
    const KlobucharCoefficients c{{1.1180e-8, 1.4900e-8, -5.9600e-8, -5.9600e-8}, {8.8060e4, 1.6380e4, -1.9660e5, -1.3110e5}};
    const Geodetic place{40.0 * deg, -100.0 * deg, 0.0};
    const Direction zenith{0.0, 90.0 * deg};
    // local time is 6 h 40 min behind at 100 degrees west: 08:40 UTC is 02:00 local, 20:40 is 14:00
    const double night = klobuchar_delay(c, Time::from_gps(2000, 8.0 * 3600 + 2400), place, zenith);
    EXPECT_NEAR(night, 5e-9 * speed_of_light, 0.01);
    const double noon = klobuchar_delay(c, Time::from_gps(2000, 20.0 * 3600 + 2400), place, zenith);
    // 14:00 local is the crest: night value plus amplitude at magnetic latitude 0.222 + 0.064 cos(...) semicircles
    const double magnetic = 40.0 / 180.0 + 0.064 * std::cos((-100.0 / 180.0 - 1.617) * 180.0 * deg);
    const double amplitude = c.alpha[0] + magnetic * (c.alpha[1] + magnetic * (c.alpha[2] + magnetic * c.alpha[3]));
    EXPECT_NEAR(noon, (5e-9 + amplitude) * speed_of_light, 0.02);
    // slant factor 1 + 16 (0.53 - E)^3 with E in semicircles
    const double low = klobuchar_delay(c, Time::from_gps(2000, 8.0 * 3600 + 2400), place, {1.0, 5.0 * deg});
    EXPECT_NEAR(low / night, 1.0 + 16.0 * std::pow(0.53 - 5.0 / 180.0, 3), 0.02);
}

TEST(Atmosphere, BeiDousKlobucharByGeographicLatitudeAndAShell) {
    const KlobucharCoefficients c{{1.1180e-8, 1.4900e-8, -5.9600e-8, -5.9600e-8}, {8.8060e4, 1.6380e4, -1.9660e5, -1.3110e5}};
    const Geodetic place{-40.0 * deg, -100.0 * deg, 0.0};
    const Direction zenith{0.0, 90.0 * deg};
    const double behind = 2400.0 + 14.0;  // GPS time is 14 s before BeiDou's, in which the local time counts
    EXPECT_NEAR(beidou_klobuchar_delay(c, Time::from_gps(2000, 8.0 * 3600 + behind), place, zenith), 5e-9 * speed_of_light, 1e-6);
    const double latitude = 40.0 / 180.0;  // semicircles, south like north
    const double amplitude = c.alpha[0] + latitude * (c.alpha[1] + latitude * (c.alpha[2] + latitude * c.alpha[3]));
    EXPECT_NEAR(beidou_klobuchar_delay(c, Time::from_gps(2000, 20.0 * 3600 + behind), place, zenith),
                (5e-9 + amplitude) * speed_of_light, 1e-6);
    // an hour later, on the cosine of the period
    const double period = std::max(72e3, c.beta[0] + latitude * (c.beta[1] + latitude * (c.beta[2] + latitude * c.beta[3])));
    EXPECT_NEAR(beidou_klobuchar_delay(c, Time::from_gps(2000, 21.0 * 3600 + behind), place, zenith),
                (5e-9 + amplitude * std::cos(360.0 * deg * 3600.0 / period)) * speed_of_light, 1e-6);
    // 10 degrees high at night: the ray meets the shell at the zenith angle of the sine rule
    const double sine = 6378.0 / 6753.0 * std::cos(10.0 * deg);
    EXPECT_NEAR(beidou_klobuchar_delay(c, Time::from_gps(2000, 8.0 * 3600 + behind), place, {1.0, 10.0 * deg}),
                5e-9 * speed_of_light / std::sqrt(1.0 - sine * sine), 1e-6);
}

TEST(Atmosphere, EverySystemHasItsOwnIonosphereOrTheSigmaOfTheOthers) {
    const KlobucharCoefficients gps{{1e-8, 0, 0, 0}, {9e4, 0, 0, 0}}, beidou{{3e-8, 0, 0, 0}, {9e4, 0, 0, 0}};
    const Geodetic place{40.0 * deg, -100.0 * deg, 0.0};
    const Direction up{0.3, 60.0 * deg};
    const Time noon = Time::from_gps(2000, 20.0 * 3600);
    const double g = klobuchar_delay(gps, noon, place, up), b = beidou_klobuchar_delay(beidou, noon, place, up);
    const auto on = [&](const BroadcastIonosphere& known, System system, double f) {
        return ionospheric_delay(known, system, f, noon, place, up);
    };
    const BroadcastIonosphere both{gps, beidou};
    const double b1i = frequency_of(System::BeiDou, '2'), b3i = frequency_of(System::BeiDou, '6');
    EXPECT_NEAR(on(both, System::Gps, l1_frequency).delay, g, 1e-12);
    EXPECT_NEAR(on(both, System::Gps, l1_frequency).sigma, 0.5 * g, 1e-12);
    EXPECT_NEAR(on(both, System::BeiDou, b1i).delay, b, 1e-9);
    EXPECT_NEAR(on(both, System::BeiDou, b3i).delay, b * (b1i / b3i) * (b1i / b3i), 1e-9);
    // Galileo has neither: what the two disagree by is uncertain
    const double s = b1i / l1_frequency, apart = g - b * s * s;
    EXPECT_NEAR(on(both, System::Galileo, l1_frequency).sigma, std::hypot(0.5 * g, apart), 1e-9);
    EXPECT_NEAR(on({std::nullopt, beidou}, System::Gps, l1_frequency).delay, b * s * s, 1e-9);
    EXPECT_NEAR(on({gps, std::nullopt}, System::BeiDou, l1_frequency).delay, g, 1e-12);
    // of no coefficients a mean day, and the sigma covers that there is nothing as well as twice as much
    const IonosphericDelay mean = on({}, System::Gps, l1_frequency);
    EXPECT_GT(mean.delay, 5.0);
    EXPECT_GE(mean.sigma, mean.delay);
}

TEST(Atmosphere, SaastamoinenAtSeaLevelAndInTheAir) {
    const ZenithDelay sea = saastamoinen_zenith({45.0 * deg, 0.0, 0.0}, 0.5);
    EXPECT_NEAR(sea.hydrostatic, 0.0022768 * 1013.25, 1e-6);
    // 50 % of 17.0 hPa at 15 degrees
    EXPECT_NEAR(sea.wet, 0.002277 * (1255.0 / 288.15 + 0.05) * 0.5 * 17.0, 0.002);
    EXPECT_NEAR(saastamoinen_zenith({45.0 * deg, 0.0, 10'000.0}, 0.5).hydrostatic, 0.0022768 * 264.4, 0.01);
}

TEST(Atmosphere, NiellMapping) {
    const ZenithDelay dry{1.0, 0.0}, wet{0.0, 1.0};
    const Time summer = gps_from_utc({2023, 7, 28, 0, 0, 0.0}), winter = gps_from_utc({2023, 1, 28, 0, 0, 0.0});
    const Geodetic place{45.0 * deg, 0.0, 0.0}, south{-45.0 * deg, 0.0, 0.0};
    for (const ZenithDelay& z : {dry, wet})
        EXPECT_NEAR(troposphere_delay(z, Mapping::Niell, summer, place, 90.0 * deg), 1.0, 1e-12);
    // near the values of ray tracing at 10 and 5 degrees, mid latitude [Niell1996:table 5]
    EXPECT_NEAR(troposphere_delay(dry, Mapping::Niell, winter, place, 10.0 * deg), 5.56, 0.03);
    EXPECT_NEAR(troposphere_delay(dry, Mapping::Niell, winter, place, 5.0 * deg), 10.15, 0.05);
    EXPECT_NEAR(troposphere_delay(wet, Mapping::Niell, winter, place, 5.0 * deg), 10.75, 0.05);
    // the southern winter is the northern summer
    EXPECT_NEAR(troposphere_delay(dry, Mapping::Niell, summer, south, 5.0 * deg),
                troposphere_delay(dry, Mapping::Niell, winter, place, 5.0 * deg), 2e-3);
    EXPECT_NEAR(troposphere_delay(dry, Mapping::Cosecant, summer, place, 30.0 * deg), 2.0, 1e-12);
}

TEST(Ranges, TheEarthsRotationIsTheTurnOfTheSatellite) {
    Range r;
    r.position.r = {-13'946'912.1, 22'372'292.0, -819'544.0};
    r.velocity = {-221.3, -64.6, 3258.0};
    r.frequency = 1575.42e6;
    RangeSettings settings;
    settings.ionosphere = IonosphereModel::None;
    settings.troposphere = TroposphereModel::None;
    const Geodetic place{30.0 * deg, 95.0 * deg, 0.0};
    const Ecef receiver = earth::ecef_from_geodetic(earth::wgs84, place);
    const auto turned_range = [&](const Ecef& at, double moved) {
        // the satellite's position turned by the flight time, iterated
        const Eigen::Vector3d s = r.position.r + moved * r.velocity;
        double range = (at.r - s).norm();
        for (int i = 0; i < 5; ++i) {
            const double a = earth::wgs84.w_ie * range / speed_of_light;
            const Eigen::Vector3d t(std::cos(a) * s.x() + std::sin(a) * s.y(), -std::sin(a) * s.x() + std::cos(a) * s.y(), s.z());
            range = (at.r - t).norm();
        }
        return range;
    };
    EXPECT_NEAR(model_range(r, receiver, place, nullptr, settings).range, turned_range(receiver, 0.0), 2e-4);
    // rates: both ends move; the satellite's time of transmission passes slower by the range rate
    const Eigen::Vector3d v(150.0, -200.0, 30.0);
    constexpr double dt = 0.05;
    double rate = 0.0;
    for (int i = 0; i < 5; ++i) {
        const double sent = dt * (1.0 - rate / speed_of_light);
        rate = (turned_range({receiver.r + dt * v}, sent) - turned_range({receiver.r - dt * v}, -sent)) / (2.0 * dt);
    }
    EXPECT_NEAR(model_range_rate(r, receiver, v), rate, 1e-4);
}

}  // namespace
}  // namespace schuler::gnss
