// Implementation of Navigator, independent of the mechanization frame.
#pragma once

#include "schuler/filter/navigator_settings.h"
#include "schuler/filter/stream/start_up.h"
#include "schuler/filter/stream/stream_timeline.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace schuler::filter::detail {

class Archive;

/// The most recent elements up to a fixed number, oldest first.
template <class T>
class Ring {
public:
    explicit Ring(std::size_t capacity) { memory.all.resize(capacity); }
    /// True if the oldest element was overwritten.
    bool push(const T& x) {
        const std::size_t n = memory.all.size();
        const bool full = memory.count == n;
        memory.all[(memory.first + memory.count) % n] = x;
        if (full) memory.first = (memory.first + 1) % n;
        else ++memory.count;
        return full;
    }
    std::optional<T> pop() {
        if (memory.count == 0) return std::nullopt;
        const T x = memory.all[memory.first];
        memory.first = (memory.first + 1) % memory.all.size();
        --memory.count;
        return x;
    }
    struct Memory {
        std::vector<T> all;
        std::size_t first = 0, count = 0;
    };
    Memory memory;
};

class NavigatorEngine {
public:
    explicit NavigatorEngine(const NavigatorSettings& settings);
    virtual ~NavigatorEngine() = default;
    NavigatorEngine(const NavigatorEngine&) = delete;
    NavigatorEngine& operator=(const NavigatorEngine&) = delete;

    FeedStatus feed(const ImuSample& sample);
    template <class Sample>
    FeedStatus feed(Source source, const Sample& sample) {
        return told(source, sample.time, stream.feed(sample));
    }
    FeedStatus feed(Time time, std::span<const RangeSample> samples) {
        return told(Source::Ranges, time, stream.feed(time, samples));
    }

    [[nodiscard]] virtual std::optional<NavigatorState> state() = 0;
    [[nodiscard]] virtual std::optional<NavigatorState> lagged() const = 0;
    [[nodiscard]] virtual std::optional<SensorErrorRow> sensor_errors() const = 0;
    [[nodiscard]] virtual const InertialModel& model() const = 0;

    std::size_t save(std::span<std::byte> bytes) const;
    RestoreStatus restore(std::span<const std::byte> bytes);
    void restart();

    NavigatorSettings settings;
    StreamTimeline stream;
    StartUp start_up;
    Phase phase = Phase::WaitingForImu;
    Ring<NavigatorEvent> events{256};
    Ring<SolutionRow> rows{512};

protected:
    void tell(NavigatorEvent event);
    void add_row(const SolutionRow& row);
    [[nodiscard]] bool running() const { return phase == Phase::Navigating; }

private:
    FeedStatus told(Source source, Time time, FeedStatus status);
    void enter(Phase next, Time time);
    /// Advances the alignment to the last settled sample, and starts navigation when the initial state is known.
    void align();
    bool align_as_given();
    bool align_by_samples();
    [[nodiscard]] double baro_height_at(Time time) const;
    [[nodiscard]] std::uint64_t fingerprint() const;
    void archive_all(Archive& a);
    /// Processes the samples that are old enough. False if the filter has diverged.
    virtual bool advance() = 0;
    /// Initialises the run at a start whose `increment` is its first in the data.
    virtual void set_out(const Start& start, double baro_height) = 0;
    virtual void archive_run(Archive& a) = 0;

    bool given_ = false;              // a given start is still pending
    double baro_height_ = not_given;  // m, the last before the start
};

/// The instruments that are fed and therefore have states.
[[nodiscard]] Sensors instruments_of(const FeedRates& rates);

/// The settings must have been checked; none are rejected here.
[[nodiscard]] std::unique_ptr<NavigatorEngine> make_engine(const NavigatorSettings& settings);

}  // namespace schuler::filter::detail
