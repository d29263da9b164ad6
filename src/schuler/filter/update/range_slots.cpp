// States of sources' slow errors, assigned to satellites and stations as they come and go.
#include "schuler/filter/update/range_update.h"

namespace schuler::filter {

template <class Frame>
int RangeUpdate<Frame>::slot_of(InertialFilter<Frame>& f, RangeTracking& tracking, int source, bool station, double sigma,
                                double time, RangeListener* listener) const {
    const sensor::RangeErrorModel& m = errors_of(station);
    const bool of_rate = has_slow_rate(station);
    if (!(m.correlated > 0.0) && !of_rate) return -1;
    constexpr double forgotten = 5.0;  // correlation times after which a slot may be reassigned
    std::size_t free = Layout::slots;
    for (std::size_t k = 0; k < Layout::slots; ++k) {
        const RangeTracking::Slot& slot = tracking.slots[k];
        if (slot.source == source) return static_cast<int>(k);
        if (free == Layout::slots && slot.source < 0) free = k;
    }
    for (std::size_t k = 0; k < Layout::slots && free == Layout::slots; ++k) {
        const RangeTracking::Slot& slot = tracking.slots[k];
        if ((f.time() - slot.last).seconds() > forgotten * errors_of(slot.station).correlation_time) free = k;
    }
    if (free == Layout::slots) return -1;
    tracking.watch.forget(tracking.slots[free].source);
    tracking.slots[free] = {source, station, f.time(), {}};
    renew(f, tracking, model_.layout.source + static_cast<int>(free), sigma * sigma, listener);
    f.set_slot_process(free, StateProcess::markov(sigma, time));
    if (model_.layout.source_rate >= 0)
        renew(f, tracking, model_.layout.source_rate + static_cast<int>(free),
              of_rate ? m.correlated_rate * m.correlated_rate : 0.0, listener);
    return static_cast<int>(free);
}

template <class Frame>
void RangeUpdate<Frame>::renew(InertialFilter<Frame>& f, RangeTracking& tracking, int state, double variance,
                               RangeListener* listener) const {
    tracking.watch.renew(state);
    f.renew(state, variance);
    if (listener != nullptr) listener->renewed(state);
}

template int RangeUpdate<GeographicFrame>::slot_of(InertialFilter<GeographicFrame>&, RangeTracking&, int, bool, double, double,
                                                   RangeListener*) const;
template int RangeUpdate<EarthFixedFrame>::slot_of(InertialFilter<EarthFixedFrame>&, RangeTracking&, int, bool, double, double,
                                                   RangeListener*) const;
template void RangeUpdate<GeographicFrame>::renew(InertialFilter<GeographicFrame>&, RangeTracking&, int, double,
                                                  RangeListener*) const;
template void RangeUpdate<EarthFixedFrame>::renew(InertialFilter<EarthFixedFrame>&, RangeTracking&, int, double,
                                                  RangeListener*) const;

}  // namespace schuler::filter
