// Paper A, sections 4.2 and 4.3: the flight and its filter.
#include "schuler/analysis/ensemble.h"
#include "schuler/analysis/errors.h"
#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/report/result_table.h"
#include "schuler/sim/path.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::study {
namespace {

using Eigen::Vector3d;
using solution::ResultBundle;

ResultBundle flown(std::uint64_t seed, const settings::SettingList& over) {
    WarningLog unheard;
    const settings::ScenarioConfig scenario = paper_scenario("paper-a-flight.toml", seed, over);
    ResultBundle b = solution::simulated_bundle(scenario, {}, unheard);
    solution::fuse_and_evaluate(b, unheard, scenario.sim.reference_rate, {});
    return b;
}

settings::SettingList outage() {
    const settings::ValueTable one{{"start_s", {600.0}}, {"duration_s", {100.0}}, {"sensor", {std::string("gnss")}}};
    return {{"outage", {settings::ValueList{settings::Value{one}}}, {}}};
}

// --- section 4.2: the path ---

struct Flown {
    std::vector<double> t, east, north, up, roll, pitch, heading;
    double latitude = 0.0, longitude = 0.0, mean_height = 0.0, height_amplitude = 0.0, latitude_amplitude = 0.0,
           longitude_rate = 0.0, period = 0.0;
};
Flown path_of_paper() {
    const earth::Earth earth;
    const auto path = sim::make_path(sim::PaperAPath{}, earth.ellipsoid);
    const Geodetic start = path->at(0.0).position;
    Flown f;
    double low = 1e9, high = -1e9, south = 1e9, north = -1e9, before = 0.0;
    for (int i = 0; i <= 800; ++i) {
        const sim::Kinematics k = path->at(i);
        f.t.push_back(i);
        f.east.push_back((k.position.lon - start.lon) * std::cos(start.lat) * 6.378e3);
        f.north.push_back((k.position.lat - start.lat) * 6.367e3);
        f.up.push_back(1e-3 * k.position.h);
        f.roll.push_back(k.rpy.x() / units::deg);
        f.pitch.push_back(k.rpy.y() / units::deg);
        f.heading.push_back(k.rpy.z() / units::deg);
        low = std::min(low, k.position.h);
        high = std::max(high, k.position.h);
        south = std::min(south, k.position.lat);
        north = std::max(north, k.position.lat);
        const double off = k.position.lat - start.lat;
        if (i > 10 && before < 0.0 && off >= -1e-9) f.period = i;
        before = off;
    }
    f.latitude = start.lat / units::deg;
    f.longitude = start.lon / units::deg;
    f.mean_height = 0.5 * (low + high);
    f.height_amplitude = 0.5 * (high - low);
    f.latitude_amplitude = 0.5 * (north - south);
    f.longitude_rate = (path->at(800.0).position.lon - start.lon) / 800.0;
    return f;
}

PaperResult figure_421(const PaperWork&) {
    const Flown f = path_of_paper();
    PaperResult out;
    // clang-format off
    out.numbers = {{"latitude", f.latitude}, {"longitude", f.longitude}, {"mean height", f.mean_height}, {"height amplitude", f.height_amplitude},
                   {"latitude amplitude", f.latitude_amplitude}, {"longitude rate", f.longitude_rate}, {"period", f.period}};
    // clang-format on
    // Viewed from the south-west, 25 deg above the horizon; heights magnified by three.
    const auto seen = [&](double stretch) {
        report::Series s;
        const double azimuth = 35.0 * units::deg, tilt = 25.0 * units::deg;
        for (std::size_t i = 0; i < f.t.size(); ++i) {
            const double right = f.east[i] * std::cos(azimuth) - f.north[i] * std::sin(azimuth),
                         away = f.east[i] * std::sin(azimuth) + f.north[i] * std::cos(azimuth);
            s.x.push_back(right);
            s.y.push_back(away * std::sin(tilt) + stretch * f.up[i] * std::cos(tilt));
        }
        return s;
    };
    report::Panel space{"the flight in three dimensions: seen from the south-west, heights threefold", "km", "km"};
    space.time_axis = false;
    space.height = 380;
    report::Series track = seen(3.0), shadow = seen(0.0);
    track.name = "flight";
    shadow.name = "its shadow on the ground";
    shadow.ink = report::Ink::Muted;
    for (std::size_t i = 0; i < f.t.size(); i += 50)
        space.series.push_back(paper_curve("", {track.x[i], shadow.x[i]}, {track.y[i], shadow.y[i]}, report::Ink::Sky));
    space.series.push_back(std::move(shadow));
    space.series.push_back(std::move(track));
    report::Panel map{"on the map", "east, km", "north, km"};
    map.time_axis = false;
    map.equal_axes = true;
    map.height = 300;
    map.series = {paper_curve("flight", f.east, f.north)};
    report::Panel height{"height", "time, s", "km"};
    height.series = {paper_curve("height", f.t, f.up)};
    out.panels = {std::move(space), std::move(map), std::move(height)};
    return out;
}

PaperResult figure_422(const PaperWork&) {
    const Flown f = path_of_paper();
    PaperResult out;
    for (const auto& [name, y] : {std::pair{"heading", &f.heading}, std::pair{"pitch", &f.pitch}, std::pair{"roll", &f.roll}}) {
        report::Panel p{name, "time, s", "deg"};
        p.series = {paper_curve(name, f.t, *y)};
        out.panels.push_back(std::move(p));
    }
    out.notes = "Roll by (4.2.5) with K = 0.02 rad/(m/s2): a coordinated turn has 0.102.\n";
    return out;
}

// --- section 4.3: the filter ---

/// A block of states over time, three axes.
void add_block(PaperResult& out, const ResultBundle& b, std::size_t block, const std::array<const char*, 3>& axes,
               const char* quantity, const char* unit, double si) {
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> t, error;
        for (const solution::StateErrors& s : b.evaluation.states) {
            t.push_back(b.relative(s.time));
            error.push_back(s.error[block][axis] / si);
        }
        report::Panel p{fmt::format("{} {}", quantity, axes[static_cast<std::size_t>(axis)]), "time, s", unit};
        p.height = 160;
        p.series = {paper_curve("estimate less truth", std::move(t), std::move(error))};
        out.panels.push_back(std::move(p));
    }
}
/// Three-sigma bands of the solution in the panels of the first block.
void add_bands(PaperResult& out, const ResultBundle& b, Vector3d analysis::ErrorRow::*sigma, const Vector3d& si) {
    for (int axis = 0; axis < 3; ++axis) {
        report::Band band{"three sigma", {}, {}, {}, report::Ink::Sky};
        for (const analysis::ErrorRow& e : b.evaluation.errors) {
            const double s = 3.0 * (e.*sigma)[axis] / si[axis];
            band.x.push_back(b.relative(e.time));
            band.lo.push_back(-s);
            band.hi.push_back(s);
        }
        out.panels[static_cast<std::size_t>(axis)].bands.push_back(std::move(band));
    }
}

