// The given lever arm, tested against the fixes once the vehicle has turned.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/loaded_dataset.h"

#include <optional>
#include <string>

namespace schuler::solution {

/// Three sigma and more between a given lever arm and the log.
struct LeverArmDoubt {
    Eigen::Vector3d given_b = Eigen::Vector3d::Zero(), found_b = Eigen::Vector3d::Zero();  ///< m, forward-right-down
    Eigen::Vector3d std_b = Eigen::Vector3d::Zero();                                       ///< m, of what was found
    bool refuted = false;       ///< beyond doubt: what was found is used
    fusion::Settings settings;  ///< with which to repeat the run: the lever arm is a state
    [[nodiscard]] std::string text() const;
};

/// Walks the log once more with the lever arm as a state, and once more from where that ended if it moved far. Nothing where no lever arm is given, where it is a
/// state already, where the log agrees or does not observe it, or with filter.self_check off.
[[nodiscard]] std::optional<LeverArmDoubt> doubt_of_lever_arm(const LoadedDataset& data, const fusion::Result& result);

}  // namespace schuler::solution
