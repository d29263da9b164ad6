// Facts stated in the files of a data set or found from them, in addition to given settings.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/inspect/inspect.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::dataset {

/// Data required by a command. Attitude: an IMU log; a magnetometer is used even if disturbed. ImuAndStart: an IMU log, the start
/// is given; fixes or raw measurements are used if present. Satellites: raw measurements of a receiver.
enum class Needs { Imu, Attitude, ImuAndStart, ImuAndGnss, Satellites };

/// A folder or file whose content was examined.
struct Recognised {
    inspect::InspectReport report;
    std::vector<Fact> facts;          ///< settings that are not given, as stated or shown by the files
    std::vector<std::string> doubts;  ///< problems of the recognised files, and how they were interpreted
    std::string dataset_toml;         ///< the dataset.toml that states the facts, for logs that were searched for
};

/// Raw satellite measurements, if they are the only ones in the folder (or the file): with an IMU log, which is then analysed with
/// their single-epoch fixes, or alone.
void add_raw_observations(const std::filesystem::path& path, const inspect::Given& given, inspect::InspectReport& report);

/// Examines the files of a data set that is partly or not at all described. If no log is named, IMU and GNSS logs are searched
/// for; if only satellite data are named, an IMU log. @throws Error(Input) if the data required by `needs` are then missing, with
/// the most informative finding about a candidate file. Named but missing files are reported when loaded.
[[nodiscard]] Recognised recognise(const std::filesystem::path& path, Needs needs, const inspect::Given& given);

}  // namespace schuler::dataset
