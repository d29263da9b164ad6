// What inspection finds wrong with the IMU log of a data set.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"

#include <filesystem>
#include <vector>

namespace schuler::dataset {

/// Throws Error(Input) with what inspection finds wrong with the IMU log, where it finds something and the description does not
/// scale its columns already.
void diagnose_imu_log(const std::filesystem::path& folder, const Description& description);

/// The accelerometers must show gravity: a wrong unit is reported before a filter uses it. @throws Error(Input)
void check_gravity_shows(const std::vector<ImuSample>& imu, ImuKind kind, const std::filesystem::path& folder,
                         const Description& description);

}  // namespace schuler::dataset
