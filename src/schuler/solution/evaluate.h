// How good a run was: errors against a reference, outages, consistency of the filter with itself.
#pragma once

#include "schuler/analysis/consistency.h"
#include "schuler/analysis/errors.h"
#include "schuler/analysis/outages.h"
#include "schuler/analysis/separation.h"
#include "schuler/fusion/result.h"
#include "schuler/solution/loaded_dataset.h"
#include "schuler/solution/state_errors.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::solution {

/// Numbers of one aid: "gnss_position", "baro", ...
struct AidConsistency {
    std::string_view name;
    analysis::NisStatistics nis;
};

struct Evaluation {
    std::string reference;                           ///< "truth", "file", "gnss" or empty
    Time settled;                                    ///< errors are counted from here
    std::vector<analysis::ErrorRow> errors;          ///< of the solution (smoothed where there is one)
    std::vector<analysis::ErrorRow> errors_forward;  ///< of the filter, where smoothed
    analysis::ErrorSummary summary;
    std::optional<analysis::ErrorSummary> forward;
    std::optional<analysis::ConsistencySummary> consistency;
    std::vector<AidConsistency> aids;
    std::vector<analysis::OutageStatistics> outages;          ///< of the solution
    std::vector<analysis::OutageStatistics> outages_forward;  ///< of the filter, where smoothed
    std::optional<Eigen::Vector3d> gyro_bias_error;           ///< estimate minus truth at the end, rad/s (simulated data)
    std::optional<Eigen::Vector3d> accel_bias_error;          ///< m/s^2
    std::vector<analysis::SeparationRow> separation;          ///< forward minus backward filter, where requested
    analysis::SeparationSummary separated;                    ///< of it, without the settling of both
    std::vector<StateErrors> states;                          ///< of the filter, once a second (simulated data)
};

/// Judges a result by the reference of the data set, or by withheld GNSS in outages where there is none.
/// `truth`: of simulated data, empty otherwise.
[[nodiscard]] Evaluation evaluate(const LoadedDataset& data, const fusion::Result& result, const HiddenTruth& truth);

/// Errors of one trajectory against another: no filter known. `settle`: s after the first common epoch.
[[nodiscard]] Evaluation compare(const earth::Earth& earth, const std::vector<SolutionRow>& rows,
                                 const std::vector<ReferenceSample>& reference, double settle);

}  // namespace schuler::solution
