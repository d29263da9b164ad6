// Errors relative to a reference with three-sigma bands, or the uncertainty alone; estimated sensor errors.
#include "schuler/core/units.h"
#include "schuler/report/detail/run_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace schuler::report::detail {
namespace {

using Field = Eigen::Vector3d ErrorPoint::*;

// Display of a vector component: index, sign and name.
struct Component {
    int axis;
    double sign;
    const char* name;
};
constexpr std::array<Component, 3> east_north_up{{{1, 1.0, "East"}, {0, 1.0, "North"}, {2, -1.0, "Up"}}};
constexpr std::array<Component, 3> roll_pitch_heading{{{0, 1.0, "Roll"}, {1, 1.0, "Pitch"}, {2, 1.0, "Heading"}}};

struct Quantity {
    const char* title;
    const char* unit;
    double unit_si;
    Field error, sigma;
    std::array<Component, 3> components;
};
const std::array<Quantity, 3> quantities{{
    {"Position", "m", 1.0, &ErrorPoint::position, &ErrorPoint::std_position, east_north_up},
    {"Velocity", "m/s", 1.0, &ErrorPoint::velocity, &ErrorPoint::std_velocity, east_north_up},
    {"Attitude", "deg", units::deg, &ErrorPoint::rpy, &ErrorPoint::std_rpy, roll_pitch_heading},
}};

std::string lower(std::string text) {
    if (!text.empty() && text.front() >= 'A' && text.front() <= 'Z') text.front() = static_cast<char>(text.front() - 'A' + 'a');
    return text;
}

Series error_series(const RunReportData& data, const std::vector<ErrorPoint>& points, const Quantity& q, const Component& c) {
    Series out{.name = "error", .x = {}, .y = {}};
    for (const ErrorPoint& p : points) {
        out.x.push_back(axis_seconds(data, p.time));
        out.y.push_back(c.sign * (p.*q.error)[c.axis] / q.unit_si);
    }
    break_at_gaps(out);
    return out;
}

// Percentage of the evaluated errors within three sigma; empty without epochs.
std::optional<double> percent_inside(const RunReportData& data, const Quantity& q, const Component& c) {
    std::size_t inside = 0, all = 0;
    for (const ErrorPoint& p : data.errors) {
        const double e = std::abs((p.*q.error)[c.axis]), s = (p.*q.sigma)[c.axis];
        if (axis_seconds(data, p.time) < data.settled_after_s || !std::isfinite(e) || !std::isfinite(s)) continue;
        ++all;
        inside += e <= 3.0 * s ? 1 : 0;
    }
    if (all == 0) return std::nullopt;
    return 100.0 * static_cast<double>(inside) / static_cast<double>(all);
}

bool has_values(const std::vector<ErrorPoint>& points, const Quantity& q) {
    for (const ErrorPoint& p : points) {
        for (int axis = 0; axis < 3; ++axis) {
            if (std::isfinite((p.*q.error)[axis])) return true;
        }
    }
    return false;
}

std::string error_title(const Quantity& q, const Component& c) {
    return q.error == &ErrorPoint::rpy ? fmt::format("{} error", c.name) : fmt::format("{} {} error", c.name, lower(q.title));
}

Panel error_panel(const RunReportData& data, const Quantity& q, const Component& c) {
    Panel panel = time_panel(data, error_title(q, c), fmt::format("error, {}", q.unit), true);
    Band band{.name = data.smoothed ? "±3σ, smoothed" : "±3σ", .x = {}, .lo = {}, .hi = {}};
    for (const ErrorPoint& p : data.errors) {
        const double s = 3.0 * (p.*q.sigma)[c.axis] / q.unit_si;
        band.x.push_back(axis_seconds(data, p.time));
        band.lo.push_back(-s);
        band.hi.push_back(s);
    }
    break_at_gaps(band);
    panel.bands.push_back(std::move(band));
    if (!data.forward_errors.empty()) {
        Series forward = error_series(data, data.forward_errors, q, c);
        forward.name = "forward";
        forward.ink = Ink::Orange;
        forward.width = 1.0;
        panel.series.push_back(std::move(forward));
    }
    Series error = error_series(data, data.errors, q, c);
    if (data.smoothed) error.name = "smoothed";
    panel.series.push_back(std::move(error));
    return panel;
}

// Large errors during start-up and outages reduce the rest of the run to a flat line. The same panel at the scale of the rest;
// empty if the scales are similar.
std::optional<Panel> close_up(const RunReportData& data, const Panel& panel) {
    constexpr double much_larger = 6.0;
    double outside = 0.0, all = 0.0;
    const auto take = [&](double t, double v) {
        if (!std::isfinite(v)) return;
        all = std::fmax(all, std::abs(v));
        // The first seconds after an outage still contain its error.
        const bool near = std::any_of(data.outages.begin(), data.outages.end(), [t](const OutageEntry& o) {
            return t >= o.start_s && t <= o.start_s + 1.5 * o.duration_s + 2.0;
        });
        if (!near && t >= data.settled_after_s) outside = std::fmax(outside, std::abs(v));
    };
    for (const Series& s : panel.series) {
        for (std::size_t i = 0; i < s.x.size(); ++i) take(s.x[i], s.y[i]);
    }
    const Band& band = panel.bands.front();
    for (std::size_t i = band.x.size() / 20; i < band.x.size(); ++i) take(band.x[i], band.hi[i]);  // as in data_range
    if (outside == 0.0 || all < much_larger * outside) return std::nullopt;
    Panel out = panel;
    out.title += ", enlarged: scale without start-up and outages";
    out.y_limits = {-1.1 * outside, 1.1 * outside};
    return out;
}

TableBlock accuracy_table(const RunReportData& data) {
    TableBlock table{data.settled_after_s > 0.0 ? fmt::format("Errors counted from {:g} s", data.settled_after_s) : "Errors",
                     {"quantity", "unit", "RMS", "95 %", "largest"},
                     {}};
    for (const AccuracyEntry& a : data.accuracy) {
        table.rows.push_back({a.quantity, a.unit, number(a.rms, 3), number(a.p95, 3), number(a.max, 3)});
    }
    return table;
}

TableBlock inside_table(const RunReportData& data) {
    TableBlock table{"Errors inside ±3σ (99.7 % expected)", {"quantity", "component", "inside, %"}, {}};
    for (const Quantity& q : quantities) {
        for (const Component& c : q.components) {
            if (const std::optional<double> p = percent_inside(data, q, c)) {
                table.rows.push_back({lower(q.title), lower(c.name), fmt::format("{:.1f}", *p)});
            }
        }
    }
    return table;
}

// The axes of a sensor triad for one kind of error as three panels with their bands.
struct SensorQuantity {
    const char* title;
    const char* label;
    const char* unit;
    double unit_si;
    Eigen::Vector3d SensorErrorPoint::*value;
    Eigen::Vector3d SensorErrorPoint::*sigma;
};

Group sensor_group(const RunReportData& data, const SensorQuantity& q) {
    constexpr std::array<const char*, 3> axes{"x (forward)", "y (right)", "z (down)"};
    Group group{q.title, {}, {}};
    TableBlock table{"At the end", {"axis", "unit", "estimate", "1σ"}, {}};
    for (int axis = 0; axis < 3; ++axis) {
        const std::string name = axes[static_cast<std::size_t>(axis)];
        Panel panel = time_panel(data, fmt::format("{}, {}", q.title, name), fmt::format("{}, {}", q.label, q.unit));
        panel.height = 180;
        Series estimate{.name = "estimate", .x = {}, .y = {}};
        Band band{.name = "estimate ±3σ", .x = {}, .lo = {}, .hi = {}};
        for (const SensorErrorPoint& p : data.sensor_errors) {
            const double v = (p.*q.value)[axis] / q.unit_si, s = 3.0 * (p.*q.sigma)[axis] / q.unit_si;
            estimate.x.push_back(axis_seconds(data, p.time));
            estimate.y.push_back(v);
            band.lo.push_back(v - s);
            band.hi.push_back(v + s);
        }
        band.x = estimate.x;
        panel.bands.push_back(std::move(band));
        panel.series.push_back(std::move(estimate));
        if (!data.sensor_truth.empty()) {
            Series truth{.name = "truth", .x = {}, .y = {}, .ink = Ink::Green, .mark = Mark::Dashed};
            for (const SensorErrorPoint& p : data.sensor_truth) {
                truth.x.push_back(axis_seconds(data, p.time));
                truth.y.push_back((p.*q.value)[axis] / q.unit_si);
            }
            panel.series.push_back(std::move(truth));
        }
        group.panels.push_back(std::move(panel));
        const SensorErrorPoint& last = data.sensor_errors.back();
        table.rows.push_back(
            {name, q.unit, number((last.*q.value)[axis] / q.unit_si, 4), number((last.*q.sigma)[axis] / q.unit_si, 3)});
    }
    group.tables.push_back(std::move(table));
    return group;
}

bool estimated(const RunReportData& data, Eigen::Vector3d SensorErrorPoint::*sigma) {
    for (const SensorErrorPoint& p : data.sensor_errors) {
        if (((p.*sigma).array() > 0.0).any()) return true;
    }
    return false;
}

}  // namespace

