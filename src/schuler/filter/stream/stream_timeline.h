// The timeline of a run while it is made: samples in any order within a lag go in, increments, measurements and windows of standing
// still come out in order, in memory of fixed size.
#pragma once

#include "schuler/filter/detail/sample_pool.h"
#include "schuler/filter/navigator_settings.h"
#include "schuler/filter/stream/event_maker.h"
#include "schuler/filter/stream/imu_intervals.h"
#include "schuler/filter/stream/still_slots.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

namespace schuler::filter {

/// Samples within `lag` of the newest sample of the IMU wait; older ones are settled, one sample of the IMU after the other with the
/// measurements that are valid by then. What comes out does not depend on the order in which samples came.
class StreamTimeline {
public:
    static constexpr double most_ahead = 5.0;            ///< s that a measurement may be ahead of the IMU
    static constexpr std::size_t idle_increments = 256;  ///< consumed ones that are kept until they are moved out

    /// Settings are kept by reference. Takes all memory.
    explicit StreamTimeline(const NavigatorSettings& settings);
    StreamTimeline(const StreamTimeline&) = delete;
    StreamTimeline& operator=(const StreamTimeline&) = delete;

    FeedStatus feed(const ImuSample& sample);
    FeedStatus feed(const GnssFix& fix);
    FeedStatus feed(const BaroSample& sample);
    FeedStatus feed(const MagSample& sample);
    FeedStatus feed(const OdometerSample& sample);
    FeedStatus feed(const HeadingSample& sample);
    FeedStatus feed(const GaugeSample& sample);
    FeedStatus feed(const BodyVelocitySample& sample);
    FeedStatus feed(Time time, std::span<const RangeSample> samples);
    /// Index of a source of ranges, which is added; nothing where there is no room.
    std::optional<std::uint16_t> range_source(std::string_view name, bool station);

    /// Settles the oldest sample of the IMU that waits, if its time has come: appends its increments to data().imu and all
    /// measurements that are valid before their end to data().events. False where none is due.
    bool settle();
    /// Decides on standing still up to a time that the run is about to reach.
    void judge_still(Time until);

    /// Places of a run in the data.
    struct Places {
        std::size_t increment = 0, event = 0, epoch = 0, still = 0, bridge = 0;
    };
    /// Forgets what is before these places, and returns by how much the data begin later now. All: with the increments; otherwise these
    /// are kept until it is worth while.
    Places forget(Places places, bool all);

    /// `take(ImuIncrement, BridgeNoise)` for the increments from index `from` on, and for those of the samples that wait.
    template <class Take>
    void ahead(std::size_t from, Take&& take) const;

    [[nodiscard]] const RunData& data() const { return data_; }
    /// Newest sample of the IMU.
    [[nodiscard]] std::optional<Time> now() const { return memory.any_imu ? std::optional<Time>(memory.newest) : std::nullopt; }
    /// End of the last increment that was settled.
    [[nodiscard]] Time settled() const { return interval_.memory.end; }
    [[nodiscard]] bool any_increment() const { return interval_.memory.begun; }
    /// Whether samples of the IMU were refused that go on by themselves on another axis of time.
    [[nodiscard]] bool is_elsewhere() const { return memory.strangers >= needed_strangers; }
    /// Whether the order of the samples that wait changed since this was asked last.
    bool reordered();
    /// Seconds of the hole in the last sample that was settled, 0: there was none.
    [[nodiscard]] double hole() const { return hole_; }
    [[nodiscard]] bool hangs() const { return hangs_; }
    /// As if nothing had been fed.
    void clear();

    FeedCounters counters;

    /// What it remembers beside its data.
    struct Memory {
        bool any_imu = false;
        Time newest{};
        Time last_settled{INT64_MIN};             ///< stamp of the IMU sample
        std::array<Time, source_count> released;  ///< stamp of the last one of each channel
        Time stranger{};
        int strangers = 0;  ///< refused samples of the IMU in a row that follow each other
        bool has_before = false;
        ImuIncrement before{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};  ///< last interval
        Time slots_start{};
        std::size_t first_slot = 0, current_slot = 0, next_judged = 0;  ///< counted from the first increment
        bool moved = false;
        bool has_precise = false;  ///< position of a precise fix without velocity
        Geodetic precise{};
        Time precise_time{};
        bool order_changed = false;
    };
    Memory memory;

    /// Everything that a copy of the stream needs: `archive(...)` is called with the parts.
    template <class Archive>
    void archive(Archive& a);

private:
    static constexpr int needed_strangers = 20;

