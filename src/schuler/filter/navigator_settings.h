// Settings, states and results of a navigator.
#pragma once

#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/result.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/model.h"
#include "schuler/filter/update/timeline.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace schuler::filter {

struct NavigatorSettings {
    /// The settings of a batch run; values that a batch estimates from the whole log (noise, latencies, mounting) are used as
    /// given. Outages and time spans apply to a batch only.
    Settings filter;
    double imu_interval = 0.01;  ///< s, nominal sample interval of the IMU
    FeedRates rates;
    /// Largest delay of a sample behind the newest IMU sample, counted from its time of validity, s.
    double lag = 0.5;
    /// Zero velocity is decided from one second around an instant. Data not available when an IMU sample is older than `lag` are
    /// not used; with 0.65 s of extra delay the decision equals that of a batch.
    double still_delay = 0.0;    ///< s
    double longest_hole = 10.0;  ///< s, longest gap in the IMU data that is bridged; a longer one causes a restart
    StillThresholds still;       ///< as learnt by a batch; zero: from the IMU noise while fixes are slow
    std::optional<Start> start;  ///< initial state (`increment` and `previous` are determined); none: by alignment
};

/// Outcome of feeding a sample.
enum class FeedStatus : std::uint8_t {
    Taken,
    Late,         ///< older than the lag permits
    Duplicate,    ///< a sample of this time already exists
    BadValue,     ///< not finite or implausible: value, sigma, position or age
    TooFarAhead,  ///< implausibly far ahead of the newest IMU sample
    Full,         ///< exceeds the stated rate
    NotUsed       ///< the settings do not use this instrument
};
inline constexpr std::size_t feed_status_count = 7;

/// The operating phase of the navigator.
enum class Phase : std::uint8_t {
    WaitingForImu,
    WaitingForStart,     ///< the time of a given start has not been reached
    WaitingForPosition,  ///< no fix yet
    Levelling,
    Gyrocompassing,
    FindingHeading,  ///< until determined by motion or a sensor
    Navigating
};

/// An event. Members that do not apply to its kind have their default.
struct NavigatorEvent {
    enum class Kind : std::uint8_t {
        Phase,         ///< `phase` has started
        Refused,       ///< a sample of `source` was rejected: `status`
        Hole,          ///< gap of `seconds` in the IMU data, bridged
        Hang,          ///< IMU data are frozen
        Measurement,   ///< a `measurement` was not used: `measurement_status`
        Alert,         ///< of the integrity monitor: `measurement`, `test`
        Reconsidered,  ///< of two hypotheses about refused fixes (navigation or receiver wrong), the alternative is now accepted
        Diverged,      ///< the computation produced invalid numbers: it restarts
        Restarted      ///< the time axis was discontinuous: it restarts
    };
    Time time{};
    Kind kind = Kind::Phase;
    filter::Phase phase = filter::Phase::WaitingForImu;
    Source source = Source::Imu;
    FeedStatus status = FeedStatus::Taken;
    MeasurementKind measurement = MeasurementKind::GnssPosition;
    MeasurementStatus measurement_status = MeasurementStatus::Accepted;
    IntegrityTest test = IntegrityTest::Tolerance;
    double seconds = 0.0;
};

/// Counts of the samples fed so far.
struct FeedCounters {
    std::array<std::array<std::size_t, feed_status_count>, source_count> by_status{};  ///< [Source][FeedStatus]
    std::array<std::size_t, source_count> reordered{};                                 ///< accepted, but out of order
    std::size_t holes = 0, restarts = 0;
    std::size_t events_lost = 0, rows_lost = 0;  ///< not fetched in time

    [[nodiscard]] std::size_t of(Source source, FeedStatus status) const {
        return by_status[static_cast<std::size_t>(source)][static_cast<std::size_t>(status)];
    }
};

/// Navigation state of the body, with the error covariance of position, velocity (north, east, down) and attitude: m, m/s, rad.
struct NavigatorState {
    NavState nav;
    Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
};

/// Reason why no navigator was created.
enum class MakeStatus : std::uint8_t { Made, BadSettings, TooManyStates, NotForStreams };

/// Result of restoring a saved state.
enum class RestoreStatus : std::uint8_t { Restored, TooShort, Foreign, OtherVersion, Damaged, OtherSettings };

}  // namespace schuler::filter