Section error_section(const RunReportData& data) {
    Section section{"Errors", "", {}};
    if (data.errors.empty()) return section;
    section.intro = fmt::format("Estimate minus {} with the filter's own three sigma.",
                                data.reference_name.empty() ? "reference" : data.reference_name);
    for (const Quantity& q : quantities) {
        if (!has_values(data.errors, q)) continue;
        Group group{q.title, {}, {}};
        for (const Component& c : q.components) group.panels.push_back(error_panel(data, q, c));
        for (std::size_t i = 0; i < q.components.size(); ++i) {
            if (std::optional<Panel> panel = close_up(data, group.panels[i])) group.panels.push_back(std::move(*panel));
        }
        section.groups.push_back(std::move(group));
    }
    if (section.groups.empty()) return section;
    Group& last = section.groups.back();
    if (!data.accuracy.empty()) last.tables.push_back(accuracy_table(data));
    last.tables.push_back(inside_table(data));
    return section;
}

Section uncertainty_section(const RunReportData& data) {
    Section section{"Uncertainty", "One sigma of the solution, as the filter sees it.", {}};
    if (data.solution.empty()) return section;
    using Sigma = Eigen::Vector3d SolutionRow::*;
    constexpr std::array<Sigma, 3> sigmas{&SolutionRow::std_position, &SolutionRow::std_velocity, &SolutionRow::std_rpy};
    constexpr std::array<Ink, 3> inks{Ink::Blue, Ink::Vermillion, Ink::Green};
    Group group;
    TableBlock table{"At the end", {"quantity", "component", "1σ", "unit"}, {}};
    for (std::size_t k = 0; k < quantities.size(); ++k) {
        const Quantity& q = quantities[k];
        Panel panel = time_panel(data, fmt::format("{}, one sigma", q.title), fmt::format("1σ, {}", q.unit));
        panel.log_y = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const Component& c = q.components[i];
            Series series{.name = lower(c.name), .x = {}, .y = {}, .ink = inks[i], .mark = i == 2 ? Mark::Dashed : Mark::Line};
            for (const SolutionRow& row : data.solution) {
                series.x.push_back(axis_seconds(data, row.time));
                series.y.push_back((row.*sigmas[k])[c.axis] / q.unit_si);
            }
            if (!series.y.empty()) table.rows.push_back({lower(q.title), series.name, number(series.y.back(), 3), q.unit});
            panel.series.push_back(std::move(series));
        }
        group.panels.push_back(std::move(panel));
    }
    group.tables.push_back(std::move(table));
    section.groups.push_back(std::move(group));
    return section;
}