constexpr std::array enu{"east", "north", "up"};
constexpr std::array xyz{"x", "y", "z"};

PaperResult figure_431(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    add_block(out, b, 0, enu, "position", "m", 1.0);
    add_bands(out, b, &analysis::ErrorRow::std_position, Vector3d::Ones());
    return out;
}
PaperResult figure_432(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    add_block(out, b, 1, enu, "velocity", "m/s", 1.0);
    add_bands(out, b, &analysis::ErrorRow::std_velocity, Vector3d::Ones());
    return out;
}
PaperResult figure_433(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    add_block(out, b, 2, {"about east", "about north", "about up (azimuth)"}, "attitude", "1e-3 rad", 1e-3);
    out.notes =
        "Tilts converge at once, the azimuth with the turns: see `schuler run examples/paper-a-flight.toml` for the sigmas.\n";
    return out;
}
PaperResult figure_434(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    add_block(out, b, 3, xyz, "gyro bias", "deg/h", units::deg_per_hour);
    return out;
}
PaperResult figure_435(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    add_block(out, b, 4, xyz, "accelerometer bias", "ug", units::ug);
    return out;
}
PaperResult figure_436(const PaperWork& w) {
    const ResultBundle b = flown(w.seed, {});
    PaperResult out;
    for (int axis = 0; axis < 3; ++axis) {
        report::Panel p{std::array{"roll", "pitch", "heading"}[static_cast<std::size_t>(axis)], "time, s", "deg"};
        std::vector<double> t, e;
        for (const analysis::ErrorRow& row : b.evaluation.errors) {
            t.push_back(b.relative(row.time));
            e.push_back(row.rpy[axis] / units::deg);
        }
        p.series = {paper_curve("estimate less truth", std::move(t), std::move(e))};
        out.panels.push_back(std::move(p));
    }
    add_bands(out, b, &analysis::ErrorRow::std_rpy, Vector3d::Constant(units::deg));
    return out;
}

