// The walk of the tight filter along increments, ranges, barometer and standstills; who wants to know what happens observes it.
#pragma once

#include "schuler/fusion/loose_run.h"
#include "schuler/fusion/range_update.h"

#include <optional>

namespace schuler::fusion {

/// A place on the walk; plain and copyable.
template <class Frame>
struct TightWalk {
    TightFilter<Frame> filter;
    ImuIncrement rest{};                 ///< what is left of the increment that is being consumed; dt 0: nothing
    std::size_t increment = 0;           ///< next to be loaded
    std::size_t bridge = 0, event = 0, epoch = 0, still = 0;
    BridgeNoise noise;                   ///< of `rest`
    Time next_output{};
    bool output_due = false;             ///< once the measurements of this instant are used
    std::array<GateState, 9> gates{};
    RangeEpochWork work;
};

/// Who wants to know derives from this.
template <class Frame>
struct TightObserver {
    virtual ~TightObserver() = default;
    virtual void output(const TightFilter<Frame>&, Time) {}
    virtual void aid(const AidRecord&) {}
    /// After the update with an epoch of ranges.
    virtual void ranges(const TightWalk<Frame>&, const RangeEpoch&) {}
    virtual void outage_epoch(const TightFilter<Frame>&, const Event&, const AidRecord&) {}
};

template <class Frame>
class TightPass {
public:
    using Observer = TightObserver<Frame>;

    /// `origin`: zero of the outages' times. During an outage satellites are withheld, stations are not.
    TightPass(const TightModel& model, const RunData& data, const Settings& settings, Time origin);

    /// Consumes increments up to and including index `last`. Throws Error(Computation) where the filter diverges.
    void advance(TightWalk<Frame>& walk, std::size_t last, Observer& observer) const;

private:
    void step(TightWalk<Frame>& walk, Time until, Observer& observer) const;
    void propagate(TightWalk<Frame>& walk, const ImuIncrement& part) const;
    void give_output(TightWalk<Frame>& walk, Observer& observer) const;
    void finish_increment(TightWalk<Frame>& walk, Observer& observer) const;
    void meet(TightWalk<Frame>& walk, const Event& event, Observer& observer) const;
    void meet(TightWalk<Frame>& walk, const RangeEpoch& epoch, Observer& observer) const;
    void stand_still(TightWalk<Frame>& walk, Observer& observer) const;
    AidRecord use(TightWalk<Frame>& walk, AidKind kind, const LocalMeasurement& local, Time stamp, bool withheld) const;
    [[nodiscard]] bool in_outage(Time t) const;

    const TightModel& model_;
    const RunData& data_;
    const Settings& settings_;
    Time origin_;
    RangeTest test_;
};

}  // namespace schuler::fusion
