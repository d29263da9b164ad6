// Quality of a run: errors relative to a reference, outages, consistency of the filter with itself.
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

/// Statistics of one kind of measurement: "gnss_position", "baro", ...
struct MeasurementConsistency {
    std::string_view name;
    analysis::NisStatistics nis;
};

struct Evaluation {
    std::string reference;                           ///< "truth", "file", "gnss" or empty
    bool at_another_point = false;                   ///< its errors contain the lever arm, see warn_of_other_point
    std::vector<ReferenceSample> at_antenna;         ///< the reference there, if the solution is and the reference is not
    Time settled;                                    ///< errors are evaluated from here on
    std::vector<analysis::ErrorRow> errors;          ///< of the solution (smoothed if available)
    std::vector<analysis::ErrorRow> errors_forward;  ///< of the filter, if smoothed
    analysis::ErrorSummary summary;
    std::optional<analysis::ErrorSummary> forward;
    std::optional<analysis::ConsistencySummary> consistency;
    std::vector<MeasurementConsistency> measurements;
    std::vector<analysis::OutageStatistics> outages;          ///< of the solution
    std::vector<analysis::OutageStatistics> outages_forward;  ///< of the filter, if smoothed
    std::optional<Eigen::Vector3d> gyro_bias_error;           ///< estimate minus truth at the end, rad/s (simulated data)
    std::optional<Eigen::Vector3d> accel_bias_error;          ///< m/s^2
    std::vector<analysis::SeparationRow> separation;          ///< forward minus backward filter, where requested
    analysis::SeparationSummary separated;                    ///< its statistics, without the settling time of both
    std::vector<StateErrors> states;                          ///< of the solution, once per second (simulated data)
};

/// Evaluates a result against the reference of the data set, or against withheld GNSS in outages if there is none. A solution of the antenna
/// (scheme gnss) is compared with the reference at the antenna, where its attitude shows that.
/// `truth`: of simulated data, empty otherwise.
[[nodiscard]] Evaluation evaluate(const LoadedDataset& data, const fusion::Result& result, const HiddenTruth& truth);

/// Warns if the solution is the motion of the antenna and the reference that of the IMU, without the attitude that relates them.
void warn_of_other_point(const Evaluation& evaluation, WarningLog& warnings);

/// Errors of one trajectory relative to another, without a filter. `settle`: s after the first common epoch.
[[nodiscard]] Evaluation compare(const earth::Earth& earth, const std::vector<SolutionRow>& rows,
                                 const std::vector<ReferenceSample>& reference, double settle);

}  // namespace schuler::solution
