// A campaign as JSON, as CSV and as tables.
#include "schuler/report/inner/json.h"
#include "schuler/report/published.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using analysis::Quantiles;

/// Over all runs and epochs (rms, p95, max), and the runs' own rms as quantiles.
struct PooledError {
    analysis::Spread all;
    Quantiles runs;
};

PooledError pooled(const CampaignStatistics& s, std::size_t field) {
    const FieldStatistics& f = s.fields[field];
    if (f.epochs == 0) return {};
    return {{std::sqrt(f.square.value() / static_cast<double>(f.epochs)), f.size.quantile(0.95), f.largest}, f.runs.quantiles()};
}

struct PooledAid {
    std::string name;
    double nis = 0.0, dof = 0.0, lag1 = 0.0;
    std::size_t accepted = 0, rejected = 0;
    analysis::Bounds bounds{};
};

std::vector<PooledAid> pooled_aids(const CampaignStatistics& s) {
    std::vector<PooledAid> out;
    for (const auto& [name, a] : s.aids) {
        const auto n = static_cast<double>(a.accepted);
        PooledAid& p = out.emplace_back(
            PooledAid{name, a.nis.value() / n, a.dof.value() / n, a.lag1.value() / n, a.accepted, a.rejected, {}});
        if (a.accepted > 0) p.bounds = analysis::mean_bounds(p.dof, n);
    }
    return out;
}

struct PooledOutage {
    double start_s = 0.0, duration_s = 0.0;
    Quantiles end_horizontal, max_horizontal, end_vertical, max_3d, growth;
    double inside_3sigma = 0.0;
};

std::vector<PooledOutage> pooled_outages(const CampaignStatistics& s) {
    std::vector<PooledOutage> out;
    for (const OutageOfRuns& o : s.outages) {
        const auto& q = o.size;
        out.push_back({o.start_s, o.duration_s, q[0].quantiles(), q[1].quantiles(), q[2].quantiles(), q[3].quantiles(),
                       q[4].quantiles(), static_cast<double>(o.inside) / static_cast<double>(o.runs)});
    }
    return out;
}

/// Numbers of one point of the grid of sweeps.
constexpr std::array point_columns{"runs",          "failed",          "horizontal_rms_m", "up_rms_m",
                                   "three_d_rms_m", "heading_rms_deg", "nees_position",    "outage_end_horizontal_rms_m"};

std::array<double, point_columns.size()> numbers_of(const PointStatistics& p) {
    const auto n = static_cast<double>(p.epochs);
    const auto rms = [&](std::size_t field) { return std::sqrt(p.square[field].value() / n); };
    return {static_cast<double>(p.runs),
            static_cast<double>(p.failed),
            rms(3),
            rms(2),
            rms(4),
            rms(10),
            p.nees.value() / static_cast<double>(p.nees_runs),
            std::sqrt(p.end_square.value() / static_cast<double>(p.ends))};
}

/// The swept keys with their values at a point.
std::vector<std::pair<std::string, const settings::Value*>> at_point(const MonteCarlo& mc, std::uint64_t point) {
    std::vector<std::pair<std::string, const settings::Value*>> out;
    for (auto it = mc.vary.rbegin(); it != mc.vary.rend(); ++it) {
        if (it->kind != settings::Variation::Kind::Sweep) continue;
        out.insert(out.begin(), {it->key, &it->values[point % it->values.size()]});
        point /= it->values.size();
    }
    return out;
}

report::Json sweep_json(const MonteCarlo& mc) {
    report::Json rows = report::Json::array();
    for (const auto& [point, p] : mc.statistics().points) {
        report::Json row;
        for (const auto& [key, value] : at_point(mc, point))
            row[key] = value->is_number() ? report::Json(value->number()) : report::Json(settings::to_toml(*value));
        const auto numbers = numbers_of(p);
        for (std::size_t i = 0; i < numbers.size(); ++i) row[point_columns[i]] = report::json_number(numbers[i]);
        rows.push_back(std::move(row));
    }
    return rows;
}

