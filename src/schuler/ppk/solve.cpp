#include "schuler/ppk/solve.h"

#include "schuler/core/error.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/quantile.h"
#include "schuler/ppk/baseline_filter.h"
#include "schuler/ppk/combine.h"
#include "schuler/ppk/differential_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>

namespace schuler::ppk {
namespace {

using gnss::ObservationLog;

constexpr double deg = 57.29577951308232;

std::string date_of(Time t) {
    const Calendar c = utc_from_gps(t);
    return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02.0f} UTC", c.year, c.month, c.day, c.hour, c.minute,
                       std::floor(c.second));
}

std::string place_text(const Ecef& place) {
    const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, place);
    return fmt::format("[{:.8f}, {:.8f}, {:.3f}]", g.lat * deg, g.lon * deg, g.h);
}

Error about_base(const Input& input, std::string what, std::string hint, const char* key = "base.observations") {
    return input_error(std::move(what), {input.base_name, 0, 0, key}, std::move(hint));
}

void check_times(const Input& input, double longest_age) {
    const auto &r = input.rover->epochs, &b = input.base->epochs;
    const Duration age = Duration::from_seconds(longest_age);
    if (b.back().time + age >= r.front().time && b.front().time - age <= r.back().time) return;
    throw about_base(
        input,
        fmt::format("the base's log ({} to {}) and the rover's ({} to {}) have no time in common", date_of(b.front().time),
                    date_of(b.back().time), date_of(r.front().time), date_of(r.back().time)),
        "name the base's log of the same hours");
}

/// Rejects logs with identical measurements at every common instant.
void check_different(const Input& input) {
    const ObservationLog &rover = *input.rover, &base = *input.base;
    std::size_t same = 0, compared = 0;
    auto b = base.epochs.begin();
    for (const gnss::ObservationEpoch& e : rover.epochs) {
        while (b != base.epochs.end() && b->time < e.time) ++b;
        if (b == base.epochs.end()) break;
        if (b->time != e.time) continue;
        for (const gnss::SignalObservation& o : rover.of(e)) {
            const auto others = base.of(*b);
            const auto it = std::ranges::find_if(
                others, [&](const gnss::SignalObservation& x) { return x.satellite == o.satellite && x.signal == o.signal; });
            if (it == others.end() || !std::isfinite(o.phase) || !std::isfinite(it->phase)) continue;
            ++compared;
            same += o.phase == it->phase && o.pseudorange == it->pseudorange ? 1 : 0;
        }
        constexpr std::size_t enough = 200;
        if (compared >= enough) break;
    }
    if (compared > 0 && 2 * same > compared)
        throw about_base(input, fmt::format("the base's measurements are those of the rover ({})", input.rover_name),
                         "name the log of the receiver at the known place");
}

/// The base position from its own measurements.
struct OwnPlace {
    Ecef position;
    double sigma = 0;  ///< m, three-dimensional
    double moved = 0;  ///< m, between the first and the last third of the log, or farther from the middle for a tenth of it
};
Eigen::Vector3d median_place(const std::vector<Eigen::Vector3d>& places) {
    Eigen::Vector3d out;
    for (int i = 0; i < 3; ++i) {
        std::vector<double> values;
        for (const Eigen::Vector3d& p : places) values.push_back(p[i]);
        out[i] = math::median(std::move(values));
    }
    return out;
}
std::optional<OwnPlace> own_place(const Input& input) {
    gnss::SinglePoint solver(*input.source, input.ionosphere, input.single);
    const auto& epochs = input.base->epochs;
    constexpr std::size_t wanted = 60;
    const std::size_t stride = std::max<std::size_t>(1, epochs.size() / wanted);
    std::vector<Eigen::Vector3d> places;
    std::vector<double> sigmas;
    for (std::size_t i = 0; i < epochs.size(); i += stride) {
        const gnss::SinglePointSolution s = solver.solve(input.base->of(epochs[i]), epochs[i].time, input.base->channels);
        if (s.status != gnss::SinglePointStatus::Solved) continue;
        places.push_back(s.position.r);
        sigmas.push_back(std::sqrt(s.covariance.trace()));
    }
    if (places.empty()) return std::nullopt;
    OwnPlace out{{median_place(places)}, math::median(sigmas), 0.0};
    const auto third = static_cast<std::ptrdiff_t>(places.size() / 3);
    if (third >= 3)
        out.moved =
            (median_place({places.begin(), places.begin() + third}) - median_place({places.end() - third, places.end()})).norm();
    std::vector<double> off;
    for (const Eigen::Vector3d& p : places) off.push_back((p - out.position.r).norm());
    out.moved = std::max(out.moved, math::quantile(std::move(off), 0.9));
    return out;
}