Section sensor_section(const RunReportData& data) {
    Section section{"Sensor errors", "Estimated errors of the inertial sensors in body axes with three sigma.", {}};
    if (data.sensor_errors.empty()) return section;
    constexpr double large_accel = 5.0 * units::mg;
    bool milli = false;
    for (const SensorErrorPoint& p : data.sensor_errors) milli = milli || (p.accel_bias.array().abs() > large_accel).any();
    using P = SensorErrorPoint;
    section.groups.push_back(
        sensor_group(data, {"Gyro bias", "bias", "deg/h", units::deg_per_hour, &P::gyro_bias, &P::std_gyro_bias}));
    section.groups.push_back(sensor_group(data, {"Accelerometer bias", "bias", milli ? "mg" : "µg", milli ? units::mg : units::ug,
                                                 &P::accel_bias, &P::std_accel_bias}));
    if (estimated(data, &P::std_gyro_scale)) {
        section.groups.push_back(
            sensor_group(data, {"Gyro scale factor", "scale error", "ppm", units::ppm, &P::gyro_scale, &P::std_gyro_scale}));
    }
    if (estimated(data, &P::std_accel_scale)) {
        section.groups.push_back(sensor_group(
            data, {"Accelerometer scale factor", "scale error", "ppm", units::ppm, &P::accel_scale, &P::std_accel_scale}));
    }
    return section;
}

}  // namespace schuler::report::detail
