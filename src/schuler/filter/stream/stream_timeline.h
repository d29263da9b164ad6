// The timeline of a run during its creation: accepts samples in any order within a lag and delivers increments, measurements and
// standstill windows in order, in memory of fixed size.
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

/// Samples within `lag` of the newest IMU sample are pending; older ones are settled, one IMU sample after the other with the
/// measurements valid by then. The output does not depend on the order in which samples arrive.
class StreamTimeline {
public:
    static constexpr double most_ahead = 5.0;            ///< s, largest lead of a measurement over the IMU
    static constexpr std::size_t idle_increments = 256;  ///< processed ones kept before they are discarded

    /// Settings are held by reference. Allocates all memory.
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
    /// Index of a range source, which is added if new; empty if there is no room.
    std::optional<std::uint16_t> range_source(std::string_view name, bool station);

    /// Settles the oldest pending IMU sample, if due: appends its increments to data().imu and all measurements valid before
    /// their end to data().events. False if none is due.
    bool settle();
    /// Decides on standstill up to a time that the run is about to reach.
    void judge_still(Time until);

    /// Positions of a run in the data.
    struct Places {
        std::size_t increment = 0, event = 0, epoch = 0, still = 0, bridge = 0;
    };
    /// Discards the data before these positions, and returns the shift of the data indices. All: including the increments;
    /// otherwise these are kept until discarding is worthwhile.
    Places forget(Places places, bool all);

    /// `take(ImuIncrement, BridgeNoise)` for the increments from index `from` on, and for those of the pending samples.
    template <class Take>
    void ahead(std::size_t from, Take&& take) const;

    [[nodiscard]] const RunData& data() const { return data_; }
    /// Newest sample of the IMU.
    [[nodiscard]] std::optional<Time> now() const { return memory.any_imu ? std::optional<Time>(memory.newest) : std::nullopt; }
    /// End of the last settled increment.
    [[nodiscard]] Time settled() const { return interval_.memory.end; }
    [[nodiscard]] bool any_increment() const { return interval_.memory.begun; }
    /// True if the rejected IMU samples form a consistent sequence on another time axis.
    [[nodiscard]] bool is_elsewhere() const { return memory.strangers >= needed_strangers; }
    /// True if the order of the pending samples has changed since the last call.
    bool reordered();
    /// Length in seconds of the gap in the last settled sample, 0: none.
    [[nodiscard]] double hole() const { return hole_; }
    [[nodiscard]] bool hangs() const { return hangs_; }
    /// Resets to the initial state.
    void clear();

    FeedCounters counters;

    /// State kept in addition to the data.
    struct Memory {
        bool any_imu = false;
        Time newest{};
        Time last_settled{INT64_MIN};             ///< stamp of the IMU sample
        std::array<Time, source_count> released;  ///< stamp of the last one of each channel
        Time stranger{};
        int strangers = 0;  ///< consecutive rejected IMU samples that follow each other
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

    /// Everything required for a copy of the stream: `archive(...)` is called with the parts.
    template <class Archive>
    void archive(Archive& a);

private:
    static constexpr int needed_strangers = 20;

    /// The pending samples of an instrument.
    template <class Sample>
    struct Pending {
        const Instrument<Sample>& instrument;
        detail::SamplePool<Sample> pool;
    };
    template <class List>
    struct PendingOf;
    template <class... Instruments>
    struct PendingOf<std::tuple<Instruments...>> {
        using type = std::tuple<Pending<typename Instruments::Sample>...>;
    };
    using AllPending = PendingOf<std::remove_const_t<decltype(instruments)>>::type;
    [[nodiscard]] static AllPending pending_of(const NavigatorSettings& settings);

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
    void release(Time until, Pending<Sample>& pending);
    /// `visit(Pending&)` for each instrument, in the order in which simultaneous measurements are used.
    template <class Visit>
    void each_pending(Visit&& visit) {
        std::apply([&](auto&... pending) { (visit(pending), ...); }, pending_);
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
    AllPending pending_;
    std::vector<std::uint32_t> free_ranges_;  // free ranges of samples in the range log
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
    each_pending([&](auto& pending) { a(recording_.*pending.instrument.log, pending.pool); });
    a(interval_.memory, hang_.memory, motion_.memory, events_.memory, slots_, hole_, hangs_);
}

}  // namespace schuler::filter
