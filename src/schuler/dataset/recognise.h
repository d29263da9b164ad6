// What the files of a data set state and show by themselves, beside what is given.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/inspect/inspect.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::dataset {

/// What a command cannot do without. Attitude: an IMU log, and a magnetometer is used whatever disturbs it. ImuAndStart: an IMU log, the start is
/// given; fixes or raw measurements are used where there are some. Satellites: raw measurements of a receiver.
enum class Needs { Imu, Attitude, ImuAndStart, ImuAndGnss, Satellites };

/// A folder or file whose content was looked at.
struct Recognised {
    inspect::InspectReport report;
    std::vector<Fact> facts;          ///< the settings that are not given, as the files state or show them
    std::vector<std::string> doubts;  ///< what is wrong with the files that were recognised, and how it was taken
    std::string dataset_toml;         ///< the dataset.toml that states the facts; for logs that were looked for
};

/// Raw measurements of satellites, where they are the only ones in the folder (or the file): beside an IMU's log, or alone.
void add_raw_observations(const std::filesystem::path& path, const inspect::Given& given, inspect::InspectReport& report);

/// Looks at the files of a data set about which something or nothing is given. Where no log is named, the IMU and GNSS logs are looked
/// for; where only one of satellites is, the IMU's. @throws Error(Input) where what `needs` asks for is then not there, with the most telling thing known about a file that might
/// have been it. What is named and is not there is left to who loads it.
[[nodiscard]] Recognised recognise(const std::filesystem::path& path, Needs needs, const inspect::Given& given);

}  // namespace schuler::dataset