report::Json of(const Quantiles& q) {
    return {{"rms", report::json_number(q.rms)},
            {"median", report::json_number(q.median)},
            {"q05", report::json_number(q.q05)},
            {"q95", report::json_number(q.q95)}};
}

report::Json of(const analysis::EnsembleConsistency& c) {
    return {{"mean", report::json_number(c.mean)},     {"expected", report::json_number(c.expected)},
            {"low95", report::json_number(c.low95)},   {"high95", report::json_number(c.high95)},
            {"inside", report::json_number(c.inside)}, {"worth", report::json_number(c.worth)}};
}

report::Json consistency_of(const CampaignStatistics& s) {
    report::Json out;
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        out["nees_" + std::string(name.name)] = s.present(b) ? of(s.consistency(b)) : report::Json(nullptr);
    }
    report::Json nis;
    for (const char* name : {"gnss_position", "gnss_velocity", "baro", "pseudorange", "range_rate", "mag"}) nis[name] = nullptr;
    for (const PooledAid& a : pooled_aids(s)) {
        nis[a.name] = {{"mean", report::json_number(a.nis)},
                       {"dof", report::json_number(a.dof)},
                       {"accepted", a.accepted},
                       {"rejected", a.rejected},
                       {"lag1", report::json_number(a.lag1)},
                       {"low95", report::json_number(a.bounds.low95)},
                       {"high95", report::json_number(a.bounds.high95)}};
    }
    out["nis"] = std::move(nis);
    return out;
}

}  // namespace

std::string summary_json(const MonteCarlo& mc) {
    const CampaignStatistics& s = mc.statistics();
    report::Json out;
    out["name"] = mc.name;
    out["command"] = "montecarlo";
    out["scheme"] = s.head.scheme;
    out["mechanization"] = s.head.mechanization;
    out["loop"] = s.head.loop;
    out["smoothed"] = s.head.smoothed;
    out["seed"] = mc.seed + mc.first;
    out["version"] = mc.version;
    out["reference"] = "truth";
    for (std::size_t i = 0; i < error_field_count; ++i) {
        const ErrorField& f = error_fields()[i];
        const PooledError p = pooled(s, i);
        out["errors"][f.group][f.name] = {
            {"rms", report::json_number(p.all.rms)},  {"p95", report::json_number(p.all.p95)},
            {"max", report::json_number(p.all.max)},  {"median", report::json_number(p.runs.median)},
            {"q05", report::json_number(p.runs.q05)}, {"q95", report::json_number(p.runs.q95)}};
    }
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!s.present(b)) continue;
        report::Json& block = out["states"][fmt::format("{}_{}", name.name, name.unit)];
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis)
            block[std::string(name.axis[axis])] = of(s.component(b, axis));
    }
    out["settled_after_s"] = report::json_number(s.head.settled_s);
    out["consistency"] = consistency_of(s);
    out["outages"] = report::Json::array();
    for (const PooledOutage& o : pooled_outages(s)) {
        out["outages"].push_back({{"start_s", o.start_s},
                                  {"duration_s", o.duration_s},
                                  {"end_horizontal_m", report::json_number(o.end_horizontal.rms)},
                                  {"max_horizontal_m", report::json_number(o.max_horizontal.rms)},
                                  {"end_vertical_m", report::json_number(o.end_vertical.rms)},
                                  {"max_3d_m", report::json_number(o.max_3d.rms)},
                                  {"inside_3sigma", report::json_number(o.inside_3sigma)},
                                  {"end_horizontal", of(o.end_horizontal)},
                                  {"growth_horizontal", of(o.growth)}});
    }
    // clang-format off
    out["montecarlo"] = {{"runs", mc.runs}, {"failed", s.failed}, {"runs_per_s", report::json_number(static_cast<double>(mc.run_here) / mc.wall_s)},
                         {"quantiles", s.fields[0].runs.sketch.exact() ? "exact" : "histogram"}};
    // clang-format on
    report::Json& failures = out["montecarlo"]["failures"] = report::Json::array();
    for (const auto& [run, failure] : s.failures)
        failures.push_back({{"run", run}, {"seed", failure.seed}, {"reason", failure.reason}});
    if (s.swept) out["montecarlo"]["sweep"] = sweep_json(mc);
    out["timing"] = {{"wall_s", mc.wall_s}};
    report::Json& ignored = out["ignored"] = report::Json::array();
    for (const solution::Ignored& i : mc.ignored) ignored.push_back({{"key", i.key}, {"reason", i.reason}});
    out["warnings"] = report::Json::array();
    return report::text_of(out);
}

