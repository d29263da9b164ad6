// Settings of a navigator, and its states and answers.
#pragma once

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

/// The instruments that feed a navigator.
enum class Source : std::uint8_t { Imu, Gnss, Baro, Mag, Odometer, Heading, Gauges, Log, Ranges };
inline constexpr std::size_t source_count = 9;

/// Most samples a second that are fed of each instrument; room is made for so many. 0: there is no such instrument.
struct FeedRates {
    double gnss = 20.0, baro = 0.0, mag = 0.0, odometer = 0.0, heading = 0.0, gauges = 0.0, log = 0.0, ranges = 0.0;  ///< Hz
    int gauge_count = 0;              ///< how many of GaugeSample::height there are, at most 3
    std::size_t range_sources = 128;  ///< satellites and stations that a run meets
};

struct NavigatorSettings {
    /// The settings of a batch run; what a batch finds by looking at the whole log (noise, latencies, mounting) is what they say.
    /// Outages and spans of time are a batch's.
    Settings filter;
    double imu_interval = 0.01;  ///< s, nominal, from sample to sample of the IMU
    FeedRates rates;
    /// A sample may come so much later than the newest sample of the IMU, counted from the time at which it was true, s.
    double lag = 0.5;
    /// Standing still is decided from a second around it. What is not known yet when a sample of the IMU has aged by `lag` is left out;
    /// with 0.65 s more the decision is that of a batch.
    double still_delay = 0.0;    ///< s
    double longest_hole = 10.0;  ///< s without samples of the IMU that are bridged; a longer one restarts
    StillThresholds still;       ///< as a batch has learnt them; zero: by the noise of the IMU, while fixes are slow
    std::optional<Start> start;  ///< where it starts (`increment` and `previous` are found); none: by alignment
};

/// What became of a sample.
enum class FeedStatus : std::uint8_t {
    Taken,
    Late,         ///< older than the lag allows
    Duplicate,    ///< a sample of this time is there
    BadValue,     ///< not finite, or not of this world: value, sigma, position or age
    TooFarAhead,  ///< later than the newest sample of the IMU by more than can be true
    Full,         ///< more than the stated rate
    NotUsed       ///< the settings have no use for this instrument
};
inline constexpr std::size_t feed_status_count = 7;

/// What the navigator is doing.
enum class Phase : std::uint8_t {
    WaitingForImu,
    WaitingForStart,     ///< the time of a given start has not come
    WaitingForPosition,  ///< no fix yet
    Levelling,
    Gyrocompassing,
    FindingHeading,  ///< until motion or a sensor shows it
    Navigating
};

/// Something that happened. What does not belong to its kind has its default.
struct NavigatorEvent {
    enum class Kind : std::uint8_t {
        Phase,         ///< `phase` has begun
        Refused,       ///< a sample of `source`: `status`
        Hole,          ///< of the IMU, `seconds` long, bridged
        Hang,          ///< the IMU repeats itself
        Aid,           ///< a measurement `aid` was not used: `aid_status`
        Alert,         ///< of the integrity monitor: `aid`, `test`
        Reconsidered,  ///< of two hypotheses about refused fixes, the navigation or the receiver wrong, the other one is accepted now
        Diverged,      ///< the computation lost its numbers: it restarts
        Restarted      ///< the axis of time went on elsewhere: it restarts
    };
    Time time{};
    Kind kind = Kind::Phase;
    filter::Phase phase = filter::Phase::WaitingForImu;
    Source source = Source::Imu;
    FeedStatus status = FeedStatus::Taken;
    AidKind aid = AidKind::GnssPosition;
    AidStatus aid_status = AidStatus::Accepted;
    IntegrityTest test = IntegrityTest::Tolerance;
    double seconds = 0.0;
};

/// What was fed so far.
struct FeedCounters {
    std::array<std::array<std::size_t, feed_status_count>, source_count> by_status{};  ///< [Source][FeedStatus]
    std::array<std::size_t, source_count> reordered{};                                 ///< taken, but behind later ones
    std::size_t holes = 0, restarts = 0;
    std::size_t events_lost = 0, rows_lost = 0;  ///< not fetched in time

    [[nodiscard]] std::size_t of(Source source, FeedStatus status) const {
        return by_status[static_cast<std::size_t>(source)][static_cast<std::size_t>(status)];
    }
};

/// Where the body is, with the covariance of the errors of position, velocity (north, east, down) and attitude: m, m/s, rad.
struct NavigatorState {
    NavState nav;
    Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
};

/// Why there is no navigator.
enum class MakeStatus : std::uint8_t { Made, BadSettings, TooManyStates, NotForStreams };

/// What a blob that is to be restored turned out to be.
enum class RestoreStatus : std::uint8_t { Restored, TooShort, Foreign, OtherVersion, Damaged, OtherSettings };

}  // namespace schuler::filter
