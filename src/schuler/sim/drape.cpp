// Heights of a route over the ground.
#include "schuler/core/error.h"
#include "schuler/sim/route.h"

#include <algorithm>
#include <cmath>

namespace schuler::sim {

namespace {

/// The largest value within `reach` points to either side.
std::vector<double> highest_within(const std::vector<double>& x, std::size_t reach) {
    std::vector<double> out(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto from = static_cast<std::ptrdiff_t>(i > reach ? i - reach : 0);
        const auto to = static_cast<std::ptrdiff_t>(std::min(i + reach + 1, x.size()));
        out[i] = *std::max_element(x.begin() + from, x.begin() + to);
    }
    return out;
}

/// Mean over `reach` points to either side; the last value is continued beyond the ends.
std::vector<double> mean_within(const std::vector<double>& x, std::size_t reach) {
    const auto at = [&x](std::ptrdiff_t i) {
        return x[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, std::ssize(x) - 1))];
    };
    const auto r = static_cast<std::ptrdiff_t>(reach);
    std::vector<double> out(x.size());
    for (std::ptrdiff_t i = 0; i < std::ssize(x); ++i) {
        double sum = 0.0;
        for (std::ptrdiff_t k = i - r; k <= i + r; ++k) sum += at(k);
        out[static_cast<std::size_t>(i)] = sum / static_cast<double>(2 * r + 1);
    }
    return out;
}

}  // namespace

void drape(RoutePlan& plan, const Drape& s, const LocalChart& chart) {
    const auto require = [](bool ok, const char* key, const char* what, const char* hint) {
        if (!ok) throw input_error(what, {.file = {}, .line = 0, .column = 0, .key = key}, hint);
    };
    require(std::isfinite(s.clearance), "trajectory.drape.clearance_m", "is not a number", "give metres");
    require(std::isfinite(s.slope) && s.slope > 0.0, "trajectory.drape.climb_deg", "is not a valid slope",
            "give degrees above 0");
    require(std::isfinite(s.smoothing) && s.smoothing >= 0.0, "trajectory.drape.smoothing_m", "is not a length", "give metres");
    std::vector<double> h(plan.up.size());
    for (std::size_t i = 0; i < h.size(); ++i)
        h[i] = s.ground(chart.origin.lat + chart.lat_per_m * plan.north[i], chart.origin.lon + chart.lon_per_m * plan.east[i]) +
               s.clearance - chart.origin.h;
    // The lowest curve above the ground that is nowhere steeper than permitted.
    const double rise = s.slope * plan.length_spacing;
    for (std::size_t i = 1; i < h.size(); ++i) h[i] = std::max(h[i], h[i - 1] - rise);
    for (std::size_t i = h.size() - 1; i-- > 0;) h[i] = std::max(h[i], h[i + 1] - rise);
    // The mean of the highest neighbouring values is not below the value itself. The subsequent spline spreads over three points.
    const auto reach = static_cast<std::size_t>(std::lround(0.25 * s.smoothing / plan.length_spacing));
    plan.up = mean_within(mean_within(highest_within(h, 2 * reach + 3), reach), reach);
}

}  // namespace schuler::sim
