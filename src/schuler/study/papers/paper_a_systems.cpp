// Paper A, tables 1.1.1 and 1.4.2: couplings, inertial unit.
#include "schuler/analysis/ensemble.h"
#include "schuler/core/units.h"
#include "schuler/filter/states/model.h"
#include "schuler/report/result_table.h"
#include "schuler/sensor/grades.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/comparison/compare.h"
#include "schuler/study/comparison/compare_campaign.h"
#include "schuler/study/papers/item.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace schuler::study {
namespace {

// --- table 1.1.1 ---

constexpr std::array schemes{"separate", "loose-15", "tight", "intermediate", "deep"};
enum Coupling : std::size_t { separate, loose, tight, intermediate, deep };
enum Window : std::size_t { lost, jammed };  ///< of examples/paper-a-couplings.toml

/// Root mean square of a number over the runs of a scheme.
double over_runs(const SchemeCampaign& scheme, std::string_view key) {
    const std::vector<report::TableColumn>& columns = compared_columns();
    const auto i = std::ranges::find(columns, key, &report::TableColumn::key) - columns.begin();
    std::vector<double> values;
    for (const std::vector<double>& numbers : scheme.numbers)
        if (!numbers.empty()) values.push_back(numbers[static_cast<std::size_t>(i)]);
    return paper_rms(values);
}
/// Median of a number of a window over the runs; a run that does not have it is the worst.
double in_window(const SchemeCampaign& scheme, Window window, double WindowStatistics::*number) {
    std::vector<double> values;
    for (const std::vector<WindowStatistics>& run : scheme.windows) {
        const double x = run.empty() ? not_given : run[window].*number;
        values.push_back(std::isfinite(x) ? x : std::numeric_limits<double>::infinity());
    }
    std::ranges::sort(values);
    return values[values.size() / 2];
}

PaperResult table_111(const PaperWork& w) {
    const CompareCampaign campaign =
        compare_campaign(paper_settings("paper-a-couplings.toml", w.seed), {}, w.runs, w.jobs, w.progress);
    const auto of = [&](Coupling c) -> const SchemeCampaign& { return campaign.schemes[c]; };
    PaperResult out;
    report::ResultTable table{"one flight through five couplings, from 60 s on, both windows included",
                              {{"coupling", "coupling"},
                               {"horizontal_m", "horizontal", "m"},
                               {"up_m", "up", "m"},
                               {"velocity_m_s", "velocity", "m/s"},
                               {"heading_deg", "heading", "deg"}}};
    report::ResultTable windows{"in the windows, median of the runs",
                                {{"coupling", "coupling"},
                                 {"lost_m", "signals lost: largest", "m"},
                                 {"back_s", "satellites back after", "s"},
                                 {"jammed_m", "jamming: largest", "m"},
                                 {"held_db_hz", "held to", "dB-Hz"},
                                 {"jammed_back_s", "back after", "s"}}};
    for (const SchemeCampaign& s : campaign.schemes) {
        std::vector<report::Cell>& row = table.rows.emplace_back();
        row.emplace_back(std::string(s.scheme->title));
        for (const char* key : {"horizontal_m", "up_m", "velocity_m_s", "heading_deg"}) row.emplace_back(over_runs(s, key));
        windows.rows.push_back({std::string(s.scheme->title), in_window(s, lost, &WindowStatistics::horizontal_max),
                                in_window(s, lost, &WindowStatistics::back),
                                in_window(s, jammed, &WindowStatistics::horizontal_max),
                                in_window(s, jammed, &WindowStatistics::held), in_window(s, jammed, &WindowStatistics::back)});
    }
    out.tables = {std::move(table), std::move(windows), nees_table(campaign)};
    WarningLog unheard;
    const solution::ResultBundle deep_filter = solution::simulated_bundle(paper_scenario("paper-a-couplings.toml", w.seed),
                                                                          settings::known_scheme("deep").settings, unheard);
    const auto ratio = [&](Coupling one, Coupling other, std::string_view key) {
        return over_runs(of(one), key) / over_runs(of(other), key);
    };
    const auto window_ratio = [&](Coupling one, Coupling other, Window window, double WindowStatistics::*number) {
        return in_window(of(one), window, number) / in_window(of(other), window, number);
    };
    const auto largest = &WindowStatistics::horizontal_max;
    const auto back = &WindowStatistics::back;
    const auto held = &WindowStatistics::held;
    double consistent = 0.0, not_above = 0.0, judged = 0.0;
    for (const SchemeCampaign& s : campaign.schemes)
        for (const analysis::EnsembleConsistency& n : s.nees) {
            if (!std::isfinite(n.mean)) continue;
            judged += 1.0;
            consistent += n.in_band() ? 1.0 : 0.0;
            not_above += n.mean <= n.high95 ? 1.0 : 0.0;
        }
    // clang-format off
    out.numbers = {{"loose/separate", ratio(loose, separate, "horizontal_m")},
                   {"tight/separate", ratio(tight, separate, "horizontal_m")},
                   {"tight/loose velocity", ratio(tight, loose, "velocity_m_s")},
                   {"deep/tight velocity", ratio(deep, tight, "velocity_m_s")},
                   {"lost loose/separate", window_ratio(loose, separate, lost, largest)},
                   {"lost tight/loose", window_ratio(tight, loose, lost, largest)},
                   {"back loose/separate", window_ratio(loose, separate, lost, back)},
                   {"back intermediate/separate", window_ratio(intermediate, separate, lost, back)},
                   {"back deep/separate", window_ratio(deep, separate, lost, back)},
                   {"jammed loose/separate", window_ratio(loose, separate, jammed, largest)},
                   {"jammed tight/loose", window_ratio(tight, loose, jammed, largest)},
                   {"jammed intermediate/tight", window_ratio(intermediate, tight, jammed, largest)},
                   {"jammed deep/tight", window_ratio(deep, tight, jammed, largest)},
                   {"held intermediate", in_window(of(intermediate), jammed, held) - in_window(of(loose), jammed, held)},
                   {"held deep", in_window(of(deep), jammed, held) - in_window(of(loose), jammed, held)},
                   {"nees above", not_above / judged}, {"nees", consistent / judged},
                   {"states of deep", static_cast<double>(filter::make_layout(deep_filter.data.config.filter, deep_filter.data.recording).without_slots())}};
    // clang-format on
    for (const std::size_t quantity : {std::size_t{0}, std::size_t{2}}) {
        report::Panel panel{
            quantity == 0 ? "horizontal error, root mean square over the runs" : "velocity error, root mean square over the runs",
            "time, s", quantity == 0 ? "m" : "m/s"};
        panel.log_y = true;
        constexpr std::array inks{report::Ink::Muted, report::Ink::Vermillion, report::Ink::Blue, report::Ink::Sky,
                                  report::Ink::Green};
        for (std::size_t k = 0; k < campaign.schemes.size(); ++k) {
            const SquaredCourse& course = campaign.schemes[k].course;
            std::vector<double> t, y;
            for (std::size_t i = 0; i < SquaredCourse::spans; ++i) {
                if (!(course.count[quantity][i] > 0.0)) continue;
                t.push_back(campaign.duration * (static_cast<double>(i) + 0.5) / static_cast<double>(SquaredCourse::spans));
                y.push_back(std::sqrt(course.square[quantity][i] / course.count[quantity][i]));
            }
            panel.series.push_back(paper_curve(schemes[k], std::move(t), std::move(y), inks[k]));
        }
        for (const settings::CompareWindow& window : campaign.windows)
            panel.spans.push_back({window.start, window.end, window.name, true});
        out.panels.push_back(std::move(panel));
    }
    return out;
}

// --- tables 1.4.2 and 1.4.3 ---

PaperResult table_142(const PaperWork&) {
    const sensor::ImuErrorModel m = sensor::imu_grade("hg9900");
    PaperResult out;
    const double drift = std::hypot(m.gyro_bias, m.gyro_turn_on_bias) / units::deg_per_hour,
                 bias = std::hypot(m.accel_bias, m.accel_turn_on_bias) / units::ug;
    // clang-format off
    out.numbers = {{"gyro drift", drift}, {"gyro walk", m.gyro_noise / units::deg_per_sqrt_hour}, {"gyro scale", m.gyro_scale / units::ppm},
                   {"accel bias", bias}, {"accel scale", m.accel_scale / units::ppm}};
    // clang-format on
    out.notes = fmt::format(
        "Ours: the unit \"hg9900\" of [imu] grade. The random walk of the accelerometers is given in the unit of gyros (0.002 deg/sqrt(h)): a misprint;\n"
        "ours is {:.3g} m/s/sqrt(h).\n",
        m.accel_noise / units::m_s_per_sqrt_hour);
    return out;
}

}  // namespace

std::vector<PaperItem> paper_a_systems() {
    return {{"A", "table-1.1.1", "five couplings on one flight with signals lost and jammed", 12, 3.0, table_111},
            {"A", "table-1.4.2", "the inertial unit HG9900", 0, 0.1, table_142}};
}

}  // namespace schuler::study
