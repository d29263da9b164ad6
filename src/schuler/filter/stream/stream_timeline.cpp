#include "schuler/filter/stream/stream_timeline.h"

#include "schuler/earth/earth.h"
#include "schuler/filter/stream/fix_noise.h"
#include "schuler/filter/update/range_update.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Vector3d;

namespace {

/// Measurements this much after an increment's end are used with it; at least the tolerance of Pass.
constexpr Duration slack{200'000};

std::size_t capacity(double rate, double seconds) {
    return rate > 0.0 ? static_cast<std::size_t>(std::ceil(1.5 * rate * seconds)) + 8 : 0;
}

std::size_t imu_capacity(const NavigatorSettings& s) {
    return static_cast<std::size_t>(std::ceil(2.0 * (s.lag + 0.1) / s.imu_interval)) + 16;
}
std::size_t instrument_capacity(const NavigatorSettings& s, double rate) {
    return capacity(rate, s.lag + s.still_delay + StreamTimeline::most_ahead);
}

}  // namespace

StreamTimeline::AllPending StreamTimeline::pending_of(const NavigatorSettings& s) {
    const auto one = [&]<class Sample>(const Instrument<Sample>& instrument) {
        return Pending<Sample>{instrument, detail::SamplePool<Sample>(instrument_capacity(s, s.rates.*instrument.rate))};
    };
    return std::apply([&](const auto&... instrument) { return AllPending{one(instrument)...}; }, instruments);
}

StreamTimeline::StreamTimeline(const NavigatorSettings& s)
    : settings_(s),
      thresholds_(s.still.force_std > 0.0 ? s.still : thresholds_of_noise(s.filter.imu.errors, s.imu_interval)),
      lag_(Duration::from_seconds(s.lag)),
      longest_hole_(Duration::from_seconds(s.longest_hole)),
      largest_rate_(largest_still_rate(s.filter.vehicle)),
      imu_store_(imu_capacity(s)),
      imu_(imu_capacity(s)),
      gnss_(instrument_capacity(s, s.rates.gnss)),
      pending_(pending_of(s)),
      interval_(s.filter.imu, s.imu_interval),
      hang_(s.imu_interval),
      motion_(s.imu_interval),
      events_(settings_.filter, Time{}) {
    recording_.gnss.resize(instrument_capacity(s, s.rates.gnss));
    std::size_t others = 0;
    for_each_instrument([&](const auto& instrument) {
        auto& store = recording_.*instrument.log;
        store.resize(instrument_capacity(s, s.rates.*instrument.rate));
        others += store.size();
    });
    data_.fix_noise.resize(recording_.gnss.size());
    data_.recording = &recording_;
    set_limits(data_, s.filter);
    data_.imu.median_dt = s.imu_interval;
    data_.imu.increments.reserve(idle_increments + 2 * (static_cast<std::size_t>(most_pieces) + 2) +
                                 static_cast<std::size_t>(2.0 * s.still_delay / s.imu_interval));
    data_.imu.bridges.reserve(64);
    data_.events.reserve(4 * recording_.gnss.size() + others);
    data_.still.windows.reserve(64);
    slots_.reserve(64);
    const std::size_t epochs = instrument_capacity(s, s.rates.ranges);
    recording_.ranges.epochs.reserve(epochs);
    recording_.ranges.samples.resize(epochs * RangeEpochWork::most);
    recording_.ranges.sources.reserve(s.rates.range_sources);
    free_ranges_.reserve(epochs);
    clear();
}

void StreamTimeline::clear() {
    memory = {};
    memory.released.fill(Time{INT64_MIN});
    imu_.clear();
    gnss_.clear();
    each_pending([](auto& pending) { pending.pool.clear(); });
    data_.imu.increments.clear();
    data_.imu.bridges.clear();
    data_.events.clear();
    data_.still.windows.clear();
    slots_.clear();
    recording_.ranges.epochs.clear();
    free_ranges_.clear();
    for (std::size_t i = recording_.ranges.samples.size() / RangeEpochWork::most; i-- > 0;)
        free_ranges_.push_back(static_cast<std::uint32_t>(i));
    interval_.memory = {};
    hang_.memory = {};
    motion_.clear();
    events_.memory = {};
    hole_ = 0.0;
    hangs_ = false;
}

bool StreamTimeline::reordered() {
    const bool changed = memory.order_changed;
    memory.order_changed = false;
    return changed;
}

bool StreamTimeline::settle() {
    hole_ = 0.0;
    hangs_ = false;
    if (imu_.empty()) return false;
    const ImuSample& sample = imu_store_[imu_.index(0)];
    const Time horizon = memory.newest - lag_ - slack;
    if (sample.time > horizon) return false;
    std::optional<Time> next;
    if (settings_.filter.imu.stamp != ImuStamp::End) {  // determined by the next sample
        if (imu_.waiting() < 2 || imu_store_[imu_.index(1)].time > horizon) return false;
        next = imu_store_[imu_.index(1)].time;
    }
    imu_.let_go(imu_.take());
    memory.last_settled = sample.time;
    if (hang_.hangs(sample)) {
        hangs_ = true;
        return true;
    }
    const std::optional<ImuIncrement> interval = interval_.add(sample, next);
    if (!interval) return true;
    motion_.add(*interval);
    if (memory.has_before && is_hole(interval->dt, settings_.imu_interval, settings_.filter.imu)) bridge(*interval);
    else add_increment(*interval, false);
    memory.before = *interval;
    memory.has_before = true;
    release(interval->time + slack);
    return true;
}

void StreamTimeline::bridge(const ImuIncrement& interval) {
    const bool uncertain = interval.dt > settings_.filter.imu.gap_factor * settings_.imu_interval;
    const std::size_t first = data_.imu.increments.size();
    fill_hole(memory.before, interval, settings_.imu_interval,
              [&](const ImuIncrement& piece, bool interpolated) { add_increment(piece, interpolated && uncertain); });
    if (!uncertain) return;
    if (data_.imu.bridges.size() < data_.imu.bridges.capacity())
        data_.imu.bridges.push_back(
            {first, data_.imu.increments.size() - 2, bridge_noise(interval.dt, motion_.recent(), motion_.usual())});
    ++data_.imu.gaps;
    ++counters.holes;
    hole_ = interval.dt;
}

void StreamTimeline::add_increment(const ImuIncrement& increment, bool interpolated) {
    if (memory.current_slot == 0 && slots_.empty()) memory.slots_start = increment.time;
    data_.imu.increments.push_back(increment);
    const auto k = static_cast<std::size_t>((increment.time - memory.slots_start).seconds() / StillSlot::length);
    memory.current_slot = std::max(memory.current_slot, k);
    StillSlot* s = slot(k);
    if (s != nullptr && !interpolated) s->add(increment);
}

/// The slot of a given number, created if necessary; null if it was discarded or is too far ahead.
StillSlot* StreamTimeline::slot(std::size_t number) {
    constexpr std::size_t furthest = 16;
    if (number < memory.first_slot || number > memory.current_slot + furthest) return nullptr;
    while (memory.first_slot + slots_.size() <= number) {
        if (slots_.size() == slots_.capacity()) {
            slots_.erase(slots_.begin());
            ++memory.first_slot;
        }
        StillSlot s;
        s.end = memory.slots_start +
                Duration::from_seconds(StillSlot::length * static_cast<double>(memory.first_slot + slots_.size() + 1));
        slots_.push_back(s);
    }
    return number < memory.first_slot ? nullptr : &slots_[number - memory.first_slot];
}

void StreamTimeline::judge_still(Time until) {
    const VehicleKind vehicle = settings_.filter.vehicle;
    if (vehicle == VehicleKind::Ship) return;
    memory.next_judged = std::max(memory.next_judged, memory.first_slot);
    for (;; ++memory.next_judged) {
        const std::size_t i = memory.next_judged - memory.first_slot;
        if (i >= slots_.size() || slots_[i].end > until) break;
        memory.moved = memory.moved || slots_[i].speed > 1.0;
        // Aircraft hover and hand-held units float unsensed by the IMU: standstill is accepted only before the first motion.
        if (memory.moved && (vehicle == VehicleKind::Air || vehicle == VehicleKind::Hand)) continue;
        const std::size_t complete = std::clamp(memory.current_slot - memory.first_slot, i + 1, slots_.size());
        const std::span<StillSlot> known(slots_.data(), complete);
        for (std::size_t k = i > 0 ? i - 1 : 0; k < std::min(i + 2, complete); ++k)
            add_statistics(known, k, settings_.imu_interval);
        if (!is_still(known, i, thresholds_, largest_rate_)) continue;
        if (!thresholds_.learnt) {  // an IMU does not sense steady motion: a receiver must confirm standstill
            constexpr std::size_t back = 6;
            const bool seen =
                std::ranges::any_of(known.subspan(i > back ? i - back : 0), [](const StillSlot& s) { return s.speed < 0.3; });
            if (!seen) continue;
        }
        if (data_.still.windows.size() == data_.still.windows.capacity()) data_.still.windows.erase(data_.still.windows.begin());
        data_.still.windows.push_back(slots_[i].window());
    }
    constexpr std::size_t kept = 8;
    const std::size_t judged = memory.next_judged - memory.first_slot;
    if (judged > 2 * kept) {
        slots_.erase(slots_.begin(), slots_.begin() + static_cast<std::ptrdiff_t>(judged - kept));
        memory.first_slot += judged - kept;
    }
}

void StreamTimeline::add_speed(Time time, double speed) {
    const double k = (time - memory.slots_start).seconds() / StillSlot::length;
    if (!(k >= 0.0) || k > 1e15) return;
    if (StillSlot* s = slot(static_cast<std::size_t>(k)); s != nullptr) s->add_speed(speed);
}

/// From velocities, or else from differences of precise positions.
void StreamTimeline::add_speeds(const GnssFix& fix, const Event& e) {
    if ((e.components & 3) != 3) return;
    if (e.kind == MeasurementKind::GnssVelocity) {
        add_speed(e.valid, fix.velocity_n.head<2>().norm());
        return;
    }
    const double sigma = fix.std_position.head<2>().norm();
    if (fix.velocity_n.head<2>().allFinite() || !(sigma > 0.0 && sigma < 0.1)) return;
    const double dt = memory.has_precise ? (e.valid - memory.precise_time).seconds() : 0.0;
    if (dt > 0.05 && dt < 2.5) {
        const double speed = earth::ned_difference(settings_.filter.earth, fix.position, memory.precise).head<2>().norm() / dt;
        for (double t = 0.0; t <= dt; t += StillSlot::length) add_speed(memory.precise_time + Duration::from_seconds(t), speed);
    }
    memory.has_precise = true;
    memory.precise = fix.position;
    memory.precise_time = e.valid;
}

namespace {

/// Order of simultaneous measurements.
std::ptrdiff_t rank(MeasurementKind kind) {
    const auto at = std::ranges::find(instrument_kinds, kind);
    return at == instrument_kinds.end() ? 0 : 1 + (at - instrument_kinds.begin());
}

}  // namespace

void StreamTimeline::insert(const Event& event) {
    const auto at = std::upper_bound(data_.events.begin(), data_.events.end(), event, [](const Event& a, const Event& b) {
        return a.valid != b.valid ? a.valid < b.valid : rank(a.kind) < rank(b.kind);
    });
    data_.events.insert(at, event);
}

template <class Sample>
void StreamTimeline::release(Time until, Pending<Sample>& pending) {
    const Instrument<Sample>& instrument = pending.instrument;
    detail::SamplePool<Sample>& pool = pending.pool;
    const std::vector<Sample>& store = recording_.*instrument.log;
    while (!pool.empty() && store[pool.index(0)].time < until) {
        const std::size_t index = pool.take();
        memory.released[static_cast<std::size_t>(instrument.source)] = store[index].time;
        pool.hold(index);
        if (events_.is_due(store[index])) insert(event_at(store[index].time, instrument.kind, instrument.components, index));
        else pool.let_go(index);
    }
}

void StreamTimeline::release(Time until) {
    const std::vector<GnssFix>& fixes = recording_.gnss;
    while (!gnss_.empty() && fixes[gnss_.index(0)].time - events_.oldest_age(fixes[gnss_.index(0)]) < until) {
        const std::size_t index = gnss_.take();
        const GnssFix& fix = fixes[index];
        memory.released[static_cast<std::size_t>(Source::Gnss)] = fix.time;
        data_.fix_noise[index] = noise_of(fix, settings_.filter.gnss);
        gnss_.hold(index);
        events_.gnss(fix, index, [&](const Event& e) {
            gnss_.hold(index);
            insert(e);
            add_speeds(fix, e);
        });
        gnss_.let_go(index);
    }
    each_pending([&](auto& pending) { release(until, pending); });
}

void StreamTimeline::let_go(const Event& e) {
    if (is_part_of_fix(e.kind)) gnss_.let_go(e.index);
    each_pending([&](auto& pending) {
        if (pending.instrument.kind == e.kind) pending.pool.let_go(e.index);
    });
}

StreamTimeline::Places StreamTimeline::forget(Places p, bool all) {
    const auto drop = [](auto& list, std::size_t count) {
        if (count > 0) list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count));
    };
    for (std::size_t i = 0; i < p.event; ++i) let_go(data_.events[i]);
    drop(data_.events, p.event);
    for (std::size_t i = 0; i < p.epoch; ++i)
        free_ranges_.push_back(static_cast<std::uint32_t>(recording_.ranges.epochs[i].first / RangeEpochWork::most));
    drop(recording_.ranges.epochs, p.epoch);
    drop(data_.still.windows, p.still);
    drop(data_.imu.bridges, p.bridge);
    if (p.increment < idle_increments && !all) p.increment = 0;
    if (p.increment == 0) return p;
    for (Bridge& b : data_.imu.bridges) {
        b.first -= std::min(b.first, p.increment);
        b.last -= std::min(b.last, p.increment);
    }
    drop(data_.imu.increments, p.increment);
    return p;
}

}  // namespace schuler::filter
