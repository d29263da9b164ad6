// One file of raw measurements or ephemerides, in any format.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/core/time.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace schuler::io {

enum class RawFormat { None, RinexObservations, RinexNavigation, Ubx, Rtcm3, Novatel };

/// By the first bytes. Never throws on content.
[[nodiscard]] RawFormat raw_format(const std::filesystem::path& file);

struct RawInput {
    gnss::ObservationLog observations;  ///< empty if the file has none
    gnss::Navigation navigation;
    std::vector<GnssFix> fixes;  ///< the receiver's own (UBX)
};

/// Reads RINEX observations or navigation, UBX, RTCM 3 or NovAtel logs, recognised by content. `near` is for RTCM 3 without
/// ephemerides, whose measurements have no date: less than half a week from its start; not given: the modification time of the file.
/// @throws Error(Input): none of these, or too damaged to use.
[[nodiscard]] RawInput read_raw_input(const std::filesystem::path& file, std::optional<Time> near, WarningLog& warnings);

}  // namespace schuler::io
