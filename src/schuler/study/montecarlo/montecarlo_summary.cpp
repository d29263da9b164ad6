// A campaign as JSON, as CSV and as tables.
#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/published.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::study {
namespace {

using analysis::ErrorRow;
using analysis::ErrorSummary;
using analysis::Quantiles;
using analysis::Spread;

/// A scalar error of summary.json: where it stands, how it is got, its unit.
struct ErrorField {
    const char* group;
    const char* name;
    const char* title;
    Spread ErrorSummary::*of_run;
    double (*of_row)(const ErrorRow&);
    double si;
};
const ErrorField error_fields[] = {
    {"position_m", "east", "position east, m", &ErrorSummary::east, [](const ErrorRow& r) { return r.position.x(); }, 1.0},
    {"position_m", "north", "position north, m", &ErrorSummary::north, [](const ErrorRow& r) { return r.position.y(); }, 1.0},
    {"position_m", "up", "position up, m", &ErrorSummary::up, [](const ErrorRow& r) { return r.position.z(); }, 1.0},
    {"position_m", "horizontal", "position horizontal, m", &ErrorSummary::horizontal,
     [](const ErrorRow& r) { return r.position.head<2>().norm(); }, 1.0},
    {"position_m", "three_d", "position 3-d, m", &ErrorSummary::three_d, [](const ErrorRow& r) { return r.position.norm(); }, 1.0},
    {"velocity_m_s", "east", "velocity east, m/s", &ErrorSummary::v_east, [](const ErrorRow& r) { return r.velocity.x(); }, 1.0},
    {"velocity_m_s", "north", "velocity north, m/s", &ErrorSummary::v_north, [](const ErrorRow& r) { return r.velocity.y(); }, 1.0},
    {"velocity_m_s", "up", "velocity up, m/s", &ErrorSummary::v_up, [](const ErrorRow& r) { return r.velocity.z(); }, 1.0},
    {"attitude_deg", "roll", "roll, deg", &ErrorSummary::roll, [](const ErrorRow& r) { return r.rpy.x(); }, units::deg},
    {"attitude_deg", "pitch", "pitch, deg", &ErrorSummary::pitch, [](const ErrorRow& r) { return r.rpy.y(); }, units::deg},
    {"attitude_deg", "heading", "heading, deg", &ErrorSummary::heading, [](const ErrorRow& r) { return r.rpy.z(); }, units::deg},
};

/// Over all runs and epochs (rms, p95, max), and the runs' own rms as quantiles.
struct PooledError {
    Spread all;
    Quantiles runs;
};

PooledError pooled(const MonteCarlo& mc, const ErrorField& f) {
    PooledError out;
    double square = 0.0, epochs = 0.0, largest = 0.0;
    std::vector<double> rms, values;
    for (const MonteCarloRun& r : mc.runs) {
        const Spread& s = r.summary.*f.of_run;
        if (r.failed() || !std::isfinite(s.rms)) continue;
        const auto n = static_cast<double>(r.summary.epochs);
        square += n * s.rms * s.rms;
        epochs += n;
        largest = std::max(largest, s.max);
        rms.push_back(s.rms / f.si);
        for (const ErrorRow& row : r.errors) values.push_back(f.of_row(row) / f.si);
    }
    if (rms.empty()) return out;
    out.all = {std::sqrt(square / epochs) / f.si, analysis::spread_of(std::move(values)).p95, largest / f.si};
    out.runs = analysis::quantiles_of(std::move(rms));
    return out;
}

struct PooledAid {
    std::string name;
    double nis = 0.0, dof = 0.0, lag1 = 0.0;
    std::size_t accepted = 0, rejected = 0;
    analysis::Bounds bounds{};
};

std::vector<PooledAid> pooled_aids(const MonteCarlo& mc) {
    std::vector<PooledAid> out;
    for (const MonteCarloRun& r : mc.runs) {
        for (const solution::AidConsistency& a : r.aids) {
            auto it = std::ranges::find(out, a.name, &PooledAid::name);
            if (it == out.end()) it = out.insert(out.end(), PooledAid{std::string(a.name), 0.0, 0.0, 0.0, 0, 0, {}});
            it->rejected += a.nis.rejected;
            if (a.nis.accepted == 0) continue;
            const auto n = static_cast<double>(a.nis.accepted);
            it->accepted += a.nis.accepted;
            it->nis += n * a.nis.mean;
            it->dof += n * a.nis.dof;
            it->lag1 += std::isfinite(a.nis.lag1) ? n * a.nis.lag1 : 0.0;
        }
    }
    for (PooledAid& a : out) {
        const auto n = static_cast<double>(a.accepted);
        a.nis /= n;
        a.dof /= n;
        a.lag1 /= n;
        if (a.accepted > 0) a.bounds = analysis::mean_bounds(a.dof, n);
    }
    return out;
}

struct PooledOutage {
    double start_s = 0.0, duration_s = 0.0;
    Quantiles end_horizontal, max_horizontal, end_vertical, max_3d, growth;
    double inside_3sigma = 0.0;
};

std::vector<PooledOutage> pooled_outages(const MonteCarlo& mc) {
    std::vector<PooledOutage> out;
    const auto& outages = mc.config.filter.outages;
    for (std::size_t k = 0; k < outages.size(); ++k) {
        PooledOutage p{outages[k].start, outages[k].duration, {}, {}, {}, {}, {}, 0.0};
        std::vector<double> end, most, vertical, three, growth;
        for (const MonteCarloRun& r : mc.runs) {
            if (r.failed() || r.outages.size() <= k) continue;
            const analysis::OutageStatistics& o = r.outages[k];
            end.push_back(o.end_horizontal);
            most.push_back(o.max_horizontal);
            vertical.push_back(o.end_vertical);
            three.push_back(o.max_3d);
            growth.push_back(o.growth_horizontal);
            p.inside_3sigma += o.inside_3sigma ? 1.0 : 0.0;
        }
        if (end.empty()) continue;
        p.inside_3sigma /= static_cast<double>(end.size());
        p.end_horizontal = analysis::quantiles_of(std::move(end));
        p.max_horizontal = analysis::quantiles_of(std::move(most));
        p.end_vertical = analysis::quantiles_of(std::move(vertical));
        p.max_3d = analysis::quantiles_of(std::move(three));
        p.growth = analysis::quantiles_of(std::move(growth));
        out.push_back(p);
    }
    return out;
}

report::Json of(const Quantiles& q) { return {{"rms", report::json_number(q.rms)}, {"median", report::json_number(q.median)}, {"q05", report::json_number(q.q05)}, {"q95", report::json_number(q.q95)}}; }

report::Json of(const analysis::EnsembleConsistency& c) {
    return {{"mean", report::json_number(c.mean)},     {"expected", report::json_number(c.expected)}, {"low95", report::json_number(c.low95)},
            {"high95", report::json_number(c.high95)}, {"inside", report::json_number(c.inside)},     {"worth", report::json_number(c.worth)}};
}

/// All settled values of one component.
Quantiles component(const MonteCarlo& mc, std::size_t block, std::size_t axis) {
    const analysis::RunsByEpochs v = mc.counted(mc.blocks[block].error[axis]) / solution::state_block_names()[block].si;
    return analysis::quantiles_of({v.reshaped().begin(), v.reshaped().end()});
}

report::Json consistency_of(const MonteCarlo& mc) {
    report::Json out;
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        out["nees_" + std::string(name.name)] =
            mc.blocks[b].present() ? of(analysis::ensemble_consistency(mc.counted(mc.blocks[b].nees), name.dof)) : report::Json(nullptr);
    }
    report::Json nis;
    for (const char* name : {"gnss_position", "gnss_velocity", "baro", "pseudorange", "range_rate", "mag"}) nis[name] = nullptr;
    for (const PooledAid& a : pooled_aids(mc)) {
        nis[a.name] = {{"mean", report::json_number(a.nis)},          {"dof", report::json_number(a.dof)},
                       {"accepted", a.accepted},         {"rejected", a.rejected},
                       {"lag1", report::json_number(a.lag1)},         {"low95", report::json_number(a.bounds.low95)},
                       {"high95", report::json_number(a.bounds.high95)}};
    }
    out["nis"] = std::move(nis);
    return out;
}

}  // namespace