PaperResult figure_437(const PaperWork& w) {
    std::vector<double> largest(w.runs);
    PaperResult out;
    std::vector<std::array<std::vector<double>, 4>> course(w.runs);
    for_each_run(
        w.runs, w.jobs,
        [&](std::size_t run) {
            const ResultBundle b = flown(w.seed + run, outage());
            for (const analysis::ErrorRow& e : b.evaluation.errors) {
                const double t = b.relative(e.time);
                if (t < 560.0 || t > 700.5) continue;
                course[run][0].push_back(t);
                for (int axis = 0; axis < 3; ++axis) course[run][static_cast<std::size_t>(axis) + 1].push_back(e.position[axis]);
                if (t >= 600.0 && t <= 700.0) largest[run] = std::max(largest[run], e.position.head<2>().cwiseAbs().maxCoeff());
            }
        },
        w.progress);
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) {
        std::vector<double> x;
        for (const std::size_t i : which) x.push_back(largest[i]);
        return std::vector<std::pair<std::string, double>>{{"largest", analysis::quantiles_of(x).median}};
    });
    for (std::size_t axis = 0; axis < 3; ++axis) {
        report::Panel p{fmt::format("position {}", enu[axis]), "time, s", "m"};
        for (std::size_t run = 0; run < std::min<std::size_t>(w.runs, 8); ++run)
            p.series.push_back(paper_curve(run == 0 ? "runs" : "", course[run][0], course[run][axis + 1], report::Ink::Blue));
        p.spans.push_back({600.0, 700.0, "without satellites", true});
        out.panels.push_back(std::move(p));
    }
    return out;
}

PaperResult table_431(const PaperWork& w) {
    constexpr std::array<const char*, 5> blocks{"position", "velocity", "attitude", "gyro bias", "accel bias"};
    constexpr std::array<double, 5> si{1.0, 1.0, 1.0, 1.0, units::ug};
    std::vector<std::array<Vector3d, 5>> squares(w.runs);
    for_each_run(
        w.runs, w.jobs,
        [&](std::size_t run) {
            const ResultBundle b = flown(w.seed + run, {});
            std::array<Vector3d, 5>& sum = squares[run];
            sum.fill(Vector3d::Zero());
            double n = 0.0;
            for (const solution::StateErrors& s : b.evaluation.states) {
                if (s.time < b.evaluation.settled) continue;
                for (std::size_t i = 0; i < 5; ++i) sum[i] += s.error[i].cwiseAbs2();
                n += 1.0;
            }
            for (Vector3d& v : sum) v /= n;
        },
        w.progress);
    PaperResult out;
    report::ResultTable table{"root mean square, all runs",
                              {{"state", "state"}, {"first", "east or x"}, {"second", "north or y"}, {"third", "up or z"}}};
    const auto rms_of = [&](const std::vector<std::size_t>& which) {
        std::array<Vector3d, 5> rms{};
        for (std::size_t i = 0; i < 5; ++i) {
            rms[i].setZero();
            for (const std::size_t run : which) rms[i] += squares[run][i] / static_cast<double>(which.size());
            rms[i] = rms[i].cwiseSqrt() / si[i];
        }
        return rms;
    };
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) {
        const std::array<Vector3d, 5> rms = rms_of(which);
        std::vector<std::pair<std::string, double>> numbers;
        for (std::size_t i = 0; i < 5; ++i)
            for (int axis = 0; axis < 3; ++axis) numbers.emplace_back(fmt::format("{} {}", blocks[i], axis + 1), rms[i][axis]);
        numbers.emplace_back("1 sigma", rms[0].mean());
        numbers.emplace_back("velocity", rms[1].mean());
        return numbers;
    });
    for (std::size_t i = 0; i < 5; ++i) {
        const auto number = [&](std::size_t axis) { return out.numbers[3 * i + axis].second; };
        table.rows.push_back({blocks[i], number(0), number(1), number(2)});
    }
    out.tables.push_back(std::move(table));
    out.notes =
        "From 300 s on. The paper's table is one run of unstated seed and noise; \"at most\" is what can be held against it.\n";
    return out;
}

}  // namespace

std::vector<PaperItem> paper_a_flight() {
    return {{"A", "figure-4.2.1", "the flight in three dimensions", 0, 0.1, figure_421},
            {"A", "figure-4.2.2", "its heading, pitch and roll", 0, 0.1, figure_422},
            {"A", "figure-4.3.1", "errors of position over the flight", 0, 0.4, figure_431},
            {"A", "figure-4.3.2", "errors of velocity", 0, 0.4, figure_432},
            {"A", "figure-4.3.3", "tilts and azimuth over time", 0, 0.4, figure_433},
            {"A", "figure-4.3.4", "errors of the estimated gyro biases", 0, 0.4, figure_434},
            {"A", "figure-4.3.5", "errors of the estimated accelerometer biases", 0, 0.4, figure_435},
            {"A", "figure-4.3.6", "errors of roll, pitch and heading", 0, 0.4, figure_436},
            {"A", "figure-4.3.7", "100 s without satellites", 10, 0.2, figure_437},
            {"A", "table-4.3.1", "root mean squares of the 22-state filter", 20, 0.2, table_431}};
}

}  // namespace schuler::study
