// All results of one run: data, result, evaluation, timing.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/solution/evaluate.h"
#include "schuler/solution/loaded_dataset.h"
#include "schuler/solution/self_check.h"
#include "schuler/solution/verdict.h"

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace schuler::solution {

[[nodiscard]] inline double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

struct Timing {
    double read_s = 0.0, filter_s = 0.0, check_s = 0.0, write_s = 0.0, wall_s = 0.0;
};

/// A setting that was given but had no effect on a run.
struct Ignored {
    std::string key, reason;
};

struct ResultBundle {
    std::string command;  ///< "process", "run"
    std::string version;
    std::string name;
    std::optional<std::uint64_t> seed;
    LoadedDataset data;
    std::shared_ptr<const scenario::SimulatedSky>
        sky;  ///< of a simulated receiver, for use in intermediate and deep coupling runs; or null
    std::vector<scenario::ReceiverRow> receiver_rows;  ///< status of its channels
    fusion::Result result;
    HiddenTruth truth;  ///< of simulated data
    Evaluation evaluation;
    settings::Published published;  ///< for the scenario, to compare with
    std::string config_toml;        ///< every setting as used
    std::vector<Fact> facts;        ///< origin of each setting of the data
    std::vector<Ignored> ignored;   ///< settings that were given but had no effect
    std::vector<std::string> warnings;
    std::optional<SelfCheck> self_check;  ///< of `process`
    SolutionVerdict verdict;
    Timing timing;

    [[nodiscard]] bool smoothed() const { return !result.smoothed.rows.empty(); }
    /// The solution is the motion of the antenna instead of that of the IMU.
    [[nodiscard]] bool at_antenna() const {
        return data.config.scheme == settings::Scheme::Gnss || data.config.filter.output_at_antenna;
    }
    [[nodiscard]] const fusion::Trajectory& solution() const { return smoothed() ? result.smoothed : result.forward; }
    /// The reference of the point whose motion the solution is; of the IMU where its attitude does not show that of the antenna.
    [[nodiscard]] const std::vector<ReferenceSample>& reference() const {
        return evaluation.at_antenna.empty() ? data.recording.reference : evaluation.at_antenna;
    }
    [[nodiscard]] double relative(Time t) const { return (t - data.origin).seconds(); }
};

}  // namespace schuler::solution
