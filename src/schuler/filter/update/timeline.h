// Input of a filter run: increments without gaps, measurements in order of validity, standstill windows.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/integrity/gate.h"
#include "schuler/filter/result.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace schuler::filter {

/// A segment of increments interpolated across a gap in the log.
struct Bridge {
    std::size_t first, last;  ///< indices of increments, inclusive
    BridgeNoise noise;
};

/// The IMU as body increments on a gapless axis.
struct ImuTimeline {
    std::vector<ImuIncrement> increments;
    std::vector<Bridge> bridges;  ///< in order
    double median_dt = 0.0;       ///< s
    std::size_t gaps = 0;
    std::size_t duplicates = 0;
    std::size_t doubtful = 0;  ///< half seconds of suspect data among the bridges whose values were kept
};

/// One measurement of the timeline. Components of a fix with different ages are separate events.
struct Event {
    Time valid;  ///< when the measured quantity was valid
    Time stamp;  ///< in the log
    MeasurementKind kind;
    std::uint8_t components = 7;        ///< bits: 1 north, 2 east, 4 down
    bool withheld = false;              ///< inside an outage: compared, not used
    int outage = -1;                    ///< the outage whose table contains this epoch
    bool outage_end = false;            ///< first epoch at or after the end of that outage
    bool constellation_change = false;  ///< GNSS: the first fix with a different set of satellites
    std::size_t index = 0;              ///< into the channel of the recording
};

/// One standstill window: the mean raw rate over it (rad/s, body), for the zero-rate update.
struct StillWindow {
    Time end;
    double length;  ///< s
    Eigen::Vector3d mean_rate_b;
    Eigen::Vector3d mean_force_b;  ///< m/s^2
};

/// Origin of the thresholds.
struct StillThresholds {
    bool learnt = false;     ///< from GNSS speeds; otherwise from the noise of the IMU
    double force_std = 0.0;  ///< m/s^2, standard deviation in a window
    double rate_std = 0.0;   ///< rad/s
};

struct StillReport {
    std::vector<StillWindow> windows;  ///< non-overlapping, 0.2 s apart
    StillThresholds thresholds;
};

/// Standard deviations of each fix: the log's or the defaults; determined once, so that replays agree.
struct FixNoise {
    Eigen::Vector3d position;        ///< m, NED
    Eigen::Vector3d velocity;        ///< m/s, NED
    Eigen::Vector3d white_position;  ///< m, NED: the remainder if the slow part is a state
    Eigen::Vector3d white_velocity;  ///< m/s, NED
};

/// Data shared by all passes of a run; read only.
struct RunData {
    const Recording* recording = nullptr;
    ImuTimeline imu;
    std::vector<Event> events;
    StillReport still;
    std::vector<FixNoise> fix_noise;  ///< one per fix of the recording
    double declination = 0.0;         ///< rad
    GateLimits gates;
    std::array<double, 4> slow_limits{};  ///< of the slow-ramp test by degrees of freedom
    Time origin{};                        ///< zero of the outage times
    std::vector<Time> instants;           ///< in order: the run stops there for PassObserver::instant
    bool backward = false;  ///< time runs backward (filter/update/reversed.h): an instant precedes the measurements of its time
};

}  // namespace schuler::filter