namespace {

std::string summary_cell(double x) {
    if (!std::isfinite(x)) return "-";
    const double a = std::abs(x);
    if (a != 0.0 && (a < 1e-3 || a >= 1e5)) return fmt::format("{:.2e}", x);
    return fmt::format("{:.{}f}", x, a < 1.0 ? 4 : a < 100.0 ? 3 : 1);
}

std::string readable(std::string_view unit) { return unit == "m_s" ? "m/s" : unit == "deg_h" ? "deg/h" : std::string(unit); }

std::string block_table(const CampaignStatistics& s) {
    std::string out = fmt::format("{:<28}{:>11}{:>11}{:>11}{:>11}\n", "states", "rms", "5 %", "median", "95 %");
    for (std::size_t b = 2; b < solution::state_blocks; ++b) {  // position and velocity stand above
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!s.present(b)) continue;
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis) {
            const Quantiles q = s.component(b, axis);
            std::string title = fmt::format("{} {}, {}", name.name, name.axis[axis], readable(name.unit));
            std::ranges::replace(title, '_', ' ');
            out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}\n", title, summary_cell(q.rms), summary_cell(q.q05),
                               summary_cell(q.median), summary_cell(q.q95));
        }
    }
    return out;
}

std::string consistency_table(const CampaignStatistics& s) {
    std::string out =
        fmt::format("{:<24}{:>11}{:>11}   {:<22}{}\n", "consistency", "mean", "expected", "95 % bounds", "epochs inside theirs");
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!s.present(b)) continue;
        const analysis::EnsembleConsistency c = s.consistency(b);
        const bool holds = c.mean >= c.low95 && c.mean <= c.high95;
        out += fmt::format("  NEES {:<17}{:>11}{:>11}   {:<22}{:.0f} %{}\n", name.name, summary_cell(c.mean),
                           summary_cell(c.expected), fmt::format("({} to {})", summary_cell(c.low95), summary_cell(c.high95)),
                           100.0 * c.inside, holds ? "" : "   OUTSIDE");
    }
    for (const PooledAid& a : pooled_aids(s)) {
        const bool holds = a.nis >= a.bounds.low95 && a.nis <= a.bounds.high95;
        out += fmt::format("  NIS  {:<17}{:>11}{:>11}   {:<22}{} rejected of {}, lag 1 {}{}\n", a.name, summary_cell(a.nis),
                           summary_cell(a.dof),
                           fmt::format("({} to {})", summary_cell(a.bounds.low95), summary_cell(a.bounds.high95)), a.rejected,
                           a.accepted + a.rejected, summary_cell(a.lag1), holds ? "" : "   OUTSIDE");
    }
    return out;
}

