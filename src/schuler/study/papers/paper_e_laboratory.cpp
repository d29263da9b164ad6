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
    const auto median = [&](std::size_t mode, double Levels::*field) {
        std::vector<double> x;
        for (std::size_t job = mode; job < all.size(); job += 2) x.push_back(all[job].*field);
        return analysis::quantiles_of(x).median;
    };
    PaperResult out;
    out.numbers = {{"phase", std::max(median(0, &Levels::error_before), median(0, &Levels::error_after))},
                   {"differential", std::max(median(1, &Levels::error_before), median(1, &Levels::error_after))},
                   {"step", median(0, &Levels::step)},
                   {"horizontal", median(0, &Levels::horizontal)}};
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

/// The filter restarted for each interval, as in the paper, with the laboratory's noise.
PaperResult figure_7(const PaperWork& w) {
    struct One {
        double first = 0, second = 0;
    };
    const double white = 1e-4 / std::sqrt(2.0) * 60.0;
    const auto interval = [&](double up, double horizontal, std::uint64_t seed) {
        const settings::ValueTable part{{"kind", {std::string("constant")}},
                                        {"size_mgal", {ValueList{{horizontal}, {horizontal}, {up}}}}};
        const SettingList over{{"duration_s", {5500.0}, {}},
                               {"anomaly", {ValueList{settings::Value{part}}}, {}},
                               {"imu.accel_noise_m_s_sqrt_h", {white}, {}},
                               {"imu.gyro_noise_deg_sqrt_h", {0.1 / std::sqrt(2.0) / 60.0}, {}},
                               {"imu.gyro_turn_on_bias_deg_h", {0.1}, {}},
                               {"gravity.prior_mgal", three(50.0), {}},
                               {"gravity.steps_s", {ValueList{}}, {}}};
        return laboratory_survey(seed, over);
    };
    std::vector<One> all(w.runs);
    PaperResult out;
    std::array<std::vector<double>, 2> t, x;
    for_each_run(
        w.runs, w.jobs,
        [&](std::size_t run) {
            // noise of its own in each interval
            constexpr std::uint64_t other = 1000;
            const GravityBundle a = interval(10.0, 0.0, w.seed + run), b = interval(9.5, 50.0, w.seed + other + run);
            all[run] = {-a.survey.forward.back().disturbance_n.z() / units::mgal,
                        -b.survey.forward.back().disturbance_n.z() / units::mgal};
            if (run != 0) return;
            for (std::size_t k = 0; k < 2; ++k)
                for (const SurveyEpoch& e : (k == 0 ? a : b).survey.forward) {
                    t[k].push_back((k == 0 ? a : b).run.relative(e.time) + 5500.0 * static_cast<double>(k));
                    x[k].push_back(-e.disturbance_n.z() / units::mgal);
                }
        },
        w.progress);
    std::vector<double> first, second;
    for (const One& one : all) {
        first.push_back(one.first);
        second.push_back(one.second);
    }
    out.numbers = {{"first", analysis::quantiles_of(first).median}, {"second", analysis::quantiles_of(second).median}};
    for (std::size_t k = 0; k < 2; ++k) {
        report::Panel p{k == 0 ? "first interval: 10 mGal" : "second interval: 9.5 mGal", "time, s", "mGal"};
        p.series = {paper_curve("estimate", t[k], x[k])};
        const double right = k == 0 ? 10.0 : 9.5;
        p.series.push_back(
            paper_curve("anomaly", {t[k].front(), t[k].back()}, {right, right}, report::Ink::Muted, report::Mark::Dashed));
        p.y_limits = std::pair{5.0, 15.0};
        out.panels.push_back(std::move(p));
    }
    out.notes =
        "Simulated laboratory noise (0.1 deg/h, 1e-4 m/s2 a sample at 2 Hz), drawn anew for each interval. examples/half-real injects the step into the columns of a log.\n";
    return out;
}

}  // namespace

std::vector<PaperItem> paper_e_laboratory() {
    return {{"E", "figure-6", "a step of the vertical anomaly: phase and differential", 12, 1.0, figure_6},
            {"E", "figure-7", "the half-real laboratory: filter restarted for each level", 12, 0.6, figure_7}};
}

}  // namespace schuler::study
