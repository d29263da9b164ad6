// Monte Carlo runs of one scenario, and the statistics of their errors and innovations.
#pragma once

#include "schuler/analysis/ensemble.h"
#include "schuler/analysis/errors.h"
#include "schuler/analysis/outages.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/evaluate.h"
#include "schuler/solution/state_errors.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace schuler::study {

/// What is kept of one run.
struct MonteCarloRun {
    std::uint64_t seed = 0;
    settings::SettingList drawn;                               ///< values of the keys that vary
    std::string failure;                             ///< empty: it went through
    double settled_s = 0.0;                          ///< s after the first fix, from where errors are counted
    analysis::ErrorSummary summary;                  ///< at every reference epoch
    std::vector<analysis::ErrorRow> errors;          ///< a thousand of them at most, settled
    std::vector<solution::StateErrors> states;                 ///< a thousand of them at most, from the start on
    std::vector<solution::AidConsistency> aids;
    std::vector<analysis::OutageStatistics> outages;

    [[nodiscard]] bool failed() const { return !failure.empty(); }
};

/// One block of states over all runs that went through, at the epochs of the first of them.
struct BlockEnsemble {
    std::array<analysis::RunsByEpochs, 3> error;     ///< SI
    analysis::RunsByEpochs nees;
    [[nodiscard]] bool present() const;
};

struct MonteCarlo {
    std::string name, version;
    settings::Published published;
    settings::Config config;                                   ///< of the first run
    std::vector<MonteCarloRun> runs;
    std::vector<double> time_s;                      ///< epochs, s after the first fix
    Eigen::Index settled = 0;                        ///< index of the first of them that counts
    std::array<BlockEnsemble, solution::state_blocks> blocks;
    double wall_s = 0.0;

    [[nodiscard]] std::size_t failed() const;
    /// The settled part of a block's values.
    [[nodiscard]] analysis::RunsByEpochs counted(const analysis::RunsByEpochs& values) const;
};

/// The settings of one run: another seed, and the keys that vary, drawn (into `drawn` too).
[[nodiscard]] settings::SettingList settings_of_run(const settings::SettingList& base, const std::vector<settings::Variation>& vary, std::uint64_t seed, settings::SettingList& drawn);

/// Simulates, fuses and evaluates `runs` runs; run k has the seed of the scenario plus k, so that `schuler run --seed` repeats it.
/// The result does not depend on `jobs`. @throws Error where no run goes through.
[[nodiscard]] MonteCarlo montecarlo(const settings::ProcessRequest& request, std::optional<std::size_t> runs, int jobs);

/// summary.json of a campaign; everything but montecarlo.runs_per_s and timing depends on the input alone.
[[nodiscard]] std::string summary_json(const MonteCarlo& campaign);
/// The same for people.
[[nodiscard]] std::string summary_tables(const MonteCarlo& campaign);
/// A row an epoch: root mean square and quantiles over the runs of each state's error, mean NEES of each block with its bounds.
[[nodiscard]] std::string epochs_csv(const MonteCarlo& campaign);
/// A row a run: seed, drawn values, its errors and mean NEES.
[[nodiscard]] std::string runs_csv(const MonteCarlo& campaign);

/// Many seeds of a scenario on `jobs` threads (0: one a core): errors and consistency over the runs. @throws Error
[[nodiscard]] report::Outcome run_montecarlo(const settings::ProcessRequest& request, std::optional<std::size_t> runs, int jobs);

}  // namespace schuler::study
