// The messages of RTCM 3 streams. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"

#include <optional>
#include <string_view>
#include <vector>

namespace schuler::io::detail {

enum class Decoded { Used, Foreign, Damaged };

/// Ephemeris of a message, added if new. `now` is within half a week.
[[nodiscard]] Decoded rtcm3_ephemeris(std::string_view payload, int number, Time now, gnss::Navigation& navigation);

/// Date information in an ephemeris.
struct MessageDate {
    Time reference;  ///< of its clock, in the last week of that count not after a given instant
    int wrap = 0;    ///< number of weeks after which the count restarts
};
/// Empty for messages without a week count.
[[nodiscard]] std::optional<MessageDate> rtcm3_date(std::string_view payload, int number, Time latest);

/// Measurements of one multiple-signal message, and their instant.
struct MsmEpoch {
    Time time;
    bool more = false;  ///< further messages of the same instant follow
    std::vector<gnss::SignalObservation> observations;
    std::vector<int> locks;  ///< lock time indicator of each, which increases while the phase is continuous
};
/// True if a message number is one of MSM4 to MSM7 of a known system.
[[nodiscard]] bool is_msm(int number);
[[nodiscard]] Decoded rtcm3_msm(std::string_view payload, int number, Time now, gnss::GlonassChannels& channels, MsmEpoch& out);

}  // namespace schuler::io::detail
