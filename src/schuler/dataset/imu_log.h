// Errors found by inspection in the IMU log of a data set.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"

#include <filesystem>
#include <vector>

namespace schuler::dataset {

/// Throws Error(Input) with the errors found by inspection in the IMU log, if there are any and the description does not already
/// scale its columns.
void diagnose_imu_log(const std::filesystem::path& folder, const Description& description);

/// The accelerometers must measure gravity: a wrong unit is reported before a filter uses it. @throws Error(Input)
void check_gravity_shows(const std::vector<ImuSample>& imu, ImuKind kind, const std::filesystem::path& folder,
                         const Description& description);

}  // namespace schuler::dataset