std::string sweep_table(const MonteCarlo& mc) {
    constexpr std::size_t shown = 100;
    std::string out = fmt::format("{:<50}{:>7}{:>8}{:>14}{:>11}{:>14}{:>11}\n", "sweep", "runs", "failed", "horizontal, m",
                                  "up, m", "heading, deg", "outage, m");
    std::size_t lines = 0;
    for (const auto& [point, p] : mc.statistics().points) {
        if (lines++ == shown) return out + fmt::format("  ... {} points in all: sweep.csv\n", mc.statistics().points.size());
        std::string title;
        for (const auto& [key, value] : at_point(mc, point))
            title += (title.empty() ? "" : ", ") + key + " = " + settings::to_toml(*value);
        const auto n = numbers_of(p);
        out += fmt::format("  {:<48}{:>7}{:>8}{:>14}{:>11}{:>14}{:>11}\n", title, p.runs, p.failed, summary_cell(n[2]),
                           summary_cell(n[3]), summary_cell(n[5]), summary_cell(n[7]));
    }
    return out;
}

}  // namespace

std::string sweep_csv(const MonteCarlo& mc) {
    std::string out;
    for (const auto& [key, value] : at_point(mc, 0)) out += key + ",";
    for (const char* column : point_columns) out += fmt::format("{}{}", column, column == point_columns.back() ? "\n" : ",");
    for (const auto& [point, p] : mc.statistics().points) {
        for (const auto& [key, value] : at_point(mc, point)) out += csv_value(*value) + ",";
        const auto numbers = numbers_of(p);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            out += (std::isfinite(numbers[i]) ? fmt::format("{:.9g}", numbers[i]) : "") + (i + 1 == numbers.size() ? "\n" : ",");
    }
    return out;
}

std::string summary_tables(const MonteCarlo& mc) {
    const CampaignStatistics& s = mc.statistics();
    const std::uint64_t seed = mc.seed + mc.first;
    std::string out =
        fmt::format("{}: {} runs, seeds {} to {}, {} failed\n\n", mc.name, mc.runs, seed, seed + mc.runs - 1, s.failed);
    out += fmt::format("{:<28}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", fmt::format("errors from {:.1f} s", s.head.settled_s),
                       "rms", "95 %", "max", "runs: 5 %", "median", "95 %");
    for (std::size_t i = 0; i < error_field_count; ++i) {
        const ErrorField& f = error_fields()[i];
        const PooledError p = pooled(s, i);
        if (!std::isfinite(p.all.rms)) continue;
        out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", f.title, summary_cell(p.all.rms),
                           summary_cell(p.all.p95), summary_cell(p.all.max), summary_cell(p.runs.q05),
                           summary_cell(p.runs.median), summary_cell(p.runs.q95));
    }
    out += block_table(s);
    const std::vector<PooledOutage> outages = pooled_outages(s);
    if (!outages.empty())
        out += fmt::format("\n{:<28}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "outages, horizontal, m", "end median", "95 %",
                           "growth 50 %", "95 %", "3 sigma");
    for (const PooledOutage& o : outages) {
        out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}{:>9.0f} %\n",
                           fmt::format("{:.10g} s for {:.6g} s", o.start_s, o.duration_s), summary_cell(o.end_horizontal.median),
                           summary_cell(o.end_horizontal.q95), summary_cell(o.growth.median), summary_cell(o.growth.q95),
                           100.0 * o.inside_3sigma);
    }
    out += "\n" + consistency_table(s);
    if (s.swept) out += "\n" + sweep_table(mc);
    if (!mc.published.source.empty()) {
        settings::BlockRms rms;
        for (std::size_t b = 0; b < settings::published_blocks; ++b)
            for (std::size_t axis = 0; axis < 3; ++axis)
                rms[b][static_cast<Eigen::Index>(axis)] = s.component(b, axis).rms * solution::state_block_names()[b].si;
        out +=
            "\n" + report::published_table(mc.published, rms, fmt::format("{} runs, from {:.0f} s", mc.runs, s.head.settled_s));
    }
    out += fmt::format("\n{:.1f} s, {:.2f} runs/s\n", mc.wall_s, static_cast<double>(mc.run_here) / mc.wall_s);
    return out;
}

}  // namespace schuler::study
