#include "schuler/report/detail/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::report::detail {
namespace {

// Above this a width would overflow to infinity.
constexpr double largest_drawn = 1e150;

// Widens an interval by a fraction of its width on both sides, and a zero-width interval to a drawable one.
Range padded(Range range, double fraction) {
    const double size = std::max(std::abs(range.lo), std::abs(range.hi));
    if (range.width() <= 1e-9 * size || range.width() == 0.0) {
        const double half = size > 0.0 ? 0.1 * size : 1.0;
        return {range.lo - half, range.hi + half};
    }
    return {range.lo - fraction * range.width(), range.hi + fraction * range.width()};
}

void take_value(Range& y, double v, bool log_y) {
    if (!log_y) y.take(v);
    else if (v > 0.0) y.take(std::log10(v));
}

bool outside_limits(const Panel& panel, double x) {
    return panel.x_limits && (x < panel.x_limits->first || x > panel.x_limits->second);
}

void take_band(DataRange& range, const Band& band, const Panel& panel) {
    const std::size_t settled = band.x.size() / 20;
    for (std::size_t i = 0; i < band.x.size(); ++i) {
        if (outside_limits(panel, band.x[i])) continue;
        range.x.take(band.x[i]);
        if (i < settled) continue;
        take_value(range.y, band.lo[i], panel.log_y);
        take_value(range.y, band.hi[i], panel.log_y);
    }
}

}  // namespace

void Range::take(double v) {
    if (!(std::abs(v) <= largest_drawn)) return;
    if (empty()) {
        lo = hi = v;
    } else {
        lo = std::min(lo, v);
        hi = std::max(hi, v);
    }
}

std::vector<Tick> ticks_every(Range range, double step, int decimals) {
    const double largest = std::max(std::abs(range.lo), std::abs(range.hi));
    const bool plain = largest < 1e7 && decimals <= 6;
    // Otherwise as many digits as distinguish neighbours.
    const int digits = std::clamp(static_cast<int>(std::ceil(std::log10(largest / step))) + 1, 6, 15);
    std::vector<Tick> ticks;
    const double first = std::ceil(range.lo / step - 1e-9);
    for (int k = 0; k < 100; ++k) {
        const double value = (first + k) * step;
        if (value > range.hi + 1e-9 * step) break;
        const double shown = std::abs(value) < 1e-6 * step ? 0.0 : value;
        ticks.push_back({shown, plain ? fmt::format("{:.{}f}", shown, decimals) : fmt::format("{:.{}g}", shown, digits)});
    }
    return ticks;
}

std::vector<Tick> linear_ticks(Range range, double target) {
    if (range.empty() || !(range.width() > 0.0)) return {};
    const double raw = range.width() / std::max(target, 0.1);
    double power = std::floor(std::log10(raw));
    const double mantissa = raw / std::pow(10.0, power);
    const double lead = mantissa < 1.5 ? 1.0 : mantissa < 3.5 ? 2.0 : mantissa < 7.5 ? 5.0 : 10.0;
    const double step = lead * std::pow(10.0, power);
    if (lead == 10.0) power += 1.0;
    return ticks_every(range, step, std::max(0, -static_cast<int>(power)));
}

std::vector<Tick> log_ticks(Range range) {
    std::vector<Tick> ticks;
    if (range.empty()) return ticks;
    const int stride = std::max(1, static_cast<int>(std::ceil(range.width() / 6.0)));
    for (int power = static_cast<int>(std::floor(range.lo)); power <= range.hi; ++power) {
        for (const double lead : {1.0, 2.0, 5.0}) {
            if (lead > 1.0 && range.width() > 2.0) continue;
            if (power % stride != 0) continue;
            const double value = power + std::log10(lead);
            if (value < range.lo - 1e-9 || value > range.hi + 1e-9) continue;
            ticks.push_back({value, fmt::format("{:g}", lead * std::pow(10.0, power))});
        }
    }
    return ticks;
}

DataRange data_range(const Panel& panel) {
    DataRange range;
    for (const Series& series : panel.series) {
        for (std::size_t i = 0; i < series.x.size(); ++i) {
            if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i]) || outside_limits(panel, series.x[i])) continue;
            range.x.take(series.x[i]);
            take_value(range.y, series.y[i], panel.log_y);
        }
    }
    for (const Band& band : panel.bands) take_band(range, band, panel);
    if (panel.y_limits && panel.y_limits->first < panel.y_limits->second) {
        const auto [lo, hi] = *panel.y_limits;
        Range limits;
        take_value(limits, lo, panel.log_y);
        take_value(limits, hi, panel.log_y);
        if (!range.y.empty() && limits.width() > 0.0) range.y = limits;
    } else if (!range.y.empty()) {
        range.y = padded(range.y, 0.05);
    }
    if (!range.x.empty() && panel.x_limits && panel.x_limits->first < panel.x_limits->second) {
        range.x = {};
        range.x.take(panel.x_limits->first);
        range.x.take(panel.x_limits->second);
    }
    if (!range.x.empty()) range.x = padded(range.x, panel.equal_axes ? 0.04 : 0.0);
    if (range.y.empty()) range.x = {};
    if (range.x.empty()) range.y = {};
    return range;
}

}  // namespace schuler::report::detail
