// Further instruments in the table of an IMU: fixes of a receiver, and the magnetometer of nine columns, as phones and most loggers
// write them.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"

#include <optional>

namespace schuler::inspect::detail {

/// The fixes in the columns that the IMU's table leaves unused; empty without, and with a problem of `imu` where they come too fast for a
/// receiver.
[[nodiscard]] std::optional<LoadedFile> fixes_beside(LoadedFile& imu);

/// The magnetometer in those columns; empty without all three, or if they never change.
[[nodiscard]] std::optional<LoadedFile> magnetometer_beside(const LoadedFile& imu);

}  // namespace schuler::inspect::detail
