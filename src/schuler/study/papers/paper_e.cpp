// Paper E: the integrated gravimetric system, simulated.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/observability.h"
#include "schuler/gravimetry/response.h"
#include "schuler/report/result_table.h"
#include "schuler/study/gravity/gravity.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using gravimetry::SurveyEpoch;

GravityBundle surveyed(std::string_view file, std::uint64_t seed, const settings::SettingList& over = {}) {
    WarningLog unheard;
    return gravity_of_scenario(paper_scenario(file, seed, over), {}, unheard);
}

/// Error and sigma of the filter's vertical disturbance over time, mGal, up.
struct Course {
    std::vector<double> t, error, sigma;
};
Course course_of(const GravityBundle& b, const std::vector<SurveyEpoch>& epochs) {
    Course c;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        c.t.push_back(b.run.relative(epochs[i].time));
        c.error.push_back(-(epochs[i].disturbance_n.z() - b.truth[i].z()) / units::mgal);
        c.sigma.push_back(epochs[i].sigma_disturbance_n.z() / units::mgal);
    }
    return c;
}
report::Panel error_panel(const std::string& title, const Course& c) {
    report::Panel p{title, "time, s", "mGal"};
    report::Band band{"one sigma", c.t, {}, c.sigma};
    for (const double s : c.sigma) band.lo.push_back(-s);
    p.bands.push_back(std::move(band));
    p.series = {paper_curve("error of the vertical disturbance, filter", c.t, c.error)};
    const double last = c.sigma.back();
    p.y_limits = std::pair{-10.0 * last, 10.0 * last};
    return p;
}

PaperResult observability(const PaperWork&) {
    PaperResult out;
    const auto rank = [](double v, double tolerance) {
        gravimetry::ObservedMotion m;
        m.v_eb_n = {v, v, 0.0};
        return static_cast<double>(gravimetry::observability({}, m, tolerance).rank);
    };
    out.numbers = {{"at rest", rank(0.0, 0.0)}, {"moving", rank(1.0, 1e-7)}};
    out.notes = fmt::format(
        "Exact rank in motion, all pivots counted: {:.0f}. `schuler analyze observability --paper` lists the combinations.\n",
        rank(1.0, 0.0));
    return out;
}

PaperResult figure_3(const PaperWork& w) {
    struct One {
        double end = 0, tilt = 0, velocity = 0, up = 0, five = 0;
        double gyro_north = 0, gyro_east = 0, gyro_vertical = 0;  ///< deg/h
        Course course;
    };
    constexpr std::array<const char*, 3> files{"gravity-car-5400s.toml", "gravity-car-differential.toml",
                                               "gravity-car-5400s.toml"};
    constexpr std::size_t modes = files.size();
    const settings::SettingList own_start{{"filter.initial_error.heading_deg", {1e-4 / units::deg}, {}}};
    std::vector<One> all(modes * w.runs);
    for_each_run(
        all.size(), w.jobs,
        [&](std::size_t job) {
            const std::size_t mode = job % modes;
            const GravityBundle b = surveyed(files[mode], w.seed + job / modes, mode == 2 ? own_start : settings::SettingList{});
            One& one = all[job];
            one.end = std::abs(b.errors.last.z()) / units::mgal;
            const analysis::ErrorRow& last = b.run.evaluation.errors.back();
            one.tilt = last.rpy.head<2>().norm() / std::sqrt(2.0) / units::arcsec;
            one.velocity = last.velocity.head<2>().norm();
            one.up = std::abs(last.velocity.z());
            // the car is level: its x axis points along the heading
            const SurveyEpoch& end = b.survey.forward.back();
            const auto& sensors = b.run.truth.sensors;
            const auto after = std::ranges::upper_bound(sensors, end.time, {}, &sim::SensorTruth::time);
            const auto truth = after == sensors.begin() ? after : after - 1;
            const Eigen::Vector3d gyro = (end.gyro_bias - truth->gyro_bias) / units::deg_per_hour;
            const double heading = b.run.result.forward.rows.back().rpy.z();
            one.gyro_north = std::abs(std::cos(heading) * gyro.x() - std::sin(heading) * gyro.y());
            one.gyro_east = std::abs(std::sin(heading) * gyro.x() + std::cos(heading) * gyro.y());
            one.gyro_vertical = std::abs(gyro.z());
            for (const SurveyEpoch& e : b.survey.forward)
                if (b.run.relative(e.time) <= 300.0) one.five = e.sigma_disturbance_n.z();
            if (job < modes) one.course = course_of(b, b.survey.forward);
        },
        w.progress);
    PaperResult out;
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) {
        const auto median = [&](std::size_t mode, double One::*field) {
            std::vector<double> x;
            for (const std::size_t run : which) x.push_back(all[modes * run + mode].*field);
            return analysis::quantiles_of(x).median;
        };
        const auto larger = [&](double One::*field) { return std::max(median(0, field), median(1, field)); };
        return std::vector<std::pair<std::string, double>>{{"phase", median(0, &One::end)},
                                                           {"differential", median(1, &One::end)},
                                                           {"tilt", median(0, &One::tilt)},
                                                           {"velocity", larger(&One::velocity)},
                                                           {"velocity up", larger(&One::up)},
                                                           {"gyro north", median(0, &One::gyro_north)},
                                                           {"gyro east", median(0, &One::gyro_east)},
                                                           {"gyro east own start", median(2, &One::gyro_east)},
                                                           {"gyro vertical", larger(&One::gyro_vertical)},
                                                           {"5 min phase", median(0, &One::five)},
                                                           {"5 min differential", median(1, &One::five)}};
    });
    out.panels = {error_panel("figure 3 a: differential", all[1].course), error_panel("figure 3 b: phase", all[0].course)};
    return out;
}

