// The walk along the timeline; instantiated for both frames.

#include "schuler/filter/update/pass.h"

#include "schuler/core/fail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

namespace {

constexpr Duration tolerance{100'000};  // an event this near to an increment's end needs no split of it
constexpr Duration instant_tolerance{1'000};

/// Puts the packed components of a record where they belong: north, east, down.
void unpack(AidRecord& record, std::uint8_t components) {
    if (components == 7 || record.dof == 0) return;
    const AidRecord packed = record;
    record.innovation.setZero();
    record.sigma.setZero();
    record.sigma_state.setZero();
    int used = 0;
    for (int axis = 0; axis < 3 && used < packed.dof; ++axis) {
        if ((components >> axis & 1) == 0) continue;
        record.innovation(axis) = packed.innovation(used);
        record.sigma(axis) = packed.sigma(used);
        record.sigma_state(axis) = packed.sigma_state(used);
        ++used;
    }
}

}  // namespace

template <class Frame>
Pass<Frame>::Pass(const InertialModel& model, const RunData& data, const Settings& settings, Rivalry rivalry,
                  std::vector<Opening> openings)
    : model_(model),
      data_(data),
      settings_(settings),
      rivalry_(rivalry),
      vibrates_(model.gyro_vibration > 0.0 || model.accel_vibration > 0.0),
      openings_(std::move(openings)),
      range_test_(uses_ranges(settings.coupling) ? RangeTest(settings.aids.gate_probability, settings.aids.recovery_time)
                                                 : RangeTest{}),
      update_with_ranges_(model, settings.ranging, settings.gnss.lever_arm_b, range_test_, data.backward) {
    if (settings.ranging.protection.use) range_test_.watch = ProtectionLimits(settings.ranging.protection).test;
}

template <class Frame>
void Pass<Frame>::propagate_covariance(Walk<Frame>& walk, Observer& observer) const {
    estim::Transition phi;
    const double span = walk.filter.gathered.time;
    if (!walk.filter.propagate_covariance(model_, phi)) return;
    for (CarriedFix& c : walk.carried)
        if (c.left > 0) carry(c, phi);
    walk.ranges.watch.propagate(phi, walk.filter.used);
    if (observer.records()) observer.step(phi);
    observer.propagated(walk.filter, span);
}

template <class Frame>
void Pass<Frame>::step(Walk<Frame>& walk, const ImuIncrement& increment, const BridgeNoise& noise, Observer& observer) const {
    if (walk.filter.gathered.is_full(increment.dt)) propagate_covariance(walk, observer);
    for (Shadow<Frame>& s : walk.shadows) {
        if (!s.alive) continue;
        estim::Transition phi;
        if (s.filter.gathered.is_full(increment.dt)) (void)s.filter.propagate_covariance(model_, phi);
        s.filter.propagate(model_, increment, noise);
    }
    walk.filter.propagate(model_, increment, noise);
}

template <class Frame>
ImuIncrement Pass<Frame>::run_to_events(Walk<Frame>& walk, ImuIncrement inc, const BridgeNoise& noise, Observer& observer) const {
    const bool ranging = uses_ranges(settings_.coupling);
    for (;;) {
        const std::vector<RangeEpoch>& epochs = data_.recording->ranges.epochs;
        const Time event = walk.event < data_.events.size() ? data_.events[walk.event].valid : Time{INT64_MAX};
        const Time epoch = ranging && walk.epoch < epochs.size() ? epochs[walk.epoch].time : Time{INT64_MAX};
        const Time measured = std::min(event, epoch);
        const Time instant = walk.instant < data_.instants.size() ? data_.instants[walk.instant] : Time{INT64_MAX};
        const bool is_instant = data_.backward ? instant <= measured : instant < measured, is_event = event <= epoch;
        const Time valid = is_instant ? instant : measured, now = walk.filter.time();
        const Duration near = is_instant ? instant_tolerance : tolerance;
        if (valid >= inc.time + near) return inc;
        const std::size_t index = is_instant ? walk.instant++ : is_event ? walk.event++ : walk.epoch++;
        if (valid < now - tolerance) continue;  // before the start
        const double part = (valid - now).seconds(), rest = (inc.time - valid).seconds();
        if (part > near.seconds() && rest > near.seconds()) {
            const double share = part / inc.dt;
            step(walk, {valid, part, share * inc.dtheta, share * inc.dv}, noise, observer);
            inc = {inc.time, rest, (1.0 - share) * inc.dtheta, (1.0 - share) * inc.dv};
        } else if (rest <= near.seconds() && now < inc.time) {
            step(walk, inc, noise, observer);
            inc.dt = 0.0;
        }
        if (is_instant) {
            propagate_covariance(walk, observer);
            observer.instant(walk, index);
            continue;
        }
        if (is_event) process(walk, data_.events[index], observer);
        else process(walk, epochs[index], observer);
        if (walk.diverged) return inc;
    }
}

template <class Frame>
void Pass<Frame>::advance(Walk<Frame>& walk, std::size_t last, Observer& observer) const {
    if (try_advance(walk, last, observer)) return;
    const Divergence& d = *walk.diverged;
    fail(computation_error(fmt::format("the filter diverged at {:.3f} s, channel {}", d.time.seconds(), info_of(d.kind).name),
                           d.kind == AidKind::Pseudorange ? "check the ranges and the IMU with `schuler inspect`"
                                                          : "check the IMU's units and axes with `schuler inspect`"));
}

template <class Frame>
bool Pass<Frame>::try_advance(Walk<Frame>& walk, std::size_t last, Observer& observer) const {
    for (; walk.increment <= last && walk.increment < data_.imu.increments.size(); ++walk.increment) {
        while (walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].last < walk.increment) ++walk.bridge;
        const bool bridged = walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].first <= walk.increment;
        const ImuIncrement& whole = data_.imu.increments[walk.increment];
        BridgeNoise noise = bridged ? data_.imu.bridges[walk.bridge].noise : BridgeNoise{};
        if (vibrates_) {
            if (!bridged) walk.vibration.add(whole);
            noise = with_vibration(model_, walk.vibration, noise);
        }
        constexpr double recently = 0.5;  // s
        noise.standing = (whole.time - walk.last_still).seconds() < recently;
        const ImuIncrement inc = run_to_events(walk, whole, noise, observer);
        if (walk.diverged) return false;
        if (inc.dt > 0.0) step(walk, inc, noise, observer);
        if (bridged) walk.suspect = walk.filter.time();
        if (settings_.loose_kind == LooseKind::Aggressive) carry_on(walk, observer);
        constrain(walk, observer);
        if (walk.diverged) return false;
        if (model_.loop == Loop::Mixed && inc.time >= walk.next_feedback) {
            propagate_covariance(walk, observer);
            estim::Transition phi = walk.filter.feed_back(model_);
            if (observer.records()) observer.step(phi);
            for (Shadow<Frame>& s : walk.shadows) {
                if (!s.alive) continue;
                (void)s.filter.propagate_covariance(model_, phi);
                (void)s.filter.feed_back(model_);
            }
            walk.next_feedback = inc.time + walk.feedback_period;
        }
        if (rivalry_ != Rivalry::None) contest(walk, observer);
        if (walk.diverged) return false;
        if (inc.time >= walk.next_output) {
            // A span that the next step ends is ended here: its transition is not made twice.
            if (model_.loop != Loop::Closed || observer.wants_all_states(inc.time) || walk.filter.gathered.is_full(whole.dt))
                propagate_covariance(walk, observer);
            observer.output(walk, inc.time);
            ++walk.outputs;
            const Duration step = settings_.output_rate > 0.0 ? Duration::from_seconds(1.0 / settings_.output_rate) : Duration{0};
            while (step.ns > 0 && walk.next_output <= inc.time) walk.next_output = walk.next_output + step;
        }
    }
    return true;
}

