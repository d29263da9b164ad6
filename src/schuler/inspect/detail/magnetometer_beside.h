// The magnetometer in the table of an IMU: nine columns, as phones and most loggers write them.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"

#include <optional>

namespace schuler::inspect::detail {

/// The magnetometer in the columns that the IMU's table leaves unused; empty without all three.
[[nodiscard]] std::optional<LoadedFile> magnetometer_beside(const LoadedFile& imu);

}  // namespace schuler::inspect::detail
