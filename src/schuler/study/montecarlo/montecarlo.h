// Monte Carlo runs of one scenario, and the statistics of their errors and innovations.
#pragma once

#include "schuler/core/team.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/study/montecarlo/checkpoint.h"
#include "schuler/study/montecarlo/statistics.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

struct CampaignRequest {
    settings::ProcessRequest common;
    std::optional<std::size_t> runs;
    std::size_t first = 0;       ///< number of the first run
    int jobs = 0;                ///< threads; 0: one per core
    bool resume = false;         ///< continue the campaign in the folder
    std::shared_ptr<Team> team;  ///< the processes that share the runs; null: this one alone
};

/// A completed campaign. Its rows and checkpoint are in its folder until removed.
struct MonteCarlo {
    std::string name, version;
    settings::Published published;
    std::vector<settings::Variation> vary;
    std::uint64_t seed = 0;  ///< of run 0
    std::size_t first = 0, runs = 0;
    std::filesystem::path folder;
    std::unique_ptr<CampaignPart> part;
    std::size_t run_here = 0;  ///< since the last resumption, for the speed
    double wall_s = 0.0;
    std::vector<solution::Ignored> ignored;  ///< settings without effect on the scenario

    [[nodiscard]] const CampaignStatistics& statistics() const { return part->statistics(); }
};

/// The settings of one run: its seed, and the varying keys, drawn (and stored in `drawn`) or at the run's grid point.
[[nodiscard]] settings::SettingList settings_of_run(const settings::SettingList& base,
                                                    const std::vector<settings::Variation>& vary, std::uint64_t seed,
                                                    std::uint64_t run, settings::SettingList& drawn);

/// Simulates, processes and evaluates the runs; run k has the seed of the scenario plus k, so that `schuler run --seed` repeats it. The result
/// does not depend on jobs, processes or interruptions. In processes other than 0 of a team it is empty. @throws Error if no run succeeds.
[[nodiscard]] MonteCarlo montecarlo(const CampaignRequest& request);

/// Warnings of its successful runs: one line per topic.
[[nodiscard]] std::vector<std::string> warnings_of_runs(const MonteCarlo& campaign);
/// summary.json of a campaign; everything except montecarlo.runs_per_s and timing depends on the input alone.
[[nodiscard]] std::string summary_json(const MonteCarlo& campaign);
/// The same as readable text.
[[nodiscard]] std::string summary_tables(const MonteCarlo& campaign);
/// One row per epoch: root mean square and quantiles over the runs of each state's error, mean NEES of each block with bounds.
[[nodiscard]] std::string epochs_csv(const MonteCarlo& campaign);
/// One row per grid point of sweeps.
[[nodiscard]] std::string sweep_csv(const MonteCarlo& campaign);
/// One row per run: seed, drawn values, its errors and mean NEES.
void write_runs_csv(const MonteCarlo& campaign, const std::filesystem::path& file);
[[nodiscard]] RunNumbers numbers_of(const MonteCarloRun& run, std::size_t varying);

/// Many runs of a scenario: errors and consistency over the runs, as files. @throws Error
[[nodiscard]] report::Outcome run_montecarlo(const CampaignRequest& request);

}  // namespace schuler::study
