// The data files that are installed with the program, and the date of a data set.
#pragma once

#include "schuler/app/dataset.h"

#include <filesystem>

namespace schuler::app {

/// Folder with the magnetic model: $SCHULER_DATA_DIR, else beside the program as installed or built. Empty where there is none.
[[nodiscard]] std::filesystem::path magnetic_model_folder();

/// Decimal year of the first IMU sample; NaN where neither the stamps nor the settings tell the date.
[[nodiscard]] double decimal_year_of(const LoadedDataset& data);

}  // namespace schuler::app
