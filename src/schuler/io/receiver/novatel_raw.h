// Raw measurements and ephemerides in logs of NovAtel receivers.
#pragma once

#include "schuler/core/log.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/text/text_input.h"

namespace schuler::io {

struct NovatelRaw {
    gnss::ObservationLog observations;  ///< of RANGE, else RANGECMP, of the first antenna
    gnss::Navigation navigation;        ///< of GPSEPHEM or RAWEPHEM, GLOEPHEMERIS, GALEPHEMERIS, BDSEPHEMERIS, IONUTC
};

/// Reads a log, ASCII or binary, in one pass [NovAtelOEM7]. Logs with a wrong checksum are skipped and reported with their byte
/// offset; if epoch times do not increase, the smallest number of epochs is omitted. @throws Error(Input): not readable.
[[nodiscard]] NovatelRaw read_novatel_raw(const TextInput& input, WarningLog& log);

/// True if the first bytes contain one of these logs. Never throws on content.
[[nodiscard]] bool is_novatel_raw(const TextInput& input);

}  // namespace schuler::io
