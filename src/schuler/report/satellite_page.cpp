// The page of a receiver's satellites: sky plot, numbers of satellites and dilution, C/N0, residuals.
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/report/satellite_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace schuler::report {
namespace {

using gnss::EpochView;
using gnss::Fate;
using gnss::SatelliteView;

constexpr const char* time_label = "time, s";

Ink ink_of(gnss::System system) {
    switch (system) {
        case gnss::System::Gps: return Ink::Blue;
        case gnss::System::Glonass: return Ink::Vermillion;
        case gnss::System::Galileo: return Ink::Green;
        case gnss::System::BeiDou: return Ink::Orange;
        case gnss::System::Qzss: return Ink::Purple;
        default: return Ink::Sky;
    }
}

struct Clock {
    Time zero;
    [[nodiscard]] double operator()(const EpochView& e) const { return (e.tag - zero).seconds(); }
};

/// One curve per satellite: x and y of every epoch in which it is present.
class BySatellite {
public:
    Series& of(const SatelliteView& v) {
        Series& s = curves_[v.satellite];
        if (s.name.empty()) {
            s.name = gnss::name_of(v.satellite);
            s.ink = ink_of(v.satellite.system);
        }
        return s;
    }
    void add(const SatelliteView& v, double x, double y) {
        Series& s = of(v);
        s.x.push_back(x);
        s.y.push_back(y);
    }
    [[nodiscard]] std::vector<Series> curves(Mark mark) const {
        std::vector<Series> out;
        for (const auto& [id, s] : curves_) {
            if (s.x.empty()) continue;
            out.push_back(s);
            out.back().mark = mark;
        }
        return out;
    }

private:
    std::map<gnss::SatelliteId, Series> curves_;
};

Panel panel(std::string title, std::string y_label) {
    return {.title = std::move(title), .x_label = time_label, .y_label = std::move(y_label)};
}

/// North is up; the distance from the centre is the zenith distance.
Panel sky_plot(const dataset::SatelliteViews& views) {
    Panel p{.title = "sky: north is up, the rings are elevations of 60, 30 and 0 deg",
            .x_label = "zenith distance east, deg",
            .y_label = "zenith distance north, deg",
            .time_axis = false,
            .equal_axes = true,
            .height = 560};
    p.x_limits = p.y_limits = std::pair{-95.0, 95.0};
    for (const double ring : {30.0, 60.0, 90.0}) {
        Series s;
        s.ink = Ink::Muted;
        s.width = 0.7;
        for (int k = 0; k <= 120; ++k) {
            const double a = k * 2.0 * std::numbers::pi / 120.0;
            s.x.push_back(ring * std::sin(a));
            s.y.push_back(ring * std::cos(a));
        }
        p.series.push_back(std::move(s));
    }
    const auto place = [](const SatelliteView& v) {
        const double z = 90.0 - v.direction.elevation / units::deg;
        return std::pair{z * std::sin(v.direction.azimuth), z * std::cos(v.direction.azimuth)};
    };
    BySatellite used;
    Series others{.name = "not used", .x = {}, .y = {}, .ink = Ink::Muted, .mark = Mark::Dots};
    for (const EpochView& e : views.epochs) {
        for (const SatelliteView& v : e.satellites) {
            if (!std::isfinite(v.direction.elevation)) continue;
            const auto [x, y] = place(v);
            if (v.fate == Fate::Used) {
                used.add(v, x, y);
            } else {
                others.x.push_back(x);
                others.y.push_back(y);
            }
        }
    }
    if (!others.x.empty()) p.series.push_back(std::move(others));
    for (Series& s : used.curves(Mark::Dots)) p.series.push_back(std::move(s));
    return p;
}

Group numbers_group(const dataset::SatelliteViews& views, const Clock& clock) {
    Group g{.title = "", .panels = {}, .tables = {}};
    Panel count = panel("satellites", "satellites"), dop = panel("dilution of precision", "dilution"),
          protection = panel("protection levels", "protection level, m");
    Series seen{.name = "tracked", .x = {}, .y = {}, .ink = Ink::Muted}, used{.name = "used", .x = {}, .y = {}};
    Series position{.name = "position", .x = {}, .y = {}}, horizontal{.name = "horizontal", .x = {}, .y = {}, .ink = Ink::Green},
        vertical{.name = "vertical", .x = {}, .y = {}, .ink = Ink::Vermillion};
    Series hpl{.name = "horizontal", .x = {}, .y = {}, .ink = Ink::Green},
        vpl{.name = "vertical", .x = {}, .y = {}, .ink = Ink::Vermillion};
    for (const EpochView& e : views.epochs) {
        const double t = clock(e);
        for (const auto& [series, value] :
             {std::pair{&seen, static_cast<double>(e.satellites.size())},
              std::pair{&used, static_cast<double>(e.solution.used())}, std::pair{&position, e.dilution.position},
              std::pair{&horizontal, e.dilution.horizontal}, std::pair{&vertical, e.dilution.vertical},
              std::pair{&hpl, e.protection.horizontal}, std::pair{&vpl, e.protection.vertical}}) {
            series->x.push_back(t);
            series->y.push_back(value);
        }
    }
    count.series = {seen, used};
    dop.series = {position, horizontal, vertical};
    protection.series = {hpl, vpl};
    protection.log_y = true;
    g.panels = {count, dop, protection};
    return g;
}

/// The track, each epoch relative to the first.
Panel scatter(const dataset::SatelliteViews& views) {
    Panel p{.title = "positions from the first one",
            .x_label = "east, m",
            .y_label = "north, m",
            .time_axis = false,
            .equal_axes = true,
            .height = 420};
    std::optional<Ecef> origin;
    Eigen::Matrix3d C_ne;
    const auto add = [&](Series& s, const Ecef& position) {
        if (!origin) {
            origin = position;
            const Geodetic g = earth::geodetic_from_ecef(earth::wgs84, position);
            C_ne = earth::C_en(g.lat, g.lon).transpose();
        }
        const Eigen::Vector3d d = C_ne * (position.r - origin->r);
        s.x.push_back(d[1]);
        s.y.push_back(d[0]);
    };
    Series single{.name = "single point", .x = {}, .y = {}, .ink = Ink::Sky, .mark = Mark::Dots};
    Series fixed{.name = "fixed", .x = {}, .y = {}, .ink = Ink::Green, .mark = Mark::Dots},
        floating{.name = "float", .x = {}, .y = {}, .ink = Ink::Orange, .mark = Mark::Dots};
    if (views.carrier)
        for (const ppk::EpochSolution& e : views.carrier->epochs) {
            if (e.quality == ppk::Quality::Fixed) add(fixed, e.position);
            if (e.quality == ppk::Quality::Float) add(floating, e.position);
        }
    for (const EpochView& e : views.epochs)
        if (e.solution.status == gnss::SinglePointStatus::Solved) add(single, e.solution.position);
    for (Series* s : {&single, &floating, &fixed})
        if (!s->x.empty()) p.series.push_back(*s);
    return p;
}

Section residual_section(const dataset::SatelliteViews& views, const Clock& clock) {
    Section section{
        "Residuals",
        "Measured minus modelled, of the satellites that were used. A satellite whose residuals keep to one side has a slow error: "
        "of its orbit or clock, of the atmosphere, or of a reflection.",
        {}};
    for (std::size_t i = 0; i < gnss::system_count; ++i) {
        const auto system = static_cast<gnss::System>(i);
        BySatellite code, rate;
        for (const EpochView& e : views.epochs) {
            for (const SatelliteView& v : e.satellites) {
                if (v.fate != Fate::Used || v.satellite.system != system) continue;
                code.add(v, clock(e), v.residual);
                if (std::isfinite(v.rate_residual)) rate.add(v, clock(e), v.rate_residual);
            }
        }
        Group g{.title = fmt::format("system {}", gnss::letter_of(system)), .panels = {}, .tables = {}};
        for (const auto& [title, label, by] :
             {std::tuple{"pseudoranges", "residual, m", &code}, std::tuple{"range rates", "residual, m/s", &rate}}) {
            Panel p = panel(title, label);
            p.series = by->curves(Mark::Dots);
            // satellites of one system share a plot: their colours are reused cyclically
            constexpr std::array inks{Ink::Blue, Ink::Vermillion, Ink::Green, Ink::Orange, Ink::Purple, Ink::Sky};
            for (std::size_t k = 0; k < p.series.size(); ++k) p.series[k].ink = inks[k % inks.size()];
            if (!p.series.empty()) g.panels.push_back(std::move(p));
        }
        if (!g.panels.empty()) section.groups.push_back(std::move(g));
    }
    return section;
}

/// Phases relative to the base, and the state of their integers.
Section carrier_section(const dataset::CarrierPhase& carrier, Time zero) {
    Section section{"Carrier phase against the base",
                    "Residuals of differences rover less base, less the median of their system and carrier.",
                    {}};
    Group g;
    Panel quality = panel("solution", "1 fixed, 2 float, 5 single"), ratio = panel("ratio test of the integers", "ratio"),
          phase = panel("phases", "residual, m"), slips = panel("phase arcs restarted", "arcs");
    Series q{.name = "", .x = {}, .y = {}, .mark = Mark::Dots}, r{.name = "", .x = {}, .y = {}},
        n{.name = "", .x = {}, .y = {}, .ink = Ink::Vermillion, .mark = Mark::Squares};
    std::map<std::pair<gnss::SatelliteId, char>, Series> phases;
    const auto begun = slips_of(carrier);
    for (std::size_t i = 0; i < carrier.epochs.size(); ++i) {
        const ppk::EpochSolution& e = carrier.epochs[i];
        const double t = (e.tag - zero).seconds();
        q.x.push_back(t);
        q.y.push_back(static_cast<double>(e.quality));
        r.x.push_back(t);
        r.y.push_back(e.ratio > 0.0 ? e.ratio : not_given);
        if (const auto count = std::ranges::count(begun[i], true); count > 0) {
            n.x.push_back(t);
            n.y.push_back(static_cast<double>(count));
        }
        for (const ppk::SignalView& s : e.signals) {
            Series& curve = phases[{s.satellite, s.band}];
            curve.name = fmt::format("{} band {}", gnss::name_of(s.satellite), s.band);
            curve.ink = ink_of(s.satellite.system);
            curve.mark = Mark::Dots;
            curve.x.push_back(t);
            curve.y.push_back(s.phase);
        }
    }
    quality.series = {q};
    ratio.series = {r};
    ratio.log_y = true;
    for (auto& [key, curve] : phases) phase.series.push_back(std::move(curve));
    slips.series = {n};
    g.panels = {quality, ratio, phase};
    if (!n.x.empty()) g.panels.push_back(slips);
    section.groups.push_back(std::move(g));
    return section;
}

}  // namespace

ReportInput satellite_page(const SatelliteReportInput& in) {
    const dataset::SatelliteViews& views = *in.views;
    const Clock clock{views.epochs.front().tag};
    ReportInput page;
    page.title = in.name + ": satellites";
    page.subtitle = "single-point solution of the receiver's raw measurements, epoch by epoch";
    page.version = in.version;
    page.warnings = in.warnings;
    const auto solved =
        std::ranges::count(views.epochs, gnss::SinglePointStatus::Solved, [](const EpochView& e) { return e.solution.status; });
    page.cards = {{"epochs", std::to_string(views.epochs.size())},
                  {"solved", std::to_string(solved)},
                  {"satellites", std::to_string(satellites_of(views).size()), "tracked at any time"}};
    BySatellite cn0;
    for (const EpochView& e : views.epochs)
        for (const SatelliteView& v : e.satellites)
            if (std::isfinite(v.cn0)) cn0.add(v, clock(e), v.cn0);
    Panel strength = panel("carrier to noise density ratio", "C/N0, dB-Hz");
    strength.series = cn0.curves(Mark::Dots);
    page.sections.push_back(
        {"Sky", "", {{.title = "", .panels = {sky_plot(views), scatter(views)}, .tables = {satellite_table(views)}}}});
    Section numbers{"Geometry", "", {numbers_group(views, clock)}};
    if (!strength.series.empty()) numbers.groups.front().panels.push_back(std::move(strength));
    page.sections.push_back(std::move(numbers));
    page.sections.push_back(residual_section(views, clock));
    if (views.carrier) page.sections.push_back(carrier_section(*views.carrier, clock.zero));
    return page;
}

}  // namespace schuler::report
