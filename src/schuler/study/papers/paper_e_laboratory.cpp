// Paper E, figures 6 and 7: steps of gravity at rest.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/gravimetry/classical.h"
#include "schuler/report/result_table.h"
#include "schuler/study/gravity/gravity.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace schuler::study {
namespace {

using gravimetry::SurveyEpoch;
using settings::SettingList;
using settings::ValueList;

GravityBundle laboratory_survey(std::uint64_t seed, const SettingList& over) {
    WarningLog unheard;
    return gravity_of_scenario(paper_scenario("gravity-step.toml", seed, over), {}, unheard);
}
settings::Value three(double x) { return {ValueList{{x}, {x}, {x}}}; }

/// 1 m fixes with a constant error of 1 m instead of 5 cm.
SettingList differential() { return {{"gnss.white_m", three(1.0), {}}, {"gnss.correlated_m", three(1.0), {}}}; }

struct Levels {
    double before = 0, after = 0;  ///< vertical, up, mGal: mean of the smoothed estimate over the last 1000 s of a level
    double error_before = 0, error_after = 0, step = 0, sigma_step = 0, horizontal = 0;
    std::vector<double> t, truth, estimate;  ///< mGal
};

Levels levels_of(const GravityBundle& b) {
    Levels l;
    std::vector<double> up;
    for (std::size_t i = 0; i < b.survey.forward.size(); ++i) {
        l.t.push_back(b.run.relative(b.survey.forward[i].time));
        l.truth.push_back(-b.truth[i].z() / units::mgal);
        up.push_back(-b.survey.forward[i].disturbance_n.z() / units::mgal);
    }
    l.estimate = gravimetry::low_passed(l.t, up, 400.0);
    double n1 = 0, n2 = 0, true1 = 0, true2 = 0;
    for (std::size_t i = 0; i < l.t.size(); ++i) {
        if (l.t[i] > 4300.0 && l.t[i] < 5300.0) {
            l.before += l.estimate[i];
            true1 += l.truth[i];
            ++n1;
        }
        if (l.t[i] > l.t.back() - 1000.0) {
            l.after += l.estimate[i];
            true2 += l.truth[i];
            ++n2;
        }
    }
    l.before /= n1;
    l.after /= n2;
    l.error_before = std::abs(l.before - true1 / n1);
    l.error_after = std::abs(l.after - true2 / n2);
    l.step = l.after - l.before;
    l.horizontal = b.errors.last.head<2>().norm() / std::sqrt(2.0) / units::mgal;
    return l;
}

PaperResult figure_6(const PaperWork& w) {
    std::vector<Levels> all(2 * w.runs);
    for_each_run(
        all.size(), w.jobs,
        [&](std::size_t job) {
            all[job] = levels_of(laboratory_survey(w.seed + job / 2, job % 2 == 0 ? SettingList{} : differential()));
        },
        w.progress);
    std::vector<std::size_t> every(w.runs);
    std::iota(every.begin(), every.end(), std::size_t{0});
    const auto median_of = [&](const std::vector<std::size_t>& which, std::size_t mode, double Levels::*field) {
        std::vector<double> x;
        for (const std::size_t run : which) x.push_back(all[2 * run + mode].*field);
        return analysis::quantiles_of(x).median;
    };
    const auto median = [&](std::size_t mode, double Levels::*field) { return median_of(every, mode, field); };
    PaperResult out;
    set_numbers(out, w.runs, [&](const std::vector<std::size_t>& which) {
        const auto larger = [&](std::size_t mode) {
            return std::max(median_of(which, mode, &Levels::error_before), median_of(which, mode, &Levels::error_after));
        };
        return std::vector<std::pair<std::string, double>>{{"phase", larger(0)},
                                                           {"differential", larger(1)},
                                                           {"step", median_of(which, 0, &Levels::step)},
                                                           {"horizontal", median_of(which, 0, &Levels::horizontal)}};
    });
    report::ResultTable table{"median of the runs",
                              {{"mode", "mode"},
                               {"error_before", "error before", "mGal"},
                               {"error_after", "error after", "mGal"},
                               {"step", "step", "mGal"}}};
    for (std::size_t mode = 0; mode < 2; ++mode) {
        const char* name = mode == 0 ? "phase" : "differential";
        table.rows.push_back(
            {name, median(mode, &Levels::error_before), median(mode, &Levels::error_after), median(mode, &Levels::step)});
        report::Panel p{fmt::format("figure 6 {}: {}", mode == 0 ? "a" : "b", name), "time, s", "mGal"};
        p.series = {paper_curve("anomaly", all[mode].t, all[mode].truth, report::Ink::Muted, report::Mark::Dashed),
                    paper_curve("estimate, smoothed over 400 s", all[mode].t, all[mode].estimate)};
        p.y_limits = std::pair{8.5, 11.0};
        out.panels.push_back(std::move(p));
    }
    out.tables.push_back(std::move(table));
    out.notes = "The filter is given the times at which the level may have changed, not the change (gravity.steps_s).\n";
    return out;
}

/// The laboratory's noise and receivers, for one interval: `up` and `horizontal` in mGal.
GravityBundle interval_of(double up, double horizontal, bool phase, std::uint64_t seed) {
    constexpr double of_a_sample = 1.0 / std::numbers::sqrt2;  // to a density, at 2 Hz
    const settings::ValueTable part{{"kind", {std::string("constant")}},
                                    {"size_mgal", {ValueList{{horizontal}, {horizontal}, {up}}}}};
    const double position = phase ? 0.05 : 0.5, velocity = 0.1;
    return laboratory_survey(seed, {{"duration_s", {5500.0}, {}},
                                    {"anomaly", {ValueList{settings::Value{part}}}, {}},
                                    {"imu.accel_noise_m_s_sqrt_h", {1e-4 * of_a_sample * 60.0}, {}},
                                    {"imu.gyro_noise_deg_sqrt_h", {0.1 * of_a_sample / 60.0}, {}},
                                    {"imu.gyro_turn_on_bias_deg_h", {0.1}, {}},
                                    {"gnss.white_m", three(position), {}},
                                    {"gnss.correlated_m", three(position), {}},
                                    {"gnss.white_velocity_m_s", three(velocity), {}},
                                    {"gnss.correlated_velocity_m_s", three(velocity), {}},
                                    {"gravity.prior_mgal", three(50.0), {}},
                                    {"gravity.steps_s", {ValueList{}}, {}}});
}

/// The filter restarted for each interval, as in the paper.
PaperResult figure_7(const PaperWork& w) {
    constexpr std::array<const char*, 2> modes{"phase", "differential"};
    constexpr std::array<double, 2> vertical{10.0, 9.5}, horizontal{0.0, 50.0};  // mGal, of the intervals
    constexpr std::array<const char*, 3> axes{"north", "east", "vertical"};
    struct One {
        std::array<double, 2> up{}, up_error{}, horizontal_error{};  ///< of the intervals, mGal
        double step_error = 0, tilt = 0, velocity = 0, velocity_up = 0;
        std::array<std::vector<double>, 2> t{};                 ///< of the intervals; of the first run of each mode
        std::array<std::array<std::vector<double>, 2>, 3> x{};  ///< north, east, up
    };
    std::vector<One> all(modes.size() * w.runs);
    for_each_run(
        all.size(), w.jobs,
        [&](std::size_t job) {
            One& one = all[job];
            const std::size_t mode = job % modes.size(), run = job / modes.size();
            for (std::size_t k = 0; k < 2; ++k) {
                constexpr std::uint64_t other = 1000;  // noise of its own in each interval
                const GravityBundle b = interval_of(vertical[k], horizontal[k], mode == 0, w.seed + run + k * other);
                one.up[k] = -b.survey.forward.back().disturbance_n.z() / units::mgal;
                one.up_error[k] = std::abs(b.errors.last.z()) / units::mgal;
                one.horizontal_error[k] = b.errors.last.head<2>().norm() / std::sqrt(2.0) / units::mgal;
                const analysis::ErrorRow& last = b.run.evaluation.errors.back();
                one.tilt = std::max(one.tilt, last.rpy.head<2>().norm() / std::sqrt(2.0) / units::arcsec);
                one.velocity = std::max(one.velocity, last.velocity.head<2>().norm() / std::sqrt(2.0));
                one.velocity_up = std::max(one.velocity_up, std::abs(last.velocity.z()));
                if (run != 0) continue;
                for (const SurveyEpoch& e : b.survey.forward) {
                    one.t[k].push_back(b.run.relative(e.time) + 5500.0 * static_cast<double>(k));
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        const double down = e.disturbance_n(static_cast<Eigen::Index>(axis)) / units::mgal;
                        one.x[axis][k].push_back(axis == 2 ? -down : down);
                    }
                }
            }
            one.step_error = std::abs(one.up[1] - one.up[0] + 0.5);
        },
        w.progress);
    const auto numbers = [&](const std::vector<std::size_t>& which) {
        std::vector<std::pair<std::string, double>> out;
        for (std::size_t mode = 0; mode < modes.size(); ++mode) {
            const auto add = [&](const char* key, const auto& number) {
                std::vector<double> x;
                for (const std::size_t run : which) x.push_back(number(all[run * modes.size() + mode]));
                out.emplace_back(fmt::format("{} {}", modes[mode], key), analysis::quantiles_of(x).median);
            };
            add("first", [](const One& o) { return o.up[0]; });
            add("second", [](const One& o) { return o.up[1]; });
            add("vertical error", [](const One& o) { return std::max(o.up_error[0], o.up_error[1]); });
            add("step error", [](const One& o) { return o.step_error; });
            add("horizontal", [](const One& o) { return std::max(o.horizontal_error[0], o.horizontal_error[1]); });
            add("tilt", [](const One& o) { return o.tilt; });
            add("velocity", [](const One& o) { return o.velocity; });
            add("velocity up", [](const One& o) { return o.velocity_up; });
        }
        return out;
    };
    PaperResult out;
    set_numbers(out, w.runs, numbers);
    // in the order of the figure: vertical of both modes, then the horizontal ones
    for (const bool of_vertical : {true, false})
        for (std::size_t mode = 0; mode < modes.size(); ++mode)
            for (std::size_t axis = of_vertical ? 2 : 0; axis < (of_vertical ? 3U : 2U); ++axis) {
                const One& one = all[mode];
                report::Panel p{
                    fmt::format("figure 7 {}: {}, {}", of_vertical ? (mode == 0 ? "a" : "b") : (mode == 0 ? "c" : "d"),
                                axes[axis], modes[mode]),
                    "time, s", "mGal"};
                std::vector<double> t, x, truth;
                for (std::size_t k = 0; k < 2; ++k) {
                    t.insert(t.end(), one.t[k].begin(), one.t[k].end());
                    x.insert(x.end(), one.x[axis][k].begin(), one.x[axis][k].end());
                    truth.resize(t.size(), of_vertical ? vertical[k] : horizontal[k]);
                }
                p.series = {paper_curve("anomaly", t, truth, report::Ink::Muted, report::Mark::Dashed),
                            paper_curve("estimate, begun anew at 5500 s", t, x)};
                p.y_limits = of_vertical ? std::pair{5.0, 15.0} : std::pair{-50.0, 100.0};
                out.panels.push_back(std::move(p));
            }
    out.notes =
        "Simulated laboratory noise (0.1 deg/h, 1e-4 m/s2 a sample at 2 Hz), drawn anew for each interval. Tilt and horizontal anomaly are seen together:\n"
        "the horizontal error is the starting tilt of 1e-5 rad, 10 mGal, in either mode. examples/half-real injects the step into the columns of a log.\n";
    return out;
}

}  // namespace

std::vector<PaperItem> paper_e_laboratory() {
    return {{"E", "figure-6", "a step of the vertical anomaly: phase and differential", 12, 1.0, figure_6},
            {"E", "figure-7", "the half-real laboratory: filter restarted for each level", 12, 1.2, figure_7}};
}

}  // namespace schuler::study