template <class Frame>
bool Pass<Frame>::uses(AidKind kind) const {
    // With ranges the receiver's own fixes would be used twice: they are what an outage without a reference is judged by.
    return !is_part_of_fix(kind) || !uses_ranges(settings_.coupling);
}

template <class Frame>
void Pass<Frame>::process(Walk<Frame>& walk, const Event& event, Observer& observer) const {
    // The table of an outage is made before the epoch's own update, with the height even where that has an age of its own.
    const bool in_table = event.outage >= 0 && event.kind == AidKind::GnssPosition && (event.components & 3) == 3;
    if (!uses(event.kind) && !in_table) return;
    propagate_covariance(walk, observer);
    if (event.constellation_change) change_constellation(walk, event);
    if (!walk.shadows.empty() && is_part_of_fix(event.kind) && !event.withheld) look_back(walk, event, observer);
    const Measurement local = measurement_of(walk.filter, event);
    if (local.dof == 0) return;
    if (in_table) {
        Observer nobody;
        Event whole = event;
        if (std::isfinite(data_.recording->gnss[event.index].position.h)) whole.components = 7;
        const Measurement all = measurement_of(walk.filter, whole);
        const AidRecord withheld = try_update(walk, event.kind, all, event.stamp, true, nobody);
        if (walk.diverged) return;
        observer.outage_epoch(walk, event, all, withheld);
    }
    if (!uses(event.kind)) return;
    AidRecord record = try_update(walk, {event.kind, event.components}, local, event.stamp, event.withheld, observer);
    if (walk.diverged) return;
    if (record.status == AidStatus::Accepted && event.kind == AidKind::Baro) {
        for (Shadow<Frame>& s : walk.shadows) {
            if (!s.alive) continue;
            estim::Transition phi;
            (void)s.filter.propagate_covariance(model_, phi);
            (void)s.filter.update(model_, s.filter.to_own(model_, measurement_of(s.filter, event)), [](const auto&) {});
        }
    }
    if (record.status == AidStatus::Accepted && event.kind == AidKind::GnssPosition) renew_shadows(walk);
    if (is_part_of_fix(event.kind)) unpack(record, event.components);
    observer.aid(record);
    observer.measured(walk, event, record);
}

template <class Frame>
void Pass<Frame>::process(Walk<Frame>& walk, const RangeEpoch& epoch, Observer& observer) const {
    propagate_covariance(walk, observer);
    const RangingLog& log = data_.recording->ranges;
    RangeListener* listener = observer.records() ? &observer : nullptr;
    if (is_withheld(settings_.outages, (epoch.time - data_.origin).seconds())) {  // satellites are withheld, stations are not
        std::array<RangeSample, RangeEpochWork::most> stations;
        std::size_t n = 0;
        for (const RangeSample& s : log.of(epoch))
            if (log.sources[s.source].station && n < stations.size()) stations[n++] = s;
        (void)update_with_ranges_(walk.filter, walk.ranges, log, {stations.data(), n}, listener);
    } else {
        (void)update_with_ranges_(walk.filter, walk.ranges, log, log.of(epoch), listener);
    }
    if (!walk.filter.P.diagonal().allFinite() || !std::isfinite(walk.filter.geographic(model_).position.h)) {
        walk.diverged = Divergence{walk.filter.time(), AidKind::Pseudorange};
        return;
    }
    observer.ranges(walk, epoch);
}

template class Pass<GeographicFrame>;
template class Pass<EarthFixedFrame>;

}  // namespace schuler::filter