std::string summary_json(const MonteCarlo& mc) {
    const settings::Config& c = mc.config;
    report::Json out;
    out["name"] = mc.name;
    out["command"] = "montecarlo";
    out["scheme"] = settings::scheme_name(c.scheme);
    out["mechanization"] = c.filter.mechanization == fusion::Mechanization::Geographic ? "geographic" : "ecef";
    out["loop"] = settings::loop_name(c.filter.loop);
    out["smoothed"] = c.filter.smooth;
    out["seed"] = mc.runs.front().seed;
    out["version"] = mc.version;
    out["reference"] = "truth";
    for (const ErrorField& f : error_fields) {
        const PooledError p = pooled(mc, f);
        out["errors"][f.group][f.name] = {{"rms", report::json_number(p.all.rms)},     {"p95", report::json_number(p.all.p95)},
                                          {"max", report::json_number(p.all.max)},     {"median", report::json_number(p.runs.median)},
                                          {"q05", report::json_number(p.runs.q05)},    {"q95", report::json_number(p.runs.q95)}};
    }
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!mc.blocks[b].present()) continue;
        report::Json& block = out["states"][fmt::format("{}_{}", name.name, name.unit)];
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis) block[std::string(name.axis[axis])] = of(component(mc, b, axis));
    }
    const auto first = std::ranges::find_if(mc.runs, [](const MonteCarloRun& r) { return !r.failed(); });
    out["settled_after_s"] = report::json_number(first->settled_s);
    out["consistency"] = consistency_of(mc);
    out["outages"] = report::Json::array();
    for (const PooledOutage& o : pooled_outages(mc)) {
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
    const auto runs = static_cast<double>(mc.runs.size());
    out["montecarlo"] = {{"runs", mc.runs.size()}, {"failed", mc.failed()}, {"runs_per_s", report::json_number(runs / mc.wall_s)}};
    out["timing"] = {{"wall_s", mc.wall_s}};
    out["warnings"] = report::Json::array();
    return report::text_of(out);
}

