#include "schuler/dataset/odometer_check.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>

namespace schuler::dataset {
namespace {

constexpr double step = 0.05, furthest = 3.0;  // s; a lag up to two seconds, and one more beside it
constexpr std::size_t enough = 60;

struct Speed {
    Time time;
    double value;  // m/s
};

std::vector<Speed> speeds_of(const std::vector<GnssFix>& fixes, double latency) {
    constexpr double slow = 1.0;  // m/s: noise
    std::vector<Speed> out;
    for (const GnssFix& f : fixes) {
        const double v = f.velocity_n.head<2>().norm();
        if (f.fix != FixType::None && v > slow) out.push_back({f.time - Duration::from_seconds(f.velocity_age + latency), v});
    }
    return out;
}

/// The odometer's absolute speed at an instant; NaN outside or in a gap.
double at(const std::vector<OdometerSample>& log, Time time) {
    constexpr double gap = 1.5;  // s
    const auto after = std::ranges::lower_bound(log, time, {}, &OdometerSample::time);
    if (after == log.begin() || after == log.end()) return not_given;
    const OdometerSample &a = *std::prev(after), &b = *after;
    const double dt = (b.time - a.time).seconds();
    if (!(dt > 0.0) || dt > gap) return not_given;
    return std::abs(a.speed + (time - a.time).seconds() / dt * (b.speed - a.speed));
}

struct Fit {
    double ratio = not_given, spread = not_given;
    std::size_t pairs = 0;
};

Fit fit(const std::vector<OdometerSample>& odometer, const std::vector<Speed>& speeds, double lag) {
    std::vector<double> receiver, wheel, ratios, differences;
    for (const Speed& s : speeds) {
        const double w = at(odometer, s.time + Duration::from_seconds(lag));
        if (!(w > 0.0)) continue;
        receiver.push_back(s.value);
        wheel.push_back(w);
        ratios.push_back(s.value / w);
    }
    Fit out{.pairs = ratios.size()};
    if (out.pairs < enough) return out;
    out.ratio = math::median(ratios);
    for (std::size_t i = 0; i < receiver.size(); ++i) differences.push_back(std::abs(receiver[i] - out.ratio * wheel[i]));
    out.spread = math::median(differences);
    return out;
}

}  // namespace

std::optional<OdometerAgreement> compare_odometer(const std::vector<OdometerSample>& odometer, const std::vector<GnssFix>& fixes,
                                                  double velocity_latency) {
    std::vector<OdometerSample> log;
    std::ranges::copy_if(odometer, std::back_inserter(log), [](const OdometerSample& s) { return std::isfinite(s.speed); });
    std::ranges::stable_sort(log, {}, &OdometerSample::time);
    const std::vector<Speed> speeds = speeds_of(fixes, velocity_latency);
    if (log.size() < enough || speeds.size() < enough) return std::nullopt;
    std::vector<double> values;
    for (const Speed& s : speeds) values.push_back(s.value);
    constexpr double range = 3.0;  // m/s: a lag shows only in changes of speed
    const bool varies = math::quantile(values, 0.9) - math::quantile(values, 0.1) > range;
    const Fit stamped = fit(log, speeds, 0.0);
    if (stamped.pairs < enough || !varies) return std::nullopt;

    const int steps = static_cast<int>(std::round(furthest / step));
    std::vector<Fit> fits;
    for (int k = -steps; k <= steps; ++k) fits.push_back(fit(log, speeds, k * step));
    const auto best = std::ranges::min_element(fits, [](const Fit& a, const Fit& b) { return a.spread < b.spread; });
    constexpr double share = 0.1;  // of the speeds: above, the two do not belong together
    if (!(best->spread < share * math::median(values))) return std::nullopt;
    OdometerAgreement out{
        .ratio = best->ratio, .spread = best->spread, .spread_as_stamped = stamped.spread, .pairs = best->pairs};
    // At the end of the range there is no minimum, and a flat one shows no lag.
    const auto second = static_cast<std::ptrdiff_t>(std::round(1.0 / step)), k = best - fits.begin();
    if (k < second || k + second >= static_cast<std::ptrdiff_t>(fits.size())) return out;
    const double beside = std::min((best - second)->spread, (best + second)->spread);
    if (!(beside > 2.0 * best->spread)) return out;
    out.lag = static_cast<double>(k - steps) * step;
    const double coarse = out.lag;
    constexpr int finer = 5;
    for (int i = 1 - finer; i < finer; ++i) {
        const double lag = coarse + i * step / finer;
        if (const Fit f = fit(log, speeds, lag); f.pairs >= enough && f.spread < out.spread) {
            out.lag = lag;
            out.ratio = f.ratio;
            out.spread = f.spread;
        }
    }
    return out;
}

std::optional<SpeedUnit> unit_of_ratio(double ratio) {
    constexpr double tolerance = 0.04;  // tyres
    constexpr std::array units{SpeedUnit{"km/h", 1.0 / 3.6}, SpeedUnit{"mph", 0.44704}, SpeedUnit{"knots", 1852.0 / 3600.0},
                               SpeedUnit{"ft/s", 0.3048},    SpeedUnit{"cm/s", 0.01},   SpeedUnit{"mm/s", 0.001}};
    for (const SpeedUnit& unit : units)
        if (std::abs(ratio / unit.factor - 1.0) < tolerance) return unit;
    return std::nullopt;
}

}  // namespace schuler::dataset