void place_base(const Input& input, Solution& out, WarningLog& warnings) {
    const std::optional<OwnPlace> own = own_place(input);
    const Ecef& header = input.base->approximate;
    constexpr double earth_inside = 6e6;  // m: a header without a position has zeros
    if (input.base_position) {
        out.base = *input.base_position;
    } else if (header.r.allFinite() && header.r.norm() > earth_inside) {
        out.base = antenna_of(header, input.base->antenna_delta);
        out.place = PlaceOfBase::Header;
        warnings.add("base.position.header",
                     fmt::format("the position of the base is that stated in its log, {}, whose error is in every "
                                 "position (base.position overrides it)",
                                 place_text(out.base)));
    } else if (own) {
        out.base = own->position;
        out.place = PlaceOfBase::SinglePoint;
        out.base_sigma = own->sigma;
        warnings.add(
            "base.position.single",
            fmt::format("neither base.position nor the header gives the position of the base: its own single-point solution, {}, "
                        "is used, and its sigma of {:.1f} m is in every position",
                        place_text(out.base), own->sigma));
    } else {
        throw about_base(input, "the position of the base is unknown: its header has none, and its measurements give none",
                         "write [base] position = [latitude deg, longitude deg, height m]", "base.position");
    }
    if (!own) {
        warnings.add("base.unchecked",
                     "the position of the base could not be checked: its measurements give no single-point solution");
        return;
    }
    constexpr double honest = 20.0, sigmas = 6.0;  // m
    const double largest = std::min(honest + sigmas * own->sigma, 90.0), off = (own->position.r - out.base.r).norm();
    if (own->moved > largest)
        throw about_base(input, fmt::format("the base moves, by {:.0f} m", own->moved),
                         "the base must be the receiver at rest; are the two logs exchanged?");
    if (off > largest)
        throw about_base(
            input,
            fmt::format("the base's position {} ({}) is {:.0f} m away from where its own measurements put it, {}",
                        place_text(out.base), out.place == PlaceOfBase::Header ? "of its header" : "as given", off,
                        place_text(own->position)),
            fmt::format(
                "give base.position right, latitude and longitude in degrees and the height above the ellipsoid; {:.1f} m are "
                "known of it by these measurements",
                own->sigma),
            "base.position");
    if (off > 5.0 + 3.0 * own->sigma)
        warnings.add(
            "base.position.off",
            fmt::format("the base's own single-point solution is {:.1f} m from its position (sigma {:.1f} m)", off, own->sigma));
}

std::vector<EpochSolution> pass(const std::vector<TrackedEpoch>& rover, BaselineFilter filter, bool backwards) {
    std::vector<EpochSolution> out(rover.size());
    for (std::size_t i = 0; i < rover.size(); ++i) {
        const std::size_t k = backwards ? rover.size() - 1 - i : i;
        out[k] = filter.step(rover[k]);
    }
    return out;
}

}  // namespace

Ecef antenna_of(const Ecef& marker, const Eigen::Vector3d& delta) {
    if (!delta.allFinite()) return marker;
    const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, marker);
    return {marker.r + earth::C_en(g.lat, g.lon) * Eigen::Vector3d(delta[2], delta[1], -delta[0])};
}

