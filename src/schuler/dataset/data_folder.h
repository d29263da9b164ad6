// The data files that are installed with the program, and the date of a data set.
#pragma once

#include "schuler/core/time.h"
#include "schuler/dataset/description.h"

#include <filesystem>

namespace schuler::dataset {

/// Folder with the magnetic model: $SCHULER_DATA_DIR, else relative to the program as installed or built. Empty if there is none.
[[nodiscard]] std::filesystem::path magnetic_model_folder();

/// Decimal year of a stamp on the data set's own axis; NaN if neither it nor the settings give the date.
[[nodiscard]] double decimal_year_of(const TimeConfig& time, Time stamp);

}  // namespace schuler::dataset