/// Accelerometer noise of 5e-5 m/s^2 with a correlation time, and white noise of 1e-4 m/s^2 per sample.
PaperResult coloured(const PaperWork& w) {
    struct Kind {
        const char* key;
        settings::SettingList over;
    };
    const double mg = 5e-5 / units::mg;
    // clang-format off
    const std::array<Kind, 4> kinds{{{"mu 0.01", {{"imu.accel_bias_mg", {mg}, {}}, {"imu.accel_bias_time_s", {100.0}, {}}}},
                                     {"mu 0.1", {{"imu.accel_bias_mg", {mg}, {}}, {"imu.accel_bias_time_s", {10.0}, {}}}},
                                     {"mu 1", {{"imu.accel_bias_mg", {mg}, {}}, {"imu.accel_bias_time_s", {1.0}, {}}}},
                                     {"white", {{"imu.accel_noise_m_s_sqrt_h", {1e-4 / std::sqrt(2.0) * 60.0}, {}}}}}};
    // clang-format on
    struct One {
        double error = 0, sigma = 0, nis = 0;
        bool usable = false;
        Course course;
    };
    std::vector<One> all(kinds.size() * w.runs);
    for_each_run(
        all.size(), w.jobs,
        [&](std::size_t job) {
            const GravityBundle b =
                surveyed("gravity-car-5400s.toml", w.seed + job / kinds.size(), kinds[job % kinds.size()].over);
            One& one = all[job];
            one.error = b.errors.last.z();
            one.sigma = b.attainable.vertical;
            one.nis = b.innovations.nis;
            one.usable = b.attainable.usable;
            if (job < kinds.size()) one.course = course_of(b, b.survey.forward);
        },
        w.progress);
    PaperResult out;
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) {
        std::vector<std::pair<std::string, double>> numbers;
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            std::vector<double> errors;
            for (const std::size_t run : which) errors.push_back(all[run * kinds.size() + k].error);
            numbers.emplace_back(kinds[k].key, paper_rms(errors));
        }
        return numbers;
    });
    report::ResultTable table{"vertical anomaly",
                              {{"noise", "noise"},
                               {"error", "error, rms", "m/s2"},
                               {"sigma", "sigma", "m/s2"},
                               {"nees", "NEES/1"},
                               {"nis", "NIS"},
                               {"usable", "usable, share"}}};
    for (std::size_t k = 0; k < kinds.size(); ++k) {
        std::vector<double> errors;
        double sigma = 0.0, nees = 0.0, nis = 0.0, usable = 0.0;
        const auto runs = static_cast<double>(w.runs);
        for (std::size_t job = k; job < all.size(); job += kinds.size()) {
            errors.push_back(all[job].error);
            sigma += all[job].sigma / runs;
            nees += std::pow(all[job].error / all[job].sigma, 2.0) / runs;
            nis += all[job].nis / runs;
            usable += all[job].usable ? 1.0 / runs : 0.0;
        }
        table.rows.push_back({kinds[k].key, paper_rms(errors), sigma, nees, nis, usable});
        out.panels.push_back(error_panel(fmt::format("accelerometer noise: {}", kinds[k].key), all[k].course));
    }
    out.tables.push_back(std::move(table));
    return out;
}

// --- figures 4 and 5: a variable anomaly ---

