#include "schuler/fusion/tight_pass.h"

#include "schuler/core/error.h"
#include "schuler/fusion/aid/constraint.h"
#include "schuler/fusion/aid/environment.h"
#include "schuler/fusion/aid/gnss.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::fusion {

namespace {

constexpr Duration tolerance{100'000};   // an event this near to an increment's end needs no split of it

}  // namespace

template <class Frame>
TightPass<Frame>::TightPass(const TightModel& model, const RunData& data, const Settings& settings, Time origin)
    : model_(model), data_(data), settings_(settings), origin_(origin),
      test_(settings.aids.gate_probability, settings.aids.recovery_time) {
    if (settings.ranging.protection.use) test_.watch = ProtectionLimits(settings.ranging.protection).test;
}

template <class Frame>
bool TightPass<Frame>::in_outage(Time t) const {
    const double s = (t - origin_).seconds();
    return std::ranges::any_of(settings_.outages, [s](const Outage& o) { return s > o.start && s < o.start + o.duration; });
}

template <class Frame>
void TightPass<Frame>::advance(TightWalk<Frame>& w, std::size_t last, Observer& observer) const {
    last = std::min(last, data_.imu.increments.size() - 1);
    if (w.increment > last) return;
    const Time end = data_.imu.increments[last].time;
    const std::vector<RangeEpoch>& epochs = data_.recording->ranges.epochs;
    for (;;) {
        const Time event = w.event < data_.events.size() ? data_.events[w.event].valid : Time{INT64_MAX};
        const Time epoch = w.epoch < epochs.size() ? epochs[w.epoch].time : Time{INT64_MAX};
        const Time next = std::min(event, epoch);
        if (next > end + tolerance) break;
        if (next < w.filter.time() - tolerance) {   // before the start
            ++(event <= epoch ? w.event : w.epoch);
            continue;
        }
        step(w, next, observer);
        if (event <= epoch) meet(w, data_.events[w.event++], observer);
        else meet(w, epochs[w.epoch++], observer);
    }
    step(w, end, observer);
    give_output(w, observer);
}

template <class Frame>
void TightPass<Frame>::step(TightWalk<Frame>& w, Time until, Observer& observer) const {
    for (;;) {
        if (w.rest.dt <= 0.0) {
            if (w.increment >= data_.imu.increments.size()) return;
            const ImuIncrement& next = data_.imu.increments[w.increment];
            if (next.time - Duration::from_seconds(next.dt) > until - tolerance) return;
            w.rest = next;
            while (w.bridge < data_.imu.bridges.size() && data_.imu.bridges[w.bridge].last < w.increment) ++w.bridge;
            const bool bridged = w.bridge < data_.imu.bridges.size() && data_.imu.bridges[w.bridge].first <= w.increment;
            w.noise = bridged ? data_.imu.bridges[w.bridge].noise : BridgeNoise{};
            ++w.increment;
        }
        if (w.rest.time <= until + tolerance) {
            give_output(w, observer);
            propagate(w, w.rest);
            w.rest.dt = 0.0;
            finish_increment(w, observer);
            continue;
        }
        const double part = (until - w.filter.time()).seconds();
        if (part <= tolerance.seconds()) return;
        give_output(w, observer);
        const double share = part / w.rest.dt;
        propagate(w, {until, part, share * w.rest.dtheta, share * w.rest.dv});
        w.rest = {w.rest.time, w.rest.dt - part, (1.0 - share) * w.rest.dtheta, (1.0 - share) * w.rest.dv};
        return;
    }
}

template <class Frame>
void TightPass<Frame>::propagate(TightWalk<Frame>& w, const ImuIncrement& part) const {
    w.filter.propagate(model_, part, w.noise);
}

template <class Frame>
void TightPass<Frame>::finish_increment(TightWalk<Frame>& w, Observer& observer) const {
    stand_still(w, observer);
    w.output_due = w.filter.time() >= w.next_output;
}

template <class Frame>
void TightPass<Frame>::give_output(TightWalk<Frame>& w, Observer& observer) const {
    if (!w.output_due) return;
    w.output_due = false;
    const Time now = w.filter.time();
    w.filter.bring_up(model_);
    observer.output(w.filter, now);
    if (!(settings_.output_rate > 0.0)) return;
    const Duration period = Duration::from_seconds(1.0 / settings_.output_rate);
    while (w.next_output <= now) w.next_output = w.next_output + period;
}

template <class Frame>
AidRecord TightPass<Frame>::use(TightWalk<Frame>& w, AidKind kind, const LocalMeasurement& local, Time stamp, bool withheld) const {
    using Row = estim::SparseRow<TightLayout::inertial>;
    TightFilter<Frame>& f = w.filter;
    const Measurement<TightLayout::inertial> m = to_filter(model_.inertial, f.inertial, local);
    const auto corner = f.P.template topLeftCorner<TightLayout::inertial, TightLayout::inertial>();
    Eigen::Matrix3d S = m.rows.transpose() * corner * m.rows;
    AidRecord record;
    record.time = f.time();
    record.stamp = stamp;
    record.kind = kind;
    record.dof = m.dof;
    record.innovation = m.innovation;
    record.sigma_state = S.diagonal().cwiseMax(0.0).cwiseSqrt();
    S.diagonal() += m.variance;
    for (int i = 0; i < m.dof; ++i) record.sigma(i) = std::sqrt(S(i, i));
    record.nis = m.innovation.dot(S.inverse() * m.innovation);
    if (!std::isfinite(record.nis))
        throw computation_error(fmt::format("the tight filter diverged at {:.3f} s", record.time.seconds()),
                                "check the IMU's units and axes with `schuler inspect`");
    record.status = AidStatus::Withheld;
    if (withheld) return record;
    const auto gate = static_cast<std::size_t>(kind);
    Eigen::Vector3d used = Eigen::Vector3d::Zero();
    for (int i = 0; i < m.dof; ++i) used(i) = std::sqrt(m.variance(i));
    const double drift = std::sqrt(f.P.diagonal().template segment<3>(Layout::velocity).maxCoeff());
    const GateDecision decision = decide(w.gates[gate], data_.gates, record.time, m.dof, record.nis, m.innovation, used, drift);
    record.status = AidStatus::Rejected;
    if (decision == GateDecision::Reject || (decision == GateDecision::Recover && kind != AidKind::Baro)) return record;
    if (decision == GateDecision::Recover) f.P(TightLayout::baro_bias, TightLayout::baro_bias) += m.innovation.squaredNorm();
    TightVector dx = TightVector::Zero();
    for (int i = 0; i < m.dof; ++i) {
        Row row;
        for (int k = 0; k < TightLayout::inertial; ++k)
            if (m.rows(k, i) != 0.0) row.add(k, m.rows(k, i));
        f.watch.follow(f.P, row, m.innovation(i) - row.dot(dx), m.variance(i), f.used, -1);
        (void)estim::update_sparse<TightLayout::size>(dx, f.P, row, m.innovation(i), m.variance(i), f.used);
    }
    f.apply(model_, dx);
    record.status = AidStatus::Accepted;
    return record;
}

template <class Frame>
void TightPass<Frame>::meet(TightWalk<Frame>& w, const Event& event, Observer& observer) const {
    w.filter.bring_up(model_);
    const Estimate e = estimate_of(model_.inertial, w.filter.inertial);
    if (event.kind == AidKind::Baro) {
        const double height = data_.recording->baro[event.index].height;
        observer.aid(use(w, event.kind, baro_height(e, height, settings_.baro.std * settings_.baro.std), event.stamp, event.withheld));
    }
    // the receiver's own fixes are not used: they are what an outage without a reference is judged by
    if (event.kind != AidKind::GnssPosition || event.outage < 0 || (event.components & 3) != 3) return;
    const bool vertical = std::isfinite(data_.recording->gnss[event.index].position.h);
    const LocalMeasurement m =
        gnss_position(e, data_.recording->gnss[event.index].position, data_.fix_noise[event.index].position.cwiseAbs2(),
                      settings_.gnss.lever_arm_b, {true, true, vertical});
    observer.outage_epoch(w.filter, event, use(w, event.kind, m, event.stamp, true));
}

template <class Frame>
void TightPass<Frame>::meet(TightWalk<Frame>& w, const RangeEpoch& epoch, Observer& observer) const {
    TightFilter<Frame>& f = w.filter;
    f.bring_up(model_);
    const RangingLog& log = data_.recording->ranges;
    std::span<const RangeSample> samples = log.of(epoch);
    std::vector<RangeSample> stations;
    if (in_outage(epoch.time)) {
        std::ranges::copy_if(samples, std::back_inserter(stations), [&](const RangeSample& m) { return log.sources[m.source].station; });
        samples = stations;
    }
    (void)update_with_ranges(model_, test_, f, log, samples, w.work);
    if (!f.P.diagonal().allFinite())
        throw computation_error(fmt::format("the tight filter diverged at {:.3f} s", f.time().seconds()),
                                "check the ranges and the IMU with `schuler inspect`");
    observer.ranges(w, epoch);
}

template <class Frame>
void TightPass<Frame>::stand_still(TightWalk<Frame>& w, Observer& observer) const {
    const AidSettings& aids = settings_.aids;
    for (; w.still < data_.still.windows.size() && data_.still.windows[w.still].end <= w.filter.time(); ++w.still) {
        const StillWindow& window = data_.still.windows[w.still];
        const Time now = w.filter.time();
        if (!aids.zero_velocity || (now - window.end).seconds() > 0.1) continue;
        w.filter.bring_up(model_);
        const auto estimate = [&] { return estimate_of(model_.inertial, w.filter.inertial); };
        const AidRecord velocity = use(w, AidKind::ZeroVelocity, zero_velocity(estimate(), aids.zero_velocity_std), now, false);
        observer.aid(velocity);
        if (velocity.status != AidStatus::Accepted) continue;
        const double variance = model_.inertial.gyro_psd / window.length + aids.zero_rate_std * aids.zero_rate_std;
        observer.aid(use(w, AidKind::ZeroRate, zero_rate(estimate(), window.mean_rate_b, variance), now, false));
    }
}

template class TightPass<GeographicFrame>;
template class TightPass<EarthFixedFrame>;

}  // namespace schuler::fusion