namespace {

std::string cell(double x) {
    if (!std::isfinite(x)) return "-";
    const double a = std::abs(x);
    if (a != 0.0 && (a < 1e-3 || a >= 1e5)) return fmt::format("{:.2e}", x);
    return fmt::format("{:.{}f}", x, a < 1.0 ? 4 : a < 100.0 ? 3 : 1);
}

std::string readable(std::string_view unit) {
    return unit == "m_s" ? "m/s" : unit == "deg_h" ? "deg/h" : std::string(unit);
}

std::string block_table(const MonteCarlo& mc) {
    std::string out = fmt::format("{:<28}{:>11}{:>11}{:>11}{:>11}\n", "states", "rms", "5 %", "median", "95 %");
    for (std::size_t b = 2; b < solution::state_blocks; ++b) {   // position and velocity stand above
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!mc.blocks[b].present()) continue;
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis) {
            const Quantiles q = component(mc, b, axis);
            std::string title = fmt::format("{} {}, {}", name.name, name.axis[axis], readable(name.unit));
            std::ranges::replace(title, '_', ' ');
            out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}\n", title, cell(q.rms), cell(q.q05), cell(q.median), cell(q.q95));
        }
    }
    return out;
}

std::string consistency_table(const MonteCarlo& mc) {
    std::string out = fmt::format("{:<24}{:>11}{:>11}   {:<22}{}\n", "consistency", "mean", "expected", "95 % bounds", "epochs inside theirs");
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!mc.blocks[b].present()) continue;
        const analysis::EnsembleConsistency c = analysis::ensemble_consistency(mc.counted(mc.blocks[b].nees), name.dof);
        const bool holds = c.mean >= c.low95 && c.mean <= c.high95;
        out += fmt::format("  NEES {:<17}{:>11}{:>11}   {:<22}{:.0f} %{}\n", name.name, cell(c.mean), cell(c.expected),
                           fmt::format("({} to {})", cell(c.low95), cell(c.high95)), 100.0 * c.inside, holds ? "" : "   OUTSIDE");
    }
    for (const PooledAid& a : pooled_aids(mc)) {
        const bool holds = a.nis >= a.bounds.low95 && a.nis <= a.bounds.high95;
        out += fmt::format("  NIS  {:<17}{:>11}{:>11}   {:<22}{} rejected of {}, lag 1 {}{}\n", a.name, cell(a.nis), cell(a.dof),
                           fmt::format("({} to {})", cell(a.bounds.low95), cell(a.bounds.high95)), a.rejected,
                           a.accepted + a.rejected, cell(a.lag1), holds ? "" : "   OUTSIDE");
    }
    return out;
}

}  // namespace

std::string summary_tables(const MonteCarlo& mc) {
    const auto first = std::ranges::find_if(mc.runs, [](const MonteCarloRun& r) { return !r.failed(); });
    std::string out = fmt::format("{}: {} runs, seeds {} to {}, {} failed\n\n", mc.name, mc.runs.size(), mc.runs.front().seed,
                                  mc.runs.back().seed, mc.failed());
    out += fmt::format("{:<28}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", fmt::format("errors from {:.1f} s", first->settled_s), "rms",
                       "95 %", "max", "runs: 5 %", "median", "95 %");
    for (const ErrorField& f : error_fields) {
        const PooledError p = pooled(mc, f);
        if (!std::isfinite(p.all.rms)) continue;
        out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", f.title, cell(p.all.rms), cell(p.all.p95), cell(p.all.max),
                           cell(p.runs.q05), cell(p.runs.median), cell(p.runs.q95));
    }
    out += block_table(mc);
    const std::vector<PooledOutage> outages = pooled_outages(mc);
    if (!outages.empty())
        out += fmt::format("\n{:<28}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "outages, horizontal, m", "end median", "95 %", "growth 50 %",
                           "95 %", "3 sigma");
    for (const PooledOutage& o : outages) {
        out += fmt::format("  {:<26}{:>11}{:>11}{:>11}{:>11}{:>9.0f} %\n", fmt::format("{:.10g} s for {:.6g} s", o.start_s, o.duration_s),
                           cell(o.end_horizontal.median), cell(o.end_horizontal.q95), cell(o.growth.median), cell(o.growth.q95),
                           100.0 * o.inside_3sigma);
    }
    out += "\n" + consistency_table(mc);
    if (!mc.published.source.empty()) {
        settings::BlockRms rms;
        for (std::size_t b = 0; b < settings::published_blocks; ++b)
            for (std::size_t axis = 0; axis < 3; ++axis)
                rms[b][static_cast<Eigen::Index>(axis)] = component(mc, b, axis).rms * solution::state_block_names()[b].si;
        out += "\n" + report::published_table(mc.published, rms, fmt::format("{} runs, from {:.0f} s", mc.runs.size(), first->settled_s));
    }
    out += fmt::format("\n{:.1f} s, {:.2f} runs/s\n", mc.wall_s, static_cast<double>(mc.runs.size()) / mc.wall_s);
    return out;
}

