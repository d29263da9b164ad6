// What inspection finds wrong with the IMU log of a data set.
#pragma once

#include "schuler/dataset/description.h"

#include <filesystem>

namespace schuler::dataset {

/// Throws Error(Input) with what inspection finds wrong with the IMU log, where it does find something and the settings do not
/// scale its columns already.
void blame_the_imu_log(const std::filesystem::path& folder, const Description& description);

}  // namespace schuler::dataset
