// The messages of RTCM 3 streams. Private to the readers.
#pragma once

#include "schuler/gnss/ephemeris.h"
#include "schuler/gnss/observation.h"
#include "schuler/io/detail/bits.h"

#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::io::detail {

enum class Decoded { Used, Foreign, Damaged };

inline constexpr double metres_per_ms = gnss::speed_of_light * 1e-3;

/// A signed field as a whole number; NaN for the most negative value, which means that there is none.
[[nodiscard]] inline double field_or_none(Bits& bits, std::size_t size) {
    const std::int64_t raw = bits.take_signed(size);
    return raw == -(std::int64_t{1} << (size - 1)) ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(raw);
}

/// Ephemeris of a message, added if new. `now` is within half a week.
[[nodiscard]] Decoded rtcm3_ephemeris(std::string_view payload, int number, Time now, gnss::Navigation& navigation);

/// Date information in an ephemeris.
struct MessageDate {
    Time reference;  ///< of its clock, in the last week of that count not after a given instant
    int wrap = 0;    ///< number of weeks after which the count restarts
};
/// Empty for messages without a week count.
[[nodiscard]] std::optional<MessageDate> rtcm3_date(std::string_view payload, int number, Time latest);

/// Measurements of one message, and their instant.
struct MeasuredEpoch {
    Time time;
    bool more = false;  ///< further messages of the same instant follow
    std::vector<gnss::SignalObservation> observations;
    std::vector<int> locks;  ///< lock time indicator of each, which increases while the phase is continuous
};
/// True if a message number is one of MSM4 to MSM7 of a known system.
[[nodiscard]] bool is_msm(int number);
[[nodiscard]] Decoded rtcm3_msm(std::string_view payload, int number, Time now, gnss::GlonassChannels& channels,
                                MeasuredEpoch& out);

/// Messages 1001 to 1004 (GPS, SBAS) and 1009 to 1012 (GLONASS), which preceded multiple-signal messages [RTCM10403:3.5.1, 3.5.5]. Those
/// with odd numbers give pseudoranges only modulo a millisecond of light, and are foreign.
class LegacyObservations {
public:
    [[nodiscard]] static bool holds(int number) { return (number > 1000 && number < 1005) || (number > 1008 && number < 1013); }
    [[nodiscard]] Decoded read(std::string_view payload, int number, Time now, gnss::GlonassChannels& channels,
                               MeasuredEpoch& out);

private:
    double continued(gnss::SatelliteId satellite, gnss::Signal signal, double cycles);

    std::map<std::pair<gnss::SatelliteId, gnss::Signal>, double> cycles_;  ///< phase minus code of the last message
};

/// Station messages 1005 and 1006 (reference point of the antenna), 1007, 1008 and 1033 (its type) [RTCM10403:3.5.2, 3.5.3, 3.5.14].
[[nodiscard]] Decoded rtcm3_station(std::string_view payload, int number, gnss::ObservationLog& log);

}  // namespace schuler::io::detail
