// Fixes from raw measurements: the files named by a data set, solved epoch by epoch.
#pragma once

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"
#include "schuler/gnss/observation.h"
#include "schuler/gnss/satellite_source.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace schuler::dataset {

/// The receiver's logs, one per file, and all satellite data.
struct RawLogs {
    gnss::Navigation navigation;
    std::vector<gnss::ObservationLog> logs;
};
/// @throws Error(Input): a file that cannot be read, no ephemerides.
[[nodiscard]] RawLogs read_raw_logs(const std::filesystem::path& folder, const RawGnssConfig& raw, WarningLog& warnings);

/// Satellite source from the settings: precise orbits if a file is named, else the broadcast ones. `antennas`: those of antennas_of(),
/// where they are read already.
[[nodiscard]] std::unique_ptr<gnss::SatelliteSource> satellites(const std::filesystem::path& folder, const RawGnssConfig& raw,
                                                                const gnss::Navigation& navigation, WarningLog& warnings,
                                                                const gnss::Antennas* antennas = nullptr);

/// The calibrations of gnss.antennas; none without it.
[[nodiscard]] gnss::Antennas antennas_of(const std::filesystem::path& folder, const RawGnssConfig& raw, WarningLog& warnings);

/// Warns if group delays are not known.
void warn_of_group_delays(const RawGnssConfig& raw, WarningLog& warnings);

/// Single-point fixes in GPS time since 1980 from the files of config.raw, with relative paths based on `folder`. Epochs without
/// a solution are counted in the log by their reason. @throws Error(Input): a file that cannot be read, no fix at all.
[[nodiscard]] std::vector<GnssFix> fixes_from_raw(const std::filesystem::path& folder, const RawGnssConfig& raw,
                                                  WarningLog& warnings);

/// Warns of satellites with ephemerides that a source does not use because they contradict each other.
void warn_of_contradictions(const gnss::Navigation& all, const gnss::Navigation& used, WarningLog& warnings);

/// Warns if broadcast coefficients are required but missing.
void warn_of_missing_ionosphere(const gnss::BroadcastIonosphere& ionosphere, const RawGnssConfig& raw, WarningLog& warnings);

/// A solved epoch as a fix.
[[nodiscard]] GnssFix fix_from(const gnss::SinglePointSolution& solution);

}  // namespace schuler::dataset
