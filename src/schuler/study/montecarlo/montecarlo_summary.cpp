// A campaign as JSON, as CSV and as tables.
#include "schuler/report/inner/json.h"
#include "schuler/report/published.h"
#include "schuler/report/result_table.h"
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

/// Over all runs and epochs (rms, p95, max), and the rms of the individual runs as quantiles.
struct PooledError {
    analysis::Spread all;
    Quantiles runs;
};

PooledError pooled(const CampaignStatistics& s, std::size_t field) {
    const FieldStatistics& f = s.fields[field];
    if (f.epochs == 0) return {};
    return {{std::sqrt(f.square.value() / static_cast<double>(f.epochs)), f.size.quantile(0.95), f.largest}, f.runs.quantiles()};
}

struct PooledMeasurement {
    std::string name;
    double nis = 0.0, dof = 0.0, lag1 = 0.0;
    std::size_t accepted = 0, rejected = 0;
    analysis::Bounds bounds{};
};

std::vector<PooledMeasurement> pooled_measurements(const CampaignStatistics& s) {
    std::vector<PooledMeasurement> out;
    for (const auto& [name, a] : s.measurements) {
        const auto n = static_cast<double>(a.accepted);
        PooledMeasurement& p = out.emplace_back(
            PooledMeasurement{name, a.nis.value() / n, a.dof.value() / n, a.lag1.value() / n, a.accepted, a.rejected, {}});
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
const std::vector<report::TableColumn>& point_columns() {
    static const std::vector<report::TableColumn> list{{"runs", "runs", "", "g"},
                                                       {"failed", "failed", "", "g"},
                                                       {"horizontal_rms_m", "horizontal", "m"},
                                                       {"up_rms_m", "up", "m"},
                                                       {"three_d_rms_m", ""},
                                                       {"heading_rms_deg", "heading", "deg"},
                                                       {"nees_position", "NEES of position"},
                                                       {"outage_end_horizontal_rms_m", "end of outage", "m"}};
    return list;
}

std::array<double, 8> numbers_of(const PointStatistics& p) {
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

/// One row per point, for display and files.
report::ResultTable sweep_table(const MonteCarlo& mc) {
    report::ResultTable table{"sweep, root mean squares"};
    for (const auto& [key, value] : at_point(mc, 0)) table.columns.push_back({key, key, "", ".6g", ""});
    table.columns.insert(table.columns.end(), point_columns().begin(), point_columns().end());
    for (const auto& [point, p] : mc.statistics().points) {
        std::vector<report::Cell>& row = table.rows.emplace_back();
        for (const auto& [key, value] : at_point(mc, point)) {
            if (value->is_number()) row.emplace_back(value->number());
            else row.emplace_back(value->text() != nullptr ? *value->text() : settings::to_toml(*value));
        }
        for (const double x : numbers_of(p)) row.emplace_back(x);
    }
    return table;
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
    for (const PooledMeasurement& a : pooled_measurements(s)) {
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
    out["point"] = s.head.scheme == settings::scheme_name(settings::Scheme::Gnss) ? "antenna" : "imu";
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
    if (s.swept) out["montecarlo"]["sweep"] = report::table_json(sweep_table(mc));
    out["timing"] = {{"wall_s", mc.wall_s}};
    out["ignored"] = report::ignored_json(mc.ignored);
    out["warnings"] = warnings_of_runs(mc);
    return report::text_of(out);
}

namespace {

using report::Cell;
using report::ResultTable;

std::string readable(std::string_view unit) { return unit == "m_s" ? "m/s" : unit == "deg_h" ? "deg/h" : std::string(unit); }
std::string in_words(std::string_view name) {
    std::string out(name);
    std::ranges::replace(out, '_', ' ');
    return out;
}

std::string error_table(const CampaignStatistics& s) {
    ResultTable table = report::table_for_people(
        "", {fmt::format("errors from {:.1f} s", s.head.settled_s), "rms", "95 %", "largest", "runs: 5 %", "median", "95 %"});
    for (std::size_t i = 0; i < error_field_count; ++i) {
        const PooledError p = pooled(s, i);
        if (std::isfinite(p.all.rms))
            table.rows.push_back(
                {error_fields()[i].title, p.all.rms, p.all.p95, p.all.max, p.runs.q05, p.runs.median, p.runs.q95});
    }
    return report::table_text(table);
}

std::string block_table(const CampaignStatistics& s) {
    ResultTable table =
        report::table_for_people("", {s.head.smoothed ? "states, smoothed" : "states", "rms", "5 %", "median", "95 %"});
    for (std::size_t b = 2; b < solution::state_blocks; ++b) {  // position and velocity are above
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!s.present(b)) continue;
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis) {
            const Quantiles q = s.component(b, axis);
            table.rows.push_back({fmt::format("{} {}, {}", in_words(name.name), name.axis[axis], readable(name.unit)), q.rms,
                                  q.q05, q.median, q.q95});
        }
    }
    return report::table_text(table);
}

std::string outage_table(const std::vector<PooledOutage>& outages) {
    ResultTable table = report::table_for_people(
        "", {"outages, horizontal", "end: median, m", "95 %, m", "growth: median, m", "95 %, m", "inside 3 sigma"});
    table.columns.back().format = ".0f%";
    for (const PooledOutage& o : outages)
        table.rows.push_back({fmt::format("{:.10g} s for {:.6g} s", o.start_s, o.duration_s), o.end_horizontal.median,
                              o.end_horizontal.q95, o.growth.median, o.growth.q95, o.inside_3sigma});
    return report::table_text(table);
}

std::string consistency_table(const CampaignStatistics& s) {
    ResultTable table =
        report::table_for_people("", {s.head.smoothed ? "consistency, NEES smoothed" : "consistency", "mean", "expected",
                                      "95 % bounds: from", "to", "epochs inside", "rejected", "lag 1", "mean in its bounds"});
    table.columns[5].format = ".0f%";
    const auto add = [&](const std::string& name, double mean, double expected, double low, double high, std::vector<Cell> rest) {
        std::vector<Cell>& row = table.rows.emplace_back(std::vector<Cell>{name, mean, expected, low, high});
        row.insert(row.end(), rest.begin(), rest.end());
        row.emplace_back(mean >= low && mean <= high ? "yes" : "OUTSIDE");
    };
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!s.present(b)) continue;
        const analysis::EnsembleConsistency c = s.consistency(b);
        add("NEES " + in_words(name.name), c.mean, c.expected, c.low95, c.high95, {c.inside, {}, {}});
    }
    for (const PooledMeasurement& a : pooled_measurements(s))
        add("NIS " + in_words(a.name), a.nis, a.dof, a.bounds.low95, a.bounds.high95,
            {Cell{}, fmt::format("{} of {}", a.rejected, a.accepted + a.rejected), a.lag1});
    return report::table_text(table);
}

std::string shown_sweep(const MonteCarlo& mc) {
    constexpr std::size_t shown = 100;
    ResultTable table = sweep_table(mc);
    const std::size_t points = table.rows.size();
    if (points > shown) table.rows.resize(shown);
    return report::table_text(table) + (points > shown ? fmt::format("  ... {} points in all: sweep.csv\n", points) : "");
}

}  // namespace

std::string sweep_csv(const MonteCarlo& mc) { return report::table_csv(sweep_table(mc)); }

std::string summary_tables(const MonteCarlo& mc) {
    const CampaignStatistics& s = mc.statistics();
    const std::uint64_t seed = mc.seed + mc.first;
    std::string out =
        fmt::format("{}: {} runs, seeds {} to {}, {} failed\n\n", mc.name, mc.runs, seed, seed + mc.runs - 1, s.failed);
    out += error_table(s) + block_table(s);
    if (const std::vector<PooledOutage> outages = pooled_outages(s); !outages.empty()) out += "\n" + outage_table(outages);
    out += "\n" + consistency_table(s);
    if (s.swept) out += "\n" + shown_sweep(mc);
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
