// One file of raw measurements or ephemerides, whatever its format.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/time.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"

#include <filesystem>
#include <optional>

namespace schuler::app {

struct RawInput {
    gnss::ObservationLog observations;           ///< empty where the file has none
    gnss::Navigation navigation;
};

/// Reads RINEX observations or navigation, UBX or RTCM 3, recognised by content. RTCM 3 carries no date: `near` is an instant less
/// than half a week away from its start; not given: the time the file was last written.
/// @throws Error(Input): none of these, or damaged beyond use.
[[nodiscard]] RawInput read_raw_input(const std::filesystem::path& file, std::optional<Time> near, WarningLog& warnings);

}  // namespace schuler::app
