// Use of a measurement in each coupling, and monitoring of the receiver: members of Pass.

#include "schuler/filter/update/pass.h"
#include "schuler/filter/update/separate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace schuler::filter {

namespace {

/// 0: position, 1: velocity.
std::size_t sub_vector(MeasurementKind kind) { return kind == MeasurementKind::GnssVelocity ? 1 : 0; }

/// Corrects the filter by scalars with dense rows. If the slow errors of fixes are only `considered`, their gain is zero
/// [Schmidt1966]. The smoother does not follow. Returns the estimated error.
template <class Frame>
StateVector correct(FilterRun<Frame>& run, const InertialModel& model, const Measurement& m,
                    const std::array<StateVector, 3>& rows, const StateVector& corrected, bool considered,
                    PassObserver<Frame>& observer) {
    StateMatrix& P = run.filter.P;
    StateVector dx = StateVector::Zero(P.rows());
    for (int i = 0; i < m.dof; ++i) {
        const StateVector& h = rows[static_cast<std::size_t>(i)];
        const StateVector ph = estim::as_double(P) * h;
        const double s = h.dot(ph) + m.variance(i);
        StateVector k = ph / s;
        for (const int state : {model.layout.gnss_position, model.layout.gnss_velocity})
            if (considered && state >= 0) k.segment<3>(state).setZero();
        dx += k * (m.innovation(i) - h.dot(corrected) - h.dot(dx));
        estim::correct_covariance(P, k, ph, s, run.filter.used);
    }
    run.filter.keep_above_floor(model);
    run.filter.apply(model, dx);
    observer.corrected();
    return dx;
}

std::array<StateVector, 3> rows_of(const Measurement& m, Eigen::Index size) {
    std::array<StateVector, 3> rows;
    for (int i = 0; i < m.dof; ++i) rows[static_cast<std::size_t>(i)] = m.rows[static_cast<std::size_t>(i)].whole(size);
    return rows;
}

}  // namespace

template <class Frame>
StateVector Pass<Frame>::update(FilterRun<Frame>& run, const Measurement& m, Observer& observer) const {
    if (considers(settings_)) {
        const Eigen::Index size = run.filter.P.rows();
        return correct(run, model_, m, rows_of(m, size), StateVector::Zero(size), true, observer);
    }
    if (run.ranges.watch.on) {
        std::array<WatchedScalar, 3> scalars;
        for (int i = 0; i < m.dof; ++i)
            scalars[static_cast<std::size_t>(i)] = {&m.rows[static_cast<std::size_t>(i)], m.innovation(i), m.variance(i)};
        run.ranges.watch.follow(run.filter.P, std::span(scalars).first(static_cast<std::size_t>(m.dof)), run.filter.time(),
                                run.filter.used);
    }
    return run.filter.update(model_, m, [&](const estim::RowUpdate& u) { observer.scalar(u); });
}

template <class Frame>
bool Pass<Frame>::use(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m, Time stamp,
                      Observer& observer) const {
    if (settings_.coupling == Coupling::Separate) return use_separately(run, channel, local, m, stamp);
    const bool in_parts = settings_.loose_kind == LooseKind::Aggressive && !channel.vertical_only && is_part_of_fix(channel.kind);
    Measurement part = m;
    if (in_parts) part.variance *= settings_.aggressive_parts;
    const StateVector dx = update(run, part, observer);
    if (settings_.loose_kind == LooseKind::Aggressive)
        for (CarriedFix& c : run.carried)
            if (c.left > 0) c.corrected += dx;
    if (!in_parts) return true;
    CarriedFix& c = run.carried[sub_vector(channel.kind)];
    const Duration interval = stamp - c.stamp;
    if (interval.seconds() > 0.0 && interval.seconds() < 10.0) c.every = Duration{interval.ns / settings_.aggressive_parts};
    c.measurement = part;
    c.corrected = dx;
    c.rows = rows_of(part, dx.size());
    c.left = settings_.aggressive_parts - 1;
    c.stamp = stamp;
    c.next = run.filter.time() + c.every;
    return true;
}

template <class Frame>
void Pass<Frame>::carry(CarriedFix& fix, const estim::Transition& phi) const {
    const Layout& L = model_.layout;
    fix.corrected = phi.times(fix.corrected);
    for (int i = 0; i < fix.measurement.dof; ++i) {
        StateVector& h = fix.rows[static_cast<std::size_t>(i)];
        // the part of a fix's slow error that has decayed since then is noise
        const auto forgotten = [&](int state, const Eigen::Vector3d& sigma) {
            for (int k = 0; state >= 0 && k < 3; ++k)
                fix.measurement.variance(i) +=
                    std::pow(h(state + k) * sigma(k), 2) * (1.0 - std::pow(phi.diagonal(state + k), 2));
        };
        forgotten(L.gnss_position, model_.gnss.correlated_position);
        forgotten(L.gnss_velocity, model_.gnss.correlated_velocity);
        h = estim::row_after(phi, h);
    }
}

