// RTCM 3 streams: measurements, ephemerides, and descriptions of the station.
#pragma once

#include "schuler/core/log.h"
#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/rinex/rinex.h"

namespace schuler::io {

struct Rtcm3Log {
    gnss::ObservationLog
        observations;  ///< of MSM4 to MSM7, 1002, 1004, 1010 and 1012; place of 1005 and 1006, antenna of 1007, 1008 and 1033
    gnss::Navigation navigation;  ///< of 1019, 1020, 1042, 1044, 1045, 1046
    RecordCounts records;         ///< messages; first_bad_line is a byte offset
};

/// Reads a stream [RTCM10403]. Measurements have no date. If there are ephemerides (1019, 1042, 1045, 1046) their weeks date the
/// stream, so that `near` may be any later instant (up to 19 years with GPS alone, 78 with Galileo); without them it must be less
/// than half a week from the first measurement, and the log reports the date used. Later times follow from the first. Other
/// messages are counted as foreign, bytes between frames are ignored; a frame with a wrong checksum is skipped and reported with
/// its byte offset. Messages of one instant form one epoch.
/// @throws Error(Input): no frame with a correct checksum, no usable frame.
[[nodiscard]] Rtcm3Log read_rtcm3(const TextInput& input, Time near, WarningLog& log);

/// True if the first bytes contain a frame with a correct checksum. Never throws on content.
[[nodiscard]] bool is_rtcm3(const TextInput& input);

}  // namespace schuler::io
