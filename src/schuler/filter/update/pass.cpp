// The run along the timeline; instantiated for both frames.

#include "schuler/filter/update/pass.h"

#include "schuler/core/fail.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

namespace {

constexpr Duration tolerance{100'000};  // an event this close to an increment's end does not split it
constexpr Duration instant_tolerance{1'000};

/// Moves the packed components of a record to their places: north, east, down.
void unpack(MeasurementRecord& record, std::uint8_t components) {
    if (components == 7 || record.dof == 0) return;
    const MeasurementRecord packed = record;
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
      range_test_(uses_ranges(settings.coupling)
                      ? RangeTest(settings.constraints.gate_probability, settings.constraints.recovery_time)
                      : RangeTest{}),
      update_with_ranges_(model, settings.ranging, settings.gnss.lever_arm_b, range_test_, data.backward,
                          settings.gnss.jitter.value_or(0.0)) {
    if (settings.ranging.protection.use) range_test_.watch = ProtectionLimits(settings.ranging.protection).test;
}

template <class Frame>
void Pass<Frame>::propagate_covariance(FilterRun<Frame>& run, Observer& observer) const {
    estim::Transition phi;
    const double span = run.filter.gathered.time;
    if (!filter::propagate_covariance(model_, run.filter, run.second_order, phi)) return;
    for (CarriedFix& c : run.carried)
        if (c.left > 0) carry(c, phi);
    run.ranges.watch.propagate(phi, run.filter.used);
    if (observer.records()) observer.step(phi);
    observer.propagated(run.filter, span);
}

template <class Frame>
void Pass<Frame>::step(FilterRun<Frame>& run, const ImuIncrement& increment, const BridgeNoise& noise, Observer& observer) const {
    if (run.filter.gathered.is_full(increment.dt)) propagate_covariance(run, observer);
    for (Shadow<Frame>& s : run.shadows) {
        if (!s.alive) continue;
        if (s.filter.gathered.is_full(increment.dt)) s.propagate_covariance(model_);
        s.filter.propagate(model_, increment, noise);
    }
    run.filter.propagate(model_, increment, noise);
}

template <class Frame>
ImuIncrement Pass<Frame>::run_to_events(FilterRun<Frame>& run, ImuIncrement inc, const BridgeNoise& noise,
                                        Observer& observer) const {
    const bool ranging = uses_ranges(settings_.coupling);
    for (;;) {
        const std::vector<RangeEpoch>& epochs = data_.recording->ranges.epochs;
        const Time event = run.event < data_.events.size() ? data_.events[run.event].valid : Time{INT64_MAX};
        const Time epoch = ranging && run.epoch < epochs.size() ? epochs[run.epoch].time : Time{INT64_MAX};
        const Time measured = std::min(event, epoch);
        const Time instant = run.instant < data_.instants.size() ? data_.instants[run.instant] : Time{INT64_MAX};
        const bool is_instant = data_.backward ? instant <= measured : instant < measured, is_event = event <= epoch;
        const Time valid = is_instant ? instant : measured, now = run.filter.time();
        const Duration near = is_instant ? instant_tolerance : tolerance;
        if (valid >= inc.time + near) return inc;
        const std::size_t index = is_instant ? run.instant++ : is_event ? run.event++ : run.epoch++;
        if (valid < now - tolerance) continue;  // before the start
        const double part = (valid - now).seconds(), rest = (inc.time - valid).seconds();
        if (part > near.seconds() && rest > near.seconds()) {
            const double share = part / inc.dt;
            step(run, {valid, part, share * inc.dtheta, share * inc.dv}, noise, observer);
            inc = {inc.time, rest, (1.0 - share) * inc.dtheta, (1.0 - share) * inc.dv};
        } else if (rest <= near.seconds() && now < inc.time) {
            step(run, inc, noise, observer);
            inc.dt = 0.0;
        }
        if (is_instant) {
            propagate_covariance(run, observer);
            observer.instant(run, index);
            continue;
        }
        if (is_event) process(run, data_.events[index], observer);
        else process(run, epochs[index], observer);
        if (run.diverged) return inc;
    }
}

template <class Frame>
void Pass<Frame>::advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const {
    if (try_advance(run, last, observer)) return;
    const Divergence& d = *run.diverged;
    fail(computation_error(fmt::format("the filter diverged at {:.3f} s, channel {}", d.time.seconds(), info_of(d.kind).name),
                           d.kind == MeasurementKind::Pseudorange ? "check the ranges and the IMU with `schuler inspect`"
                                                                  : "check the IMU's units and axes with `schuler inspect`"));
}

template <class Frame>
bool Pass<Frame>::try_advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const {
    for (; run.increment <= last && run.increment < data_.imu.increments.size(); ++run.increment) {
        while (run.bridge < data_.imu.bridges.size() && data_.imu.bridges[run.bridge].last < run.increment) ++run.bridge;
        const bool bridged = run.bridge < data_.imu.bridges.size() && data_.imu.bridges[run.bridge].first <= run.increment;
        const ImuIncrement& whole = data_.imu.increments[run.increment];
        BridgeNoise noise = bridged ? data_.imu.bridges[run.bridge].noise : BridgeNoise{};
        if (vibrates_) {
            if (!bridged) run.vibration.add(whole);
            noise = with_vibration(model_, run.vibration, noise);
        }
        constexpr double recently = 0.5;  // s
        noise.standing = (whole.time - run.last_still).seconds() < recently;
        const ImuIncrement inc = run_to_events(run, whole, noise, observer);
        if (run.diverged) return false;
        if (inc.dt > 0.0) step(run, inc, noise, observer);
        if (bridged) run.suspect = run.filter.time();
        if (settings_.loose_kind == LooseKind::Aggressive) carry_on(run, observer);
        constrain(run, observer);
        if (run.diverged) return false;
        if (model_.loop == Loop::Mixed && inc.time >= run.next_feedback) {
            propagate_covariance(run, observer);
            estim::Transition phi = run.filter.feed_back(model_);
            if (observer.records()) observer.step(phi);
            for (Shadow<Frame>& s : run.shadows) {
                if (!s.alive) continue;
                s.propagate_covariance(model_);
                (void)s.filter.feed_back(model_);
            }
            run.next_feedback = inc.time + run.feedback_period;
        }
        if (rivalry_ != Rivalry::None) contest(run, observer);
        if (run.diverged) return false;
        if (inc.time >= run.next_output) {
            // An interval that would end in the next step ends here, so that its transition is not computed twice.
            if (model_.loop != Loop::Closed || observer.wants_all_states(inc.time) || run.filter.gathered.is_full(whole.dt))
                propagate_covariance(run, observer);
            observer.output(run, inc.time);
            ++run.outputs;
            const Duration step = settings_.output_rate > 0.0 ? Duration::from_seconds(1.0 / settings_.output_rate) : Duration{0};
            while (step.ns > 0 && run.next_output <= inc.time) run.next_output = run.next_output + step;
        }
    }
    return true;
}

template <class Frame>
bool Pass<Frame>::uses(MeasurementKind kind) const {
    // With ranges the receiver's own fixes would be used twice: they only serve as reference in an outage.
    return !is_part_of_fix(kind) || !uses_ranges(settings_.coupling);
}

template <class Frame>
void Pass<Frame>::process(FilterRun<Frame>& run, const Event& event, Observer& observer) const {
    // The table of an outage is filled before the epoch's own update, including a height with a separate age.
    const bool in_table = event.outage >= 0 && event.kind == MeasurementKind::GnssPosition && (event.components & 3) == 3;
    if (!uses(event.kind) && !in_table) return;
    propagate_covariance(run, observer);
    if (event.constellation_change) change_constellation(run, event);
    if (!run.shadows.empty() && is_part_of_fix(event.kind) && !event.withheld) look_back(run, event, observer);
    const Measurement local = measurement_of(run.filter, event);
    if (local.dof == 0) return;
    if (in_table) {
        Observer nobody;
        Event whole = event;
        if (std::isfinite(data_.recording->gnss[event.index].position.h)) whole.components = 7;
        const Measurement all = measurement_of(run.filter, whole);
        const MeasurementRecord withheld = try_update(run, event.kind, all, event.stamp, true, nobody);
        if (run.diverged) return;
        observer.outage_epoch(run, event, all, withheld);
    }
    if (!uses(event.kind)) return;
    const Channel channel{event.kind, event.components};
    const double interval = correction_interval(run, channel, event.stamp);
    MeasurementRecord record = try_update(run, channel, local, event.stamp, event.withheld, observer);
    if (run.diverged) return;
    if (record.status == MeasurementStatus::Accepted && event.kind == MeasurementKind::Baro)
        use_baro_in_shadows(run, event, interval);
    if (record.status == MeasurementStatus::Accepted && event.kind == MeasurementKind::GnssPosition) renew_shadows(run);
    if (is_part_of_fix(event.kind)) unpack(record, event.components);
    observer.measurement(record);
    observer.measured(run, event, record);
}

template <class Frame>
void Pass<Frame>::process(FilterRun<Frame>& run, const RangeEpoch& epoch, Observer& observer) const {
    propagate_covariance(run, observer);
    const RangingLog& log = data_.recording->ranges;
    RangeListener* listener = observer.records() ? &observer : nullptr;
    run.ranges.work.withheld = is_withheld(settings_.outages, (epoch.time - data_.origin).seconds());
    if (run.ranges.work.withheld) {  // satellites are withheld, stations are not
        std::array<RangeSample, RangeEpochWork::most> stations;
        std::size_t n = 0;
        for (const RangeSample& s : log.of(epoch))
            if (log.sources[s.source].station && n < stations.size()) stations[n++] = s;
        (void)update_with_ranges_(run.filter, run.ranges, log, {stations.data(), n}, listener);
    } else {
        (void)update_with_ranges_(run.filter, run.ranges, log, log.of(epoch), listener);
    }
    if (!run.filter.P.diagonal().allFinite() || !std::isfinite(run.filter.geographic(model_).position.h)) {
        run.diverged = Divergence{run.filter.time(), MeasurementKind::Pseudorange};
        return;
    }
    observer.ranges(run, epoch);
    if (model_.layout.ambiguity < 0 || epoch.carriers == 0 || run.ranges.work.withheld) return;
    const CarrierUse use = update_with_ranges_.use_carriers(run.filter, run.ranges, log, epoch, listener);
    observer.carriers(run, epoch, use);
}

template class Pass<GeographicFrame>;
template class Pass<EarthFixedFrame>;

}  // namespace schuler::filter