std::string epochs_csv(const MonteCarlo& mc) {
    std::string header = "time_s";
    std::vector<std::vector<double>> columns;
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        const solution::StateBlockName& name = solution::state_block_names()[b];
        if (!mc.blocks[b].present()) continue;
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(name.dof); ++axis) {
            std::vector<double> rms, q05, median, q95;
            for (const Quantiles& q : analysis::quantiles_by_epoch(mc.blocks[b].error[axis] / name.si)) {
                rms.push_back(q.rms);
                q05.push_back(q.q05);
                median.push_back(q.median);
                q95.push_back(q.q95);
            }
            for (const char* what : {"rms", "q05", "median", "q95"}) header += fmt::format(",{}_{}_{}_{}", name.name, name.axis[axis], name.unit, what);
            for (auto* column : {&rms, &q05, &median, &q95}) columns.push_back(std::move(*column));
        }
        std::vector<double> mean, low, high;
        for (Eigen::Index k = 0; k < mc.blocks[b].nees.cols(); ++k) {
            const analysis::EnsembleConsistency c = analysis::ensemble_consistency(mc.blocks[b].nees.col(k), name.dof);
            const auto n = static_cast<double>(mc.blocks[b].nees.col(k).array().isFinite().count());
            const analysis::Bounds bounds = n > 0.0 ? analysis::mean_bounds(name.dof, n) : analysis::Bounds{c.low95, c.high95};
            mean.push_back(c.mean);
            low.push_back(bounds.low95);
            high.push_back(bounds.high95);
        }
        header += fmt::format(",nees_{0},nees_{0}_low95,nees_{0}_high95", name.name);
        for (auto* column : {&mean, &low, &high}) columns.push_back(std::move(*column));
    }
    std::string out = header + "\n";
    for (std::size_t k = 0; k < mc.time_s.size(); ++k) {
        out += fmt::format("{:.9g}", mc.time_s[k]);
        for (const auto& column : columns) out += std::isfinite(column[k]) ? fmt::format(",{:.9g}", column[k]) : ",";
        out += '\n';
    }
    return out;
}

std::string runs_csv(const MonteCarlo& mc) {
    std::string out = "run,seed,failed";
    for (const settings::Setting& s : mc.runs.front().drawn) out += "," + s.key;
    for (const ErrorField& f : error_fields) out += fmt::format(",{}_{}_rms", f.group, f.name);
    for (std::size_t b = 0; b < solution::state_blocks; ++b)
        if (mc.blocks[b].present()) out += fmt::format(",nees_{}", solution::state_block_names()[b].name);
    out += '\n';
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < mc.runs.size(); ++k) {
        const MonteCarloRun& r = mc.runs[k];
        out += fmt::format("{},{},{}", k, r.seed, r.failed() ? 1 : 0);
        for (const settings::Setting& s : r.drawn) out += fmt::format(",{}", s.value.number());
        for (const ErrorField& f : error_fields)
            out += r.failed() || !std::isfinite((r.summary.*f.of_run).rms) ? "," : fmt::format(",{:.9g}", (r.summary.*f.of_run).rms / f.si);
        for (std::size_t b = 0; b < solution::state_blocks; ++b) {
            if (!mc.blocks[b].present()) continue;
            const double mean = r.failed() ? std::nan("")
                                           : analysis::ensemble_consistency(mc.counted(mc.blocks[b].nees).row(row), 1.0).mean;
            out += std::isfinite(mean) ? fmt::format(",{:.9g}", mean) : ",";
        }
        if (!r.failed()) ++row;
        out += '\n';
    }
    return out;
}

}  // namespace schuler::study
