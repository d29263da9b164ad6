#include "schuler/ppk/differences.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/ppk/air_delay.h"

#include <algorithm>
#include <cmath>

namespace schuler::ppk {

double air_mapping(double elevation) { return 1.0 / std::max(std::sin(elevation), 0.05); }

double shell_mapping(double elevation) {
    constexpr double radius = 6371e3, shell = 350e3;
    const double at_shell = radius / (radius + shell) * std::cos(elevation);
    return 1.0 / std::sqrt(1.0 - at_shell * at_shell);
}

double Difference::vertical_factor() const { return factor * shell_mapping(elevation); }

std::vector<Difference> single_differences(const TrackedEpoch& rover, const BaseEpoch& base, const BaseStation& station,
                                           const SignalPlan& plan, const Ecef& position, const Settings& settings,
                                           bool ionosphere_is_estimated) {
    std::vector<Difference> out;
    const Geodetic geodetic = earth::geodetic_from_ecef(earth::wgs84, position);
    const double baseline = (position.r - station.position().r).norm();
    const auto square = [](double x) { return x * x; };
    for (const TrackedSatellite& s : rover.satellites) {
        const auto b = std::ranges::lower_bound(base.satellites, s.id, {}, &BaseSatellite::id);
        if (b == base.satellites.end() || b->id != s.id) continue;
        const Line line = line_to(s, position, geodetic);
        const AirDelay delay = air_delay(settings.air, s, geodetic, line.direction);
        const double modelled = line.range - s.clock + delay.troposphere, distance = line.range;
        // an orbit error is seen at an angle from the two ends
        double shared = s.variance * square(baseline / distance) + base.variance;
        const auto& pairs = plan.of[gnss::index_of(s.id)];
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const TrackedSignal& r = s.signals[k];
            const BaseSignal& c = b->signals[k];
            if (!std::isfinite(r.phase) || !std::isfinite(c.phase) || r.arc == 0 || c.arc == 0) continue;
            Difference& d = out.emplace_back();
            d.id = s.id;
            d.slot = static_cast<std::uint8_t>(k);
            d.band = pairs[k].rover.band;
            d.whole = s.id.system != gnss::System::Glonass && s.id.system != gnss::System::Sbas && !r.half_cycle && !c.half_cycle;
            d.halves = r.jumped || c.jumped;
            d.towards = line.towards;
            d.elevation = line.direction.elevation;
            d.mapping = air_mapping(d.elevation);
            d.wavelength = r.wavelength;
            d.factor = ionosphere_factor(r.wavelength);
            d.code = r.code - modelled - d.factor * delay.ionosphere - c.code;
            d.phase = r.phase - modelled + d.factor * delay.ionosphere - c.phase;
            const double here = square(gnss::noise_factor(d.elevation, r.cn0)),
                         there = square(gnss::noise_factor(b->direction.elevation, c.cn0));
            double left = shared;
            if (settings.air.ionosphere && !ionosphere_is_estimated)
                left += square(d.factor * settings.left.ionosphere_gradient * baseline * shell_mapping(d.elevation));
            d.phase_variance = square(settings.phase_sigma) * (here + c.phase_factor * there) + left;
            constexpr double of_air = 0.25;  // neighbouring satellites are seen through the same air
            d.left = left;
            d.repeated = of_air * left;
            d.code_variance = square(settings.code_sigma) * (here + c.code_factor * there) + left;
            // other tracking modes, and receivers on GLONASS's many carriers, have code delays that depend on the satellite
            constexpr double apart = 1.0;  // m
            if (!pairs[k].same() || s.id.system == gnss::System::Glonass) d.code_variance += square(apart);
            d.rover_arc = r.arc;
            d.base_arc = c.arc;
        }
    }
    return out;
}

}  // namespace schuler::ppk