template <class Frame>
void Pass<Frame>::carry_on(FilterRun<Frame>& run, Observer& observer) const {
    for (CarriedFix& c : run.carried) {
        if (c.left <= 0 || run.filter.time() < c.next) continue;
        propagate_covariance(run, observer);
        const StateVector dx = correct(run, model_, c.measurement, c.rows, c.corrected, considers(settings_), observer);
        for (CarriedFix& other : run.carried)
            if (other.left > 0) other.corrected += dx;
        --c.left;
        c.next = c.next + c.every;
    }
}

template <class Frame>
double Pass<Frame>::correction_interval(const FilterRun<Frame>& run, Channel channel, Time stamp) {
    const std::optional<Time>& last = run.corrected[channel.gate()];
    return last ? (stamp - *last).seconds() : 1.0;
}

template <class Frame>
void Pass<Frame>::correct_separately(InertialFilter<Frame>& filter, SecondOrder& second_order, const Measurement& m,
                                     Gains gains) const {
    if constexpr (!Frame::errors_are_geographic)
        gains.template topRows<9>() = (filter.to_local_level(model_).inverse() * gains.template topRows<9>()).eval();
    second_order.correct(m, gains);
    filter.correct(model_, m, gains);
}

template <class Frame>
void Pass<Frame>::close_baro_loop(InertialFilter<Frame>& filter, SecondOrder& second_order, const Measurement& m,
                                  double dt) const {
    // A loop closed too seldom for its time constant would be unstable.
    const double tau = settings_.separate.baro_time, closed = std::min(dt, 0.2 * tau);
    correct_separately(filter, second_order, m, barometer_gains(filter.P.rows(), filter.estimate(model_).C_nb, closed, tau));
}

template <class Frame>
void Pass<Frame>::use_baro_in_shadows(FilterRun<Frame>& run, const Event& event, double dt) const {
    for (Shadow<Frame>& s : run.shadows) {
        if (!s.alive) continue;
        s.propagate_covariance(model_);
        const Measurement m = s.filter.to_own(model_, measurement_of(s.filter, event));
        // The optimal gain would take a vertical acceleration that the covariance does not know for an error of everything correlated.
        if (settings_.coupling == Coupling::Separate) close_baro_loop(s.filter, s.second_order, m, dt);
        else (void)s.filter.update(model_, m, [](const auto&) {});
    }
}

template <class Frame>
bool Pass<Frame>::use_separately(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m,
                                 Time stamp) const {
    const SeparateSettings& s = settings_.separate;
    const bool position = channel.kind == MeasurementKind::GnssPosition;
    std::optional<Time>& last = run.corrected[channel.gate()];
    const double dt = correction_interval(run, channel, stamp);
    if (channel.kind == MeasurementKind::Baro) {
        close_baro_loop(run.filter, run.second_order, m, dt);
    } else if (position || channel.kind == MeasurementKind::GnssVelocity) {
        if (s.restart_period > 0.0 && last && dt < s.restart_period - 1e-3) return false;
        const double share = s.restart_period > 0.0 ? 1.0 : correction_share(dt, position ? s.position_time : s.velocity_time);
        Gains K = setting_gains(run.filter.P.rows(), local, position ? Layout::position : Layout::velocity, share);
        // With a barometer, the vertical channel is separate.
        if (model_.layout.baro_bias >= 0) K.row((position ? Layout::position : Layout::velocity) + 2).setZero();
        correct_separately(run.filter, run.second_order, m, K);
    } else {
        return false;
    }
    last = stamp;
    return true;
}

template <class Frame>
bool Pass<Frame>::cannot_judge(FilterRun<Frame>& run, Channel channel, Time stamp, Observer& observer) const {
    if (!run.second_order.follows()) return false;
    if (!run.unjudged && tilt_sigma(model_, run.filter) > most_tilt_judged) {
        run.unjudged = true;
        observer.alert({stamp, channel.kind, IntegrityTest::Unjudged});
        run.health = {};
        for (Shadow<Frame>& s : run.shadows) s.alive = false;
    }
    return run.unjudged;
}