    /// What measures one thing, true at its stamps: who it is, and its samples that wait.
    template <class Sample>
    struct Instrument {
        Source source;
        AidKind kind;
        std::uint8_t components;
        double FeedRates::*rate;
        std::vector<Sample> Recording::*store;
        detail::SamplePool<Sample> pool;
    };
    template <class Sample>
    static Instrument<Sample> instrument(const NavigatorSettings& s, Source source, AidKind kind, std::uint8_t components,
                                         double FeedRates::*rate, std::vector<Sample> Recording::*store);

    FeedStatus count(Source source, FeedStatus status);
    [[nodiscard]] FeedStatus check_time(Time valid) const;
    template <class Sample>
    FeedStatus take(const Sample& sample, bool used, bool bad);
    template <class Sample>
    FeedStatus feed(Source source, const Sample& sample, Time valid, detail::SamplePool<Sample>& pool,
                    std::vector<Sample>& store);
    void add_increment(const ImuIncrement& increment, bool interpolated);
    void bridge(const ImuIncrement& interval);
    void release(Time until);
    template <class Sample>
    void release(Time until, Instrument<Sample>& instrument);
    /// `visit(Instrument&)` for each of them, in the order in which their measurements of one time are used.
    template <class Visit>
    void each_instrument(Visit&& visit) {
        std::apply([&](auto&... instrument) { (visit(instrument), ...); }, instruments_);
    }
    void insert(const Event& event);
    void let_go(const Event& event);
    void add_speeds(const GnssFix& fix, const Event& event);
    void add_speed(Time time, double speed);
    StillSlot* slot(std::size_t number);

    const NavigatorSettings& settings_;
    StillThresholds thresholds_;
    Duration lag_, longest_hole_;
    double largest_rate_;
    RunData data_;
    Recording recording_;  // samples at the indices of the pools
    std::vector<ImuSample> imu_store_;
    detail::SamplePool<ImuSample> imu_;
    detail::SamplePool<GnssFix> gnss_;
    std::tuple<Instrument<BaroSample>, Instrument<MagSample>, Instrument<OdometerSample>, Instrument<HeadingSample>,
               Instrument<GaugeSample>, Instrument<BodyVelocitySample>>
        instruments_;
    std::vector<std::uint32_t> free_ranges_;  // runs of samples in the log of ranges
    IntervalMaker interval_;
    HangWatch hang_;
    RecentMotion motion_;
    EventMaker events_;
    std::vector<StillSlot> slots_;
    double hole_ = 0.0;
    bool hangs_ = false;
};

template <class Take>
void StreamTimeline::ahead(std::size_t from, Take&& take) const {
    std::size_t bridge = 0;
    const std::vector<Bridge>& bridges = data_.imu.bridges;
    for (std::size_t i = from; i < data_.imu.increments.size(); ++i) {
        while (bridge < bridges.size() && bridges[bridge].last < i) ++bridge;
        take(data_.imu.increments[i],
             bridge < bridges.size() && bridges[bridge].first <= i ? bridges[bridge].noise : BridgeNoise{});
    }
    IntervalMaker maker = interval_;
    HangWatch hang = hang_;
    ImuIncrement before = memory.before;
    bool has_before = memory.has_before;
    const bool needs_next = settings_.filter.imu.stamp != ImuStamp::End;
    for (std::size_t k = 0; k < imu_.waiting(); ++k) {
        if (needs_next && k + 1 == imu_.waiting()) break;
        const ImuSample& sample = imu_store_[imu_.index(k)];
        const auto next = k + 1 < imu_.waiting() ? std::optional<Time>(imu_store_[imu_.index(k + 1)].time) : std::nullopt;
        if (hang.hangs(sample)) continue;
        const std::optional<ImuIncrement> interval = maker.add(sample, next);
        if (!interval) continue;
        if (has_before && is_hole(interval->dt, settings_.imu_interval, settings_.filter.imu)) {
            const BridgeNoise noise = bridge_noise(interval->dt, motion_.recent(), motion_.usual());
            fill_hole(before, *interval, settings_.imu_interval,
                      [&](const ImuIncrement& piece, bool interpolated) { take(piece, interpolated ? noise : BridgeNoise{}); });
        } else {
            take(*interval, BridgeNoise{});
        }
        before = *interval;
        has_before = true;
    }
}

template <class Archive>
void StreamTimeline::archive(Archive& a) {
    a(counters, memory, data_.imu.increments, data_.imu.bridges, data_.events, data_.still.windows, data_.fix_noise);
    a(recording_.gnss, imu_store_);
    a(recording_.ranges.sources, recording_.ranges.epochs, recording_.ranges.samples, free_ranges_);
    a(imu_, gnss_);
    each_instrument([&](auto& instrument) { a(recording_.*instrument.store, instrument.pool); });
    a(interval_.memory, hang_.memory, motion_.memory, events_.memory, slots_, hole_, hangs_);
}

}  // namespace schuler::filter
