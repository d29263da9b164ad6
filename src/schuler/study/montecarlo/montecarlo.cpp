#include "schuler/study/montecarlo/montecarlo.h"

#include "schuler/core/parallel.h"
#include "schuler/math/random.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/comparison/compare_campaign.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace schuler::study {
namespace {

constexpr std::size_t default_runs = 100;
constexpr std::size_t kept_epochs = 1000;   ///< of each run: bounds the memory of long campaigns

/// Every n-th element, so that at most kept_epochs remain.
template <class Row>
std::vector<Row> sparse(const std::vector<Row>& rows) {
    const std::size_t stride = (rows.size() + kept_epochs - 1) / kept_epochs;
    std::vector<Row> out;
    for (std::size_t i = 0; i < rows.size(); i += stride) out.push_back(rows[i]);
    return out;
}

MonteCarloRun run_of(const settings::ScenarioConfig& scenario, const settings::SettingList& over, solution::ResultBundle& bundle) {
    MonteCarloRun run;
    WarningLog unheard;
    bundle = solution::simulated_bundle(scenario, over, unheard);
    solution::fuse_and_evaluate(bundle, unheard, scenario.sim.reference_rate, {});
    const solution::Evaluation& e = bundle.evaluation;
    run.settled_s = bundle.relative(e.settled);
    run.summary = e.summary;
    std::vector<analysis::ErrorRow> settled;
    std::ranges::copy_if(e.errors, std::back_inserter(settled), [&](const auto& row) { return row.time >= e.settled; });
    run.errors = sparse(settled);
    run.states = sparse(e.states);
    run.aids = e.aids;
    run.outages = e.outages;
    return run;
}

void gather_blocks(MonteCarlo& mc, Time origin) {
    const auto first = std::ranges::find_if(mc.runs, [](const MonteCarloRun& r) { return !r.failed(); });
    const std::vector<solution::StateErrors>& epochs = first->states;
    const auto rows = static_cast<Eigen::Index>(mc.runs.size() - mc.failed()), columns = static_cast<Eigen::Index>(epochs.size());
    for (const solution::StateErrors& e : epochs) mc.time_s.push_back((e.time - origin).seconds());
    mc.settled = std::ranges::lower_bound(mc.time_s, first->settled_s - 1e-9) - mc.time_s.begin();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (BlockEnsemble& b : mc.blocks) {
        for (auto& error : b.error) error = analysis::RunsByEpochs::Constant(rows, columns, nan);
        b.nees = analysis::RunsByEpochs::Constant(rows, columns, nan);
    }
    Eigen::Index row = 0;
    for (const MonteCarloRun& run : mc.runs) {
        if (run.failed()) continue;
        auto it = run.states.begin();
        for (Eigen::Index k = 0; k < columns; ++k) {
            const Time t = epochs[static_cast<std::size_t>(k)].time;
            while (it != run.states.end() && it->time < t) ++it;
            if (it == run.states.end()) break;
            if (it->time != t) continue;
            for (std::size_t b = 0; b < solution::state_blocks; ++b) {
                for (std::size_t axis = 0; axis < 3; ++axis)
                    mc.blocks[b].error[axis](row, k) = it->error[b][static_cast<Eigen::Index>(axis)];
                mc.blocks[b].nees(row, k) = it->nees[b];
            }
        }
        ++row;
    }
}

}  // namespace

settings::SettingList settings_of_run(const settings::SettingList& base, const std::vector<settings::Variation>& vary, std::uint64_t seed, settings::SettingList& drawn) {
    settings::SettingList out = base;
    for (const settings::Variation& v : vary) {
        math::Random random(seed, "vary." + v.key);
        const double x = v.normal ? v.first + v.second * random.normal() : v.first + (v.second - v.first) * random.uniform();
        drawn.push_back({v.key, {x}, {"montecarlo.vary", 0, 0, v.key}});
    }
    out.insert(out.end(), drawn.begin(), drawn.end());
    out.push_back({"seed", {static_cast<std::int64_t>(seed)}, {}});
    return out;
}

bool BlockEnsemble::present() const { return nees.array().isFinite().any(); }

std::size_t MonteCarlo::failed() const {
    return static_cast<std::size_t>(std::ranges::count_if(runs, [](const MonteCarloRun& r) { return r.failed(); }));
}

analysis::RunsByEpochs MonteCarlo::counted(const analysis::RunsByEpochs& values) const {
    return values.rightCols(values.cols() - settled);
}

MonteCarlo montecarlo(const settings::ProcessRequest& request, std::optional<std::size_t> runs, int jobs) {
    const auto begin = std::chrono::steady_clock::now();
    const settings::SettingList base = settings::scenario_settings(request.input, request.seed);
    const settings::ScenarioConfig scenario = settings::scenario_from(base);   // wrong settings fail here, before any run
    const settings::SettingList over = request.over({});
    MonteCarlo mc;
    mc.name = scenario.name;
    mc.version = request.version;
    mc.published = scenario.published;
    mc.runs.resize(runs.value_or(static_cast<std::size_t>(scenario.montecarlo_runs.value_or(default_runs))));
    Time origin;
    for_each_run(
        mc.runs.size(), jobs,
        [&](std::size_t k) {
            MonteCarloRun run;
            const std::uint64_t seed = scenario.sim.seed + k;
            settings::SettingList drawn;
            solution::ResultBundle bundle;
            try {
                run = run_of(settings::scenario_from(settings_of_run(base, scenario.vary, seed, drawn)), over, bundle);
            } catch (const Error& e) {
                if (k == 0 && e.kind() == ErrorKind::Input) throw;
                run.failure = e.what();
            }
            run.seed = seed;
            run.drawn = std::move(drawn);
            mc.runs[k] = std::move(run);
            if (k == 0) {
                mc.config = bundle.data.config;
                origin = bundle.data.origin;
            }
        },
        request.progress);
    if (mc.failed() == mc.runs.size())
        throw computation_error(fmt::format("no run went through; the first one: {}", mc.runs.front().failure),
                                fmt::format("try `schuler run` with --seed {}", mc.runs.front().seed));
    gather_blocks(mc, origin);
    mc.wall_s = solution::seconds_since(begin);
    return mc;
}

report::Outcome run_montecarlo(const settings::ProcessRequest& request, std::optional<std::size_t> runs, int jobs) {
    const settings::ScenarioConfig scenario = settings::read_scenario(request.input, request.seed);
    if (!scenario.compared.empty() && !request.names_a_scheme())
        return montecarlo_of_schemes(request, runs.value_or(static_cast<std::size_t>(scenario.montecarlo_runs.value_or(default_runs))), jobs);
    const MonteCarlo mc = montecarlo(request, runs, jobs);
    report::Outcome out;
    out.folder = request.output.empty() ? std::filesystem::path("out") / (mc.name + "-montecarlo") : request.output;
    report::make_folder(out.folder);
    out.json = summary_json(mc);
    out.tables = summary_tables(mc);
    const auto write = [&](const char* name, const std::string& text) { report::write_text(out.files.emplace_back(out.folder / name), text); };
    write("epochs.csv", epochs_csv(mc));
    write("runs.csv", runs_csv(mc));
    write("summary.json", out.json);
    for (const MonteCarloRun& r : mc.runs)
        if (r.failed()) out.warnings.push_back(fmt::format("seed {}: {}", r.seed, r.failure));
    return out;
}

}  // namespace schuler::study
