#include "schuler/gnss/atmosphere.h"

#include "schuler/earth/atmosphere.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/system_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::gnss {
namespace {

constexpr double pi = std::numbers::pi;

double second_of_day(Time t) {
    constexpr std::int64_t day = 86'400'000'000'000;
    return static_cast<double>(((t.ns % day) + day) % day) * 1e-9;
}

/// Continued fraction of [Niell1996:4], one at the zenith.
double fraction(double s, double a, double b, double c) {
    return (1.0 + a / (1.0 + b / (1.0 + c))) / (s + a / (s + b / (s + c)));
}

/// Table of five latitudes, 15 to 75 degrees, three coefficients.
using LatitudeTable = std::array<std::array<double, 3>, 5>;

// [Niell1996:tables 3 and 4]
constexpr LatitudeTable hydrostatic_mean = {{{1.2769934e-3, 2.9153695e-3, 62.610505e-3},
                                             {1.2683230e-3, 2.9152299e-3, 62.837393e-3},
                                             {1.2465397e-3, 2.9288445e-3, 63.721774e-3},
                                             {1.2196049e-3, 2.9022565e-3, 63.824265e-3},
                                             {1.2045996e-3, 2.9024912e-3, 64.258455e-3}}};
constexpr LatitudeTable hydrostatic_amplitude = {{{0.0, 0.0, 0.0},
                                                  {1.2709626e-5, 2.1414979e-5, 9.0128400e-5},
                                                  {2.6523662e-5, 3.0160779e-5, 4.3497037e-5},
                                                  {3.4000452e-5, 7.2562722e-5, 84.795348e-5},
                                                  {4.1202191e-5, 11.723375e-5, 170.37206e-5}}};
constexpr LatitudeTable wet_mean = {{{5.8021897e-4, 1.4275268e-3, 4.3472961e-2},
                                     {5.6794847e-4, 1.5138625e-3, 4.6729510e-2},
                                     {5.8118019e-4, 1.4572752e-3, 4.3908931e-2},
                                     {5.9727542e-4, 1.5007428e-3, 4.4626982e-2},
                                     {6.1641693e-4, 1.7599082e-3, 5.4736038e-2}}};

std::array<double, 3> at_latitude(const LatitudeTable& table, double latitude_deg) {
    const double place = std::clamp(std::abs(latitude_deg) / 15.0 - 1.0, 0.0, 4.0);
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), 3);
    const double w = place - static_cast<double>(i);
    std::array<double, 3> out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = (1.0 - w) * table[i][k] + w * table[i + 1][k];
    return out;
}

/// Day of the year, with fraction.
double day_of_year(Time t) {
    const Calendar c = utc_from_gps(t);
    const Time start = gps_from_utc({c.year, 1, 1, 0, 0, 0.0});
    return 1.0 + (t - start).seconds() / 86'400.0;
}

}  // namespace

Direction direction_to(const Ecef& satellite, const Ecef& receiver, const Geodetic& geodetic) {
    const Eigen::Vector3d n = earth::C_en(geodetic.lat, geodetic.lon).transpose() * (satellite.r - receiver.r);
    return {std::atan2(n.y(), n.x()), std::atan2(-n.z(), std::hypot(n.x(), n.y()))};
}

