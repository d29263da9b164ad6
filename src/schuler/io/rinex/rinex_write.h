// Raw measurements and ephemerides as RINEX 3.04 text.
#pragma once

#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"

#include <filesystem>
#include <string>

namespace schuler::io {

/// Observation file [RINEX304:A2, A3]: mixed systems, GPS time, code, phase, Doppler and C/N0 of each available signal.
[[nodiscard]] std::string rinex_observations_text(const gnss::ObservationLog& log);

/// Navigation file [RINEX304:A5 to A16]: mixed systems, in order of time.
[[nodiscard]] std::string rinex_navigation_text(const gnss::Navigation& navigation);

}  // namespace schuler::io