std::size_t Solution::count(Quality quality) const {
    return static_cast<std::size_t>(std::ranges::count(epochs, quality, &EpochSolution::quality));
}

Solution solve(const Input& input, const Settings& settings, WarningLog& warnings) {
    if (input.base->epochs.empty()) throw about_base(input, "has no measurement", "name the base's observations");
    if (input.rover->epochs.empty())
        throw input_error("has no measurement", {input.rover_name, 0, 0, "gnss.observations"}, "name the rover's observations");
    check_times(input, settings.base.longest_age);
    check_different(input);
    Solution out;
    place_base(input, out, warnings);
    const SignalPlan plan = common_signals(*input.rover, *input.base, input.single.ranges, settings.frequencies);
    if (plan.satellites() == 0)
        throw about_base(input, fmt::format("it has no carrier phase in common with {}", input.rover_name),
                         "both receivers must track the phase of the same satellites and carriers, of systems in gnss.systems");
    gnss::RangeSettings base_ranges = input.single.ranges;
    base_ranges.least_cn0 = 0.0;
    gnss::SinglePoint solver(*input.source, input.ionosphere, input.single);
    std::vector<TrackedEpoch> base =
        tracked(*input.base, {Side::Base, out.base, input.base_antenna}, plan, *input.source, solver, base_ranges);
    std::vector<TrackedEpoch> rover =
        tracked(*input.rover, {Side::Rover, std::nullopt, input.rover_antenna}, plan, *input.source, solver, input.single.ranges);
    if (rover.empty())
        throw input_error("no epoch has a single-point solution to begin with", {input.rover_name, 0, 0, "gnss.observations"},
                          "are the navigation files of the same day, and the systems right?");
    out.base_arcs = number_arcs(base, true, settings.arcs, settings.air);
    out.rover_arcs = number_arcs(rover, false, settings.arcs, settings.air);
    const BaseStation station(base, out.base, settings.air, settings.base);
    base = {};
    for (const TrackedEpoch& e : rover) out.longest_baseline = std::max(out.longest_baseline, (e.position.r - out.base.r).norm());
    const bool ionosphere = settings.air.ionosphere && out.longest_baseline > settings.left.ionosphere_states_from;
    const BaselineFilter filter(settings, plan, station, ionosphere);
    if (settings.direction == Direction::Combined) {
        auto other = std::async(std::launch::async, [&] { return pass(rover, filter, true); });
        out.epochs = pass(rover, filter, false);
        const std::vector<EpochSolution> backward = other.get();
        for (std::size_t i = 0; i < out.epochs.size(); ++i) out.epochs[i] = combined(out.epochs[i], backward[i]);
    } else {
        out.epochs = pass(rover, filter, settings.direction == Direction::Backward);
    }
    if (out.count(Quality::Fixed) + out.count(Quality::Float) == 0) {
        const bool common = std::ranges::any_of(rover, [&](const TrackedEpoch& e) {
            const auto b = station.at(e.tag);
            return b && std::ranges::any_of(e.satellites, [&](const TrackedSatellite& s) {
                       return std::ranges::find(b->satellites, s.id, &BaseSatellite::id) != b->satellites.end();
                   });
        });
        throw about_base(input,
                         common ? fmt::format("at no time four satellites in common with {} agree", input.rover_name)
                                : fmt::format("has no satellite in common with {} at the same time", input.rover_name),
                         "is it the base's log of the same hours, tracking the same systems (gnss.systems)?");
    }
    if (settings.ranges) out.ranges = differential_ranges(rover, station, plan, out.epochs, settings);
    if (out.base_sigma > 0.0)
        for (EpochSolution& e : out.epochs)
            if (e.quality == Quality::Fixed || e.quality == Quality::Float)
                e.covariance += out.base_sigma * out.base_sigma / 3.0 * Eigen::Matrix3d::Identity();
    return out;
}

}  // namespace schuler::ppk
