// From a recording to what the filter walks along: body increments without holes, and measurements in order of validity.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

#include <cstdint>
#include <vector>

namespace schuler::fusion {

/// A stretch of increments that were interpolated because the log has a hole there.
struct Bridge {
    std::size_t first, last;     ///< indices of increments, inclusive
    BridgeNoise noise;
};

/// The IMU as body increments on a gapless axis.
struct ImuTimeline {
    std::vector<ImuIncrement> increments;
    std::vector<Bridge> bridges;         ///< in order
    double median_dt = 0.0;              ///< s
    std::size_t gaps = 0;
    std::size_t duplicates = 0;
};

/// Makes increments (over (time - dt, time], body axes) from an IMU log: units, stamps, axes, mounting; duplicates dropped; holes
/// bridged by interpolation and marked. Throws Error(Input) on fewer than two usable rows.
[[nodiscard]] ImuTimeline make_imu_timeline(const std::vector<ImuSample>& samples, const ImuSettings& settings,
                                            WarningLog& warnings);

/// One measurement of the timeline. Components of a fix with different ages are separate events.
struct Event {
    Time valid;                  ///< when the measured quantity was true
    Time stamp;                  ///< in the log
    AidKind kind;
    std::uint8_t components = 7; ///< bits: 1 north, 2 east, 4 down
    bool withheld = false;       ///< inside an outage: compared, not used
    int outage = -1;             ///< the outage whose table this epoch belongs to
    bool outage_end = false;     ///< first epoch at or after the end of that outage
    bool constellation_change = false;   ///< GNSS: the first fix with another set of satellites
    std::size_t index = 0;       ///< into the channel of the recording
};

/// GNSS, barometer and magnetometer epochs in order of validity, duplicates dropped, latencies applied, outages marked.
/// origin: zero of the outages' times (stamp of the first GNSS epoch).
[[nodiscard]] std::vector<Event> make_events(const Recording& recording, const Settings& settings, Time origin,
                                             WarningLog& warnings);

}  // namespace schuler::fusion