double klobuchar_delay(const KlobucharCoefficients& c, Time t, const Geodetic& receiver, Direction d) {
    // in semicircles, as in the interface document
    const double elevation = d.elevation / pi;
    const double psi = 0.0137 / (elevation + 0.11) - 0.022;
    const double lat = std::clamp(receiver.lat / pi + psi * std::cos(d.azimuth), -0.416, 0.416);
    const double lon = receiver.lon / pi + psi * std::sin(d.azimuth) / std::cos(lat * pi);
    const double magnetic = lat + 0.064 * std::cos((lon - 1.617) * pi);
    double local = std::fmod(43'200.0 * lon + second_of_day(t), 86'400.0);
    if (local < 0.0) local += 86'400.0;
    const auto cubic = [&](const std::array<double, 4>& k) {
        return k[0] + magnetic * (k[1] + magnetic * (k[2] + magnetic * k[3]));
    };
    const double amplitude = std::max(cubic(c.alpha), 0.0), period = std::max(cubic(c.beta), 72'000.0);
    const double x = 2.0 * pi * (local - 50'400.0) / period;
    const double slant = 1.0 + 16.0 * std::pow(0.53 - elevation, 3);
    const double night = 5e-9;
    const double vertical = std::abs(x) < 1.57 ? night + amplitude * (1.0 + x * x * (-0.5 + x * x / 24.0)) : night;
    return speed_of_light * slant * vertical;
}

double beidou_klobuchar_delay(const KlobucharCoefficients& c, Time t, const Geodetic& receiver, Direction d) {
    constexpr double radius = 6378e3, shell = 375e3, sine = radius / (radius + shell);
    const double at_shell = sine * std::cos(d.elevation);  // sine of the zenith angle at the shell
    const double psi = 0.5 * pi - d.elevation - std::asin(at_shell);
    const double lat = std::asin(std::clamp(
        std::sin(receiver.lat) * std::cos(psi) + std::cos(receiver.lat) * std::sin(psi) * std::cos(d.azimuth), -1.0, 1.0));
    const double lon =
        receiver.lon + std::asin(std::clamp(std::sin(psi) * std::sin(d.azimuth) / std::max(std::cos(lat), 1e-6), -1.0, 1.0));
    const double place = std::abs(lat) / pi;  // semicircles
    const auto cubic = [&](const std::array<double, 4>& k) { return k[0] + place * (k[1] + place * (k[2] + place * k[3])); };
    const double amplitude = std::max(cubic(c.alpha), 0.0), period = std::clamp(cubic(c.beta), 72'000.0, 172'800.0);
    double local = std::fmod(second_of_day(t - lag_of(System::BeiDou)) + lon * 43'200.0 / pi, 86'400.0);
    if (local < 0.0) local += 86'400.0;
    const double since_peak = local - 50'400.0, night = 5e-9;
    const double vertical =
        std::abs(since_peak) < 0.25 * period ? night + amplitude * std::cos(2.0 * pi * since_peak / period) : night;
    return speed_of_light * vertical / std::sqrt(1.0 - at_shell * at_shell);
}

BroadcastIonosphere broadcast_ionosphere(const Navigation& navigation) {
    BroadcastIonosphere out;
    for (const System system : {System::Gps, System::Qzss, System::Navic}) {
        if (!out.klobuchar) out.klobuchar = navigation.klobuchar[static_cast<std::size_t>(system)];
    }
    out.beidou = navigation.klobuchar[static_cast<std::size_t>(System::BeiDou)];
    return out;
}

IonosphericDelay ionospheric_delay(const BroadcastIonosphere& ionosphere, System system, double frequency, Time t,
                                   const Geodetic& receiver, Direction d) {
    const auto on_carrier = [&](double reference) { return (reference / frequency) * (reference / frequency); };
    constexpr double left = 0.5, b1i = 1561.098e6;
    std::optional<double> of_gps, of_beidou;
    if (ionosphere.klobuchar) of_gps = on_carrier(l1_frequency) * klobuchar_delay(*ionosphere.klobuchar, t, receiver, d);
    if (ionosphere.beidou) of_beidou = on_carrier(b1i) * beidou_klobuchar_delay(*ionosphere.beidou, t, receiver, d);
    if (!of_gps && !of_beidou) {
        // amplitude for medium solar activity at middle latitudes, and Klobuchar's mean period
        constexpr KlobucharCoefficients mean{{20e-9, 0.0, 0.0, 0.0}, {115'000.0, 0.0, 0.0, 0.0}};
        const double delay = on_carrier(l1_frequency) * klobuchar_delay(mean, t, receiver, d);
        constexpr double least_vertical = 2.0;  // m on L1: night value of an active ionosphere
        const double slant = 1.0 + 16.0 * std::pow(0.53 - d.elevation / pi, 3);
        return {delay, std::hypot(delay, on_carrier(l1_frequency) * least_vertical * slant)};
    }
    const bool own_beidou = system == System::BeiDou && of_beidou, own = own_beidou || (system != System::BeiDou && of_gps);
    const double delay = own_beidou || !of_gps ? *of_beidou : *of_gps;
    const bool is_own = own && (system == System::Gps || system == System::Qzss || system == System::Navic || own_beidou);
    const double apart = !is_own && of_gps && of_beidou ? *of_gps - *of_beidou : 0.0;
    return {delay, std::hypot(left * delay, apart)};
}

ZenithDelay saastamoinen_zenith(const Geodetic& receiver, double relative_humidity) {
    const double h = std::clamp(receiver.h, -1000.0, 20'000.0);
    if (std::isnan(h)) return {h, h};  // of a diverging filter, which reports it itself
    const earth::StandardAir air = earth::standard_air(earth::geopotential_from_geometric(h));
    const double pressure = air.pressure * 1e-2;  // hPa
    // partial pressure of water vapour over water, hPa, by the formula commonly used with this model
    const double vapour = 6.108 * relative_humidity * std::exp((17.15 * air.temperature - 4684.0) / (air.temperature - 38.45));
    const double gravity = 1.0 - 0.00266 * std::cos(2.0 * receiver.lat) - 0.00028e-3 * h;
    return {0.0022768 * pressure / gravity, 0.002277 * (1255.0 / air.temperature + 0.05) * vapour};
}

double troposphere_delay(const ZenithDelay& zenith, Mapping mapping, Time t, const Geodetic& receiver, double elevation) {
    constexpr double lowest = 3.0 * pi / 180.0;
    const double s = std::sin(std::max(elevation, lowest));
    if (mapping == Mapping::Cosecant) return (zenith.hydrostatic + zenith.wet) / s;
    const double latitude_deg = receiver.lat * 180.0 / pi;
    // the season is counted from 28 January, half a year later in the southern hemisphere
    const double season = std::cos(2.0 * pi * ((day_of_year(t) - 28.0) / 365.25 + (receiver.lat < 0.0 ? 0.5 : 0.0)));
    const auto mean = at_latitude(hydrostatic_mean, latitude_deg), amplitude = at_latitude(hydrostatic_amplitude, latitude_deg),
               wet = at_latitude(wet_mean, latitude_deg);
    const double hydrostatic =
        fraction(s, mean[0] - amplitude[0] * season, mean[1] - amplitude[1] * season, mean[2] - amplitude[2] * season);
    const double height_km = std::clamp(receiver.h, -1000.0, 20'000.0) * 1e-3;
    const double height = (1.0 / s - fraction(s, 2.53e-5, 5.49e-3, 1.14e-3)) * height_km;
    return zenith.hydrostatic * (hydrostatic + height) + zenith.wet * fraction(s, wet[0], wet[1], wet[2]);
}

}  // namespace schuler::gnss
