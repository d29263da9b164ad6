// A receiver of samples: repeatedly searches a recording for satellites and tracks those found.
#pragma once

#include "schuler/receiver/if_samples.h"
#include "schuler/receiver/tracker.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <span>
#include <vector>

namespace schuler::receiver {

struct SampleReceiverSettings {
    std::vector<int> satellites;    ///< GPS numbers to search for; empty: 1 to 32
    double doppler = 5000.0;        ///< Hz, half width of the search
    int search_periods = 10;        ///< code periods summed in a search
    double search_interval = 10.0;  ///< s between searches for satellites not being tracked
    TrackingSettings tracking;
};

/// Channel output after a symbol's duration, aligned to the message once its symbols are known.
struct ChannelSample {
    double time;  ///< s since the first sample, at the end of the symbol
    int prn;
    TrackState state;
    bool locked;                  ///< in phase
    double phase_lock;            ///< detector, near 1 when locked
    double cn0;                   ///< Hz
    double doppler;               ///< Hz
    double code_delay;            ///< chips, 0 to 1023: start of the code relative to the milliseconds of the recording
    double carrier_phase;         ///< cycles since the start of tracking, increasing with Doppler
    std::complex<double> prompt;  ///< coherent sum, noise of unit variance in I and in Q
};

/// Status of one satellite.
struct SatelliteRecord {
    static constexpr double never = std::numeric_limits<double>::quiet_NaN();

    int prn = 0;
    bool found = false;
    Acquired acquired{};                      ///< of the search that found it, otherwise of the best one
    double found_at = never;                  ///< s
    double locked_at = never;                 ///< s, first phase lock
    bool tracked = false;                     ///< at the end
    bool locked = false;                      ///< in phase at the end
    int losses = 0;                           ///< of all tracking
    long symbols = 0;                         ///< complete ones received in phase
    long changes = 0;                         ///< of sign between successive ones
    long dump_changes = 0, edge_changes = 0;  ///< of sign between successive code periods: all, and those at symbol boundaries

    /// Means over the last second (or available time) in phase; NaN without any.
    struct Means {
        double time = never, doppler = never, code_delay = never, cn0 = never;  ///< s, Hz, chips, Hz
    } last{};
};

/// Consumes samples in blocks and keeps some milliseconds of them. Dumps start with each satellite's code, so that symbols end
/// with a dump; the boundary moves with the code Doppler.
class SampleReceiver {
public:
    using Sink = std::function<void(const ChannelSample&)>;

    /// Throws Error(Input) that names the setting; satellites outside 1 to 32, or duplicates.
    SampleReceiver(const IfFormat& format, const SampleReceiverSettings& settings);

    /// Number of samples of a block that can be searched.
    [[nodiscard]] std::size_t piece() const { return acquisition_.samples_needed(); }
    /// The next samples: a search is made at the start of a block when due, then every channel advances to its last complete code
    /// period.
    void process(std::span<const IfSample> samples, const Sink& sink);
    [[nodiscard]] const std::vector<SatelliteRecord>& satellites() const { return records_; }

private:
    struct Channel {
        SatelliteRecord* record;
        SampleCorrelator correlator;
        Tracker tracker;
        double noise_ratio;  ///< noise in the band of the code over the noise of all samples
        std::uint64_t next;  ///< first sample of the next dump
        std::complex<double> sum = 0.0, before = 0.0;
        int dumps = 0, locked_dumps = 0;
        int symbol = 0;  ///< sign of the last complete one, 0 if none
        std::vector<ChannelSample> recent{};
    };

    void search(std::span<const IfSample> samples, std::uint64_t first);
    /// False if the channel has lost its signal.
    bool advance(Channel& channel, const Sink& sink);
    void dump(Channel& channel, const Correlators& c, const Sink& sink);

    IfFormat format_;
    SampleReceiverSettings settings_;
    FftAcquisition acquisition_;
    std::vector<SatelliteRecord> records_;
    std::list<Channel> channels_;
    std::vector<IfSample> window_;
    std::uint64_t base_ = 0;  ///< index of the window's first sample
    double noise_ = 0.0, next_search_ = 0.0;
};

}  // namespace schuler::receiver
