// The tables of a campaign as CSV: epochs and runs.
#include "schuler/io/atomic_file.h"
#include "schuler/io/text/csv/csv_field.h"
#include "schuler/study/montecarlo/montecarlo.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::study {
namespace {

constexpr std::size_t leading = 3;  ///< run, failed, seed

std::string number(double x) { return std::isfinite(x) ? fmt::format(",{:.9g}", x) : ","; }

std::string csv_value(const settings::Value& value) {
    if (value.is_number()) return fmt::format("{}", value.number());
    return io::csv_field(value.text() != nullptr ? *value.text() : settings::to_toml(value));
}

/// A number of a row as the value it represents.
std::string drawn_value(const settings::Variation& v, double x) {
    if (!std::isfinite(x)) return {};
    const bool of_list = !v.values.empty() && !v.values.front().is_number();
    return of_list && x >= 0.0 && x < static_cast<double>(v.values.size()) ? csv_value(v.values[static_cast<std::size_t>(x)])
                                                                           : fmt::format("{}", x);
}

}  // namespace

std::string epochs_csv(const MonteCarlo& mc) {
    const CampaignStatistics& s = mc.statistics();
    const auto& names = solution::state_block_names();
    std::string out = "time_s";
    for (std::size_t b = 0; b < solution::state_blocks; ++b) {
        if (!s.present(b)) continue;
        for (std::size_t axis = 0; axis < static_cast<std::size_t>(names[b].dof); ++axis)
            for (const char* what : {"rms", "q05", "median", "q95"})
                out += fmt::format(",{}_{}_{}_{}", names[b].name, names[b].axis[axis], names[b].unit, what);
        out += fmt::format(",nees_{0},nees_{0}_low95,nees_{0}_high95", names[b].name);
    }
    out += '\n';
    const BlockAtEpoch none;
    for (const auto& [key, epoch] : s.epochs) {
        out += fmt::format("{:.9g}", epoch.time_s);
        for (std::size_t b = 0; b < solution::state_blocks; ++b) {
            if (!s.present(b)) continue;
            const BlockAtEpoch& block = epoch.block[b].empty() ? none : epoch.block[b].front();
            for (std::size_t axis = 0; axis < static_cast<std::size_t>(names[b].dof); ++axis) {
                const analysis::Quantiles q = block.error[axis].quantiles();
                for (const double x : {q.rms, q.q05, q.median, q.q95}) out += number(x);
            }
            if (block.count == 0) {
                out += ",,,";
                continue;
            }
            const auto n = static_cast<double>(block.count);
            const analysis::Bounds bounds = analysis::mean_bounds(names[b].dof, n);
            for (const double x : {block.nees.value() / n, bounds.low95, bounds.high95}) out += number(x);
        }
        out += '\n';
    }
    return out;
}

RunNumbers numbers_of(const MonteCarloRun& run, std::size_t varying) {
    const double nan = std::nan("");
    RunNumbers out{static_cast<double>(run.run), run.failed() ? 1.0 : 0.0, static_cast<double>(run.seed)};
    for (std::size_t i = 0; i < varying; ++i) out.push_back(i < run.numbers.size() ? run.numbers[i] : nan);
    for (const ErrorField& f : error_fields()) out.push_back(run.failed() ? nan : (run.summary.*f.of_run).rms / f.si);
    const auto nees = mean_nees(run);
    for (const double x : nees) out.push_back(run.failed() ? nan : x);
    return out;
}

void write_runs_csv(const MonteCarlo& mc, const std::filesystem::path& file) {
    std::string out = "run,seed,failed";
    for (const settings::Variation& v : mc.vary) out += "," + v.key;
    for (const ErrorField& f : error_fields()) out += fmt::format(",{}_{}_rms", f.group, f.name);
    for (std::size_t b = 0; b < solution::state_blocks; ++b)
        if (mc.statistics().present(b)) out += fmt::format(",nees_{}", solution::state_block_names()[b].name);
    out += '\n';
    io::AtomicFile csv(file);
    mc.part->each_row(mc.first, mc.first + mc.runs, [&](const RunNumbers& row) {
        out += fmt::format("{:.0f},{:.0f},{:.0f}", row[0], row[2], row[1]);
        std::size_t at = leading;
        for (const settings::Variation& v : mc.vary) out += "," + drawn_value(v, row[at++]);
        for (std::size_t i = 0; i < error_field_count; ++i) out += number(row[at++]);
        for (std::size_t b = 0; b < solution::state_blocks; ++b, ++at)
            if (mc.statistics().present(b)) out += number(row[at]);
        out += '\n';
        csv.write(out);
        out.clear();
    });
    csv.commit();
}

}  // namespace schuler::study