template <class Frame>
MeasurementStatus Pass<Frame>::examine(FilterRun<Frame>& run, Channel channel, const MeasurementRecord& record,
                                       const Examined& examined, Observer& observer) const {
    const IntegritySettings& s = settings_.integrity;
    if (cannot_judge(run, channel, record.stamp, observer)) return MeasurementStatus::Accepted;
    ChannelHealth& health = run.health[sub_vector(channel.kind)];
    std::optional<IntegrityTest> failed = failed_test(examined, health, s);
    if (!failed && record.nis > data_.gates.chi_square[record.dof]) failed = IntegrityTest::Innovation;
    if (health.excluded) {
        const ChannelHealth* velocity = channel.kind == MeasurementKind::GnssPosition ? &run.health[1] : nullptr;
        if (!readmits(health, velocity, examined, !failed, s)) return MeasurementStatus::Excluded;
        observer.alert({record.stamp, channel.kind, IntegrityTest::Readmitted});
        return MeasurementStatus::Accepted;
    }
    if (!failed) {
        health.failed_run = 0;
        health.used = record.time;
        return MeasurementStatus::Accepted;
    }
    if (++health.failed_run >= s.slow_count && ends_a_fault(health, run.health[1], examined)) {
        observer.alert({record.stamp, channel.kind, IntegrityTest::Returned});
        Opening opening;
        const bool position = channel.kind == MeasurementKind::GnssPosition;
        (position ? opening.position : opening.velocity) = examined.innovation;
        opening.span = (run.filter.time() - *run.health[1].faulty).seconds();
        open(run, opening);
        if (const int slow = position ? model_.layout.gnss_position : model_.layout.gnss_velocity; slow >= 0)
            run.filter.P.diagonal().template segment<3>(slow).array() += examined.innovation.squaredNorm();
        health.failed_run = 0;
        health.returned = true;
        health.used = record.time;
        for (Shadow<Frame>& shadow : run.shadows) shadow.alive = false;
        return MeasurementStatus::Accepted;
    }
    if (health.failed_run >= s.slow_count) {
        observer.alert({record.stamp, channel.kind, *failed});
        health = {};
        health.excluded = true;
        if (channel.kind == MeasurementKind::GnssVelocity) {
            health.fault = examined.innovation;
            health.faulty = record.time;
        }
        for (Shadow<Frame>& shadow : run.shadows) shadow.alive = false;
        return MeasurementStatus::Excluded;
    }
    return MeasurementStatus::Rejected;
}

template <class Frame>
void Pass<Frame>::look_back(FilterRun<Frame>& run, const Event& event, Observer& observer) const {
    ChannelHealth& health = run.health[sub_vector(event.kind)];
    if (health.excluded || cannot_judge(run, event.kind, event.stamp, observer)) return;
    Shadow<Frame>* oldest = nullptr;
    for (Shadow<Frame>& s : run.shadows)
        if (s.alive && (oldest == nullptr || s.since < oldest->since)) oldest = &s;
    if (oldest == nullptr || (run.filter.time() - oldest->since).seconds() < 0.5 * settings_.integrity.window) return;
    oldest->propagate_covariance(model_);
    const Measurement local = measurement_of(oldest->filter, event), m = oldest->filter.to_own(model_, local);
    if (m.dof == 0) return;
    const double nis = m.innovation.dot(examined_covariance(oldest->filter, oldest->second_order, m).inverse() * m.innovation);
    health.slow_run = nis > data_.slow_limits[static_cast<std::size_t>(m.dof)] ? health.slow_run + 1 : 0;
    if (health.slow_run < settings_.integrity.slow_count) return;
    observer.alert({event.stamp, event.kind, IntegrityTest::Slow});
    run.filter = oldest->filter;  // the solution from before the error
    run.second_order = oldest->second_order;
    for (CarriedFix& c : run.carried) c.left = 0;
    const bool both = run.health[0].used && run.health[1].used;
    for (ChannelHealth& h : run.health) {
        h = {};
        h.excluded = true;
        h.together = both;
    }
    if (event.kind == MeasurementKind::GnssVelocity) {
        health.fault = m.innovation;
        health.faulty = run.filter.time();
    }
    for (Shadow<Frame>& s : run.shadows) s.alive = false;
}

template <class Frame>
void Pass<Frame>::renew_shadows(FilterRun<Frame>& run) const {
    if (run.shadows.size() != 2 || run.unjudged || run.health[0].excluded || run.health[1].excluded) return;
    if (run.health[0].slow_run > 0 || run.health[1].slow_run > 0) return;  // not while under suspicion
    const Time now = run.filter.time();
    const double window = settings_.integrity.window;
    for (std::size_t i = 0; i < 2; ++i) {
        Shadow<Frame>&shadow = run.shadows[i], &other = run.shadows[1 - i];
        const bool due = shadow.alive ? (now - shadow.since).seconds() >= window
                                      : !other.alive || (now - other.since).seconds() >= 0.5 * window;
        if (!due) continue;
        shadow = {run.filter, run.second_order, now, true};
        return;
    }
}

#define SCHULER_INSTANTIATE(Frame)                                                                                             \
    template StateVector Pass<Frame>::update(FilterRun<Frame>&, const Measurement&, Observer&) const;                          \
    template bool Pass<Frame>::use(FilterRun<Frame>&, Channel, const Measurement&, const Measurement&, Time, Observer&) const; \
    template void Pass<Frame>::carry(CarriedFix&, const estim::Transition&) const;                                             \
    template void Pass<Frame>::carry_on(FilterRun<Frame>&, Observer&) const;                                                   \
    template MeasurementStatus Pass<Frame>::examine(FilterRun<Frame>&, Channel, const MeasurementRecord&, const Examined&,     \
                                                    Observer&) const;                                                          \
    template void Pass<Frame>::look_back(FilterRun<Frame>&, const Event&, Observer&) const;                                    \
    template double Pass<Frame>::correction_interval(const FilterRun<Frame>&, Channel, Time);                                  \
    template void Pass<Frame>::use_baro_in_shadows(FilterRun<Frame>&, const Event&, double) const;                             \
    template void Pass<Frame>::renew_shadows(FilterRun<Frame>&) const;
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::filter