GravityResponse response(const char* speed_of, std::uint64_t seed) {
    settings::SettingList over;
    if (std::string_view(speed_of) == "1 m/s") {
        // the same field as a function of time: lengths divided by ten
        const auto part = [](const char* kind, double e, double n, double u, double length) {
            settings::ValueTable t{{"kind", {std::string(kind)}}, {"size_mgal", {settings::ValueList{{e}, {n}, {u}}}}};
            if (length > 0.0) t.emplace_back("length_m", settings::Value{length});
            return settings::Value{std::move(t)};
        };
        // clang-format off
        over = {{"trajectory.speed_m_s", {1.0}, {}}, {"gravity.length_m", {300.0}, {}},
                {"anomaly", {settings::ValueList{part("constant", 5, 5, 10, 0), part("harmonic", 0, 0, 5, 600), part("ramp", 0, 0, 5, 5400)}}, {}}};
        // clang-format on
    }
    return gravity_response_of(paper_scenario("gravity-variable.toml", seed, over), {});
}

PaperResult figure_4(const PaperWork& w) {
    const GravityResponse r = response("10 m/s", w.seed);
    report::Panel gain{"amplitude", "frequency, Hz", "out / in"}, phase{"phase", "frequency, Hz", "lag, deg"};
    gain.time_axis = phase.time_axis = false;
    report::ResultTable table{"",
                              {{"period_s", "period", "s", ".4g", ".6g"},
                               {"frequency_hz", "frequency", "Hz"},
                               {"filter", "filter"},
                               {"filter_lag_deg", "its lag", "deg"},
                               {"smoother", "smoother"},
                               {"smoother_lag_deg", "its lag", "deg"}}};
    std::vector<double> f, gf, pf, gs, ps;
    // A lag beyond half a period follows on from that of the longer periods.
    const auto on_from = [](const std::vector<double>& before, double lag) {
        return before.empty() ? lag : before.back() + std::remainder(lag - before.back(), 360.0);
    };
    for (const GravityResponse::At& m : r.at) {
        f.push_back(1.0 / m.period);
        gf.push_back(m.forward.gain);
        gs.push_back(m.smoothed.gain);
        pf.push_back(on_from(pf, m.forward.lag / units::deg));
        ps.push_back(on_from(ps, m.smoothed.lag / units::deg));
        table.rows.push_back({m.period, f.back(), gf.back(), pf.back(), gs.back(), ps.back()});
    }
    gain.series = {paper_curve("filter", f, gf, report::Ink::Vermillion), paper_curve("smoother", f, gs)};
    phase.series = {paper_curve("filter", f, pf, report::Ink::Vermillion), paper_curve("smoother", f, ps)};
    PaperResult out;
    out.tables.push_back(std::move(table));
    out.panels = {std::move(gain), std::move(phase)};
    out.notes = "The filter lags and damps as the paper found; the smoother has no lag.\n";
    return out;
}

PaperResult figure_5(const PaperWork& w) {
    PaperResult out;
    report::ResultTable table{
        "error less its mean",
        {{"speed", "speed"}, {"filter", "filter", "mGal"}, {"corrected", "corrected", "mGal"}, {"smoother", "smoother", "mGal"}}};
    for (const char* speed : {"1 m/s", "10 m/s"}) {
        const GravityResponse r = response(speed, w.seed);
        out.numbers.emplace_back(speed, r.corrected.corrected);
        table.rows.push_back({speed, r.corrected.forward, r.corrected.corrected, r.corrected.smoothed});
        report::Panel p{fmt::format("error of the vertical anomaly at {}", speed), "time, s", "mGal"};
        p.series = {
            paper_curve("filter", r.corrected.t, r.corrected.e_forward, report::Ink::Muted),
            paper_curve("corrected in amplitude and phase", r.corrected.t, r.corrected.e_corrected, report::Ink::Vermillion),
            paper_curve("smoother", r.corrected.t, r.corrected.e_smoothed)};
        out.panels.push_back(std::move(p));
        if (w.progress) w.progress(0.5 * static_cast<double>(out.panels.size()));
    }
    out.tables.push_back(std::move(table));
    return out;
}

}  // namespace

std::vector<PaperItem> paper_e_items() {
    return {{"E", "observability", "ranks at rest and in motion", 0, 2.0, observability},
            {"E", "figure-3", "errors at the end: phase and differential", 20, 0.75, figure_3},
            {"E", "coloured-noise", "coloured and strong white accelerometer noise", 12, 0.6, coloured},
            {"E", "figure-4", "amplitude and phase of the estimator", 0, 8.0, figure_4},
            {"E", "figure-5", "a variable anomaly corrected in amplitude and phase, 1 and 10 m/s", 0, 16.0, figure_5}};
}

}  // namespace schuler::study
