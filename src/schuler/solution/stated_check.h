// Test of the lever arm, given or not, against the fixes after the vehicle has turned.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/loaded_dataset.h"

#include <optional>
#include <string>

namespace schuler::solution {

/// A discrepancy of five sigma or more between the lever arm and the log; or one of `unknown` size that matters.
struct LeverArmDoubt {
    Eigen::Vector3d given_b = Eigen::Vector3d::Zero(), found_b = Eigen::Vector3d::Zero();  ///< m, forward-right-down
    Eigen::Vector3d std_b = Eigen::Vector3d::Zero();                                       ///< m, of the estimated lever arm
    bool given = false;         ///< by the user; otherwise the antenna was taken to be at the unit
    bool refuted = false;       ///< beyond doubt: the estimated value is used
    bool told_only = false;     ///< tight coupling: the run is not repeated
    bool unknown = false;       ///< not given, and not shown by the log: the solution is that of the antenna
    fusion::Settings settings;  ///< for repeating the run with the lever arm as a state
    [[nodiscard]] std::string text() const;
};

/// Processes the log again with the lever arm as a state, and once more from the result if it moved far. Empty if it is already a
/// state, if the log agrees, if a given one is not observed (neither is it with an unknown heading), or with filter.self_check off.
/// In tight coupling with a base the fixes by carrier phase are processed in loose coupling for it, and the result is only reported:
/// the phases are too exact for the errors of second order of a lever arm as a state.
[[nodiscard]] std::optional<LeverArmDoubt> doubt_of_lever_arm(const LoadedDataset& data, const fusion::Result& result);

}  // namespace schuler::solution
