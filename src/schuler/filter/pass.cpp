// The walk along the timeline; instantiated for both frames.

#include "schuler/filter/pass.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/filter/measurement/body_velocity.h"
#include "schuler/filter/measurement/constraint.h"
#include "schuler/filter/measurement/environment.h"
#include "schuler/filter/measurement/gauge.h"
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/measurement/odometer.h"
#include "schuler/math/rotation.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

namespace {

constexpr Duration tolerance{100'000};   // an event this near to an increment's end needs no split of it
constexpr Duration instant_tolerance{1'000};

/// A receiver's fix has two sub-vectors, which are controlled each by itself.
bool is_sub_vector(AidKind kind) { return kind == AidKind::GnssPosition || kind == AidKind::GnssVelocity; }

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

bool in_outage(const Settings& settings, Time origin, Time t) {
    const double s = (t - origin).seconds();
    return std::ranges::any_of(settings.outages, [s](const Outage& o) { return s > o.start && s < o.start + o.duration; });
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
      range_test_(uses_ranges(settings.coupling) ? RangeTest(settings.aids.gate_probability, settings.aids.recovery_time) : RangeTest{}),
      update_with_ranges_(model, settings.ranging, settings.gnss.lever_arm_b, range_test_, data.backward) {
    if (settings.ranging.protection.use) range_test_.watch = ProtectionLimits(settings.ranging.protection).test;
}

template <class Frame>
void Pass<Frame>::propagate_covariance(Walk<Frame>& walk, Observer& observer) const {
    estim::Transition phi;
    const GatheredMotion& gathered = walk.filter.gathered;
    const double span = gathered.time, velocity_walk = gathered.accel_variance, attitude_walk = gathered.gyro_variance;
    const double force = span > 0.0 ? gathered.force.norm() / span : 0.0;
    if (!walk.filter.propagate_covariance(model_, phi)) return;
    for (CarriedFix& c : walk.carried)
        if (c.left > 0) carry(c, phi);
    walk.ranges.watch.propagate(phi);
    if (model_.layout.phase >= 0) walk.filter.since_phases.follow(phi, span, velocity_walk, attitude_walk, force);
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
        if (valid < now - tolerance) continue;   // before the start
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
    }
}

template <class Frame>
void Pass<Frame>::advance(Walk<Frame>& walk, std::size_t last, Observer& observer) const {
    for (; walk.increment <= last && walk.increment < data_.imu.increments.size(); ++walk.increment) {
        while (walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].last < walk.increment) ++walk.bridge;
        const bool bridged = walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].first <= walk.increment;
        const ImuIncrement& whole = data_.imu.increments[walk.increment];
        BridgeNoise noise = bridged ? data_.imu.bridges[walk.bridge].noise : BridgeNoise{};
        if (vibrates_) {
            if (!bridged) walk.vibration.add(whole);
            noise = with_vibration(model_, walk.vibration, noise);
        }
        constexpr double recently = 0.5;   // s
        noise.standing = (whole.time - walk.last_still).seconds() < recently;
        const ImuIncrement inc = run_to_events(walk, whole, noise, observer);
        if (inc.dt > 0.0) step(walk, inc, noise, observer);
        if (bridged) walk.suspect = walk.filter.time();
        if (settings_.loose_kind == LooseKind::Aggressive) carry_on(walk, observer);
        constrain(walk, observer);
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
}

template <class Frame>
bool Pass<Frame>::uses(AidKind kind) const {
    // With ranges the receiver's own fixes would be used twice: they are what an outage without a reference is judged by.
    return !is_sub_vector(kind) || !uses_ranges(settings_.coupling);
}

/// Variances of what a row that is linear in the latency leaves out: its error times that of the velocity (in positions) and of the
/// acceleration, which errs with the level (in velocities). After an outage, and before the level is known, that is more than the
/// receiver's noise, and taken for nothing it would teach a latency (Maybeck 1982, section 12.3: modified second-order filter).
template <class Frame>
Eigen::Matrix<double, 9, 1> Pass<Frame>::of_latency(const InertialFilter<Frame>& filter, const Estimate& e, int state) const {
    const Matrix9 P = filter.local_covariance(model_);
    const Eigen::Vector3d f_n = e.a_n - earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).g_n;
    const Eigen::Matrix3d by_attitude = math::skew(f_n), attitude = P.template block<3, 3>(Layout::attitude, Layout::attitude);
    Eigen::Matrix<double, 9, 1> out = Eigen::Matrix<double, 9, 1>::Zero();
    out.template segment<3>(Layout::position) = P.diagonal().template segment<3>(Layout::velocity);
    out.template segment<3>(Layout::velocity) = (by_attitude * attitude * by_attitude.transpose()).diagonal();
    return filter.P(state, state) * out;
}

template <class Frame>
Measurement Pass<Frame>::measurement_of(const InertialFilter<Frame>& filter, const Event& event) const {
    const Estimate e = filter.estimate(model_);
    const Components use{(event.components & 1) != 0, (event.components & 2) != 0, (event.components & 4) != 0};
    const sensor::GnssErrorModel& slow = settings_.gnss.errors;
    switch (event.kind) {
        case AidKind::GnssPosition: {
            const FixNoise& noise = data_.fix_noise[event.index];
            // what the layout has no states for is part of the noise
            Eigen::Vector3d variance = (model_.layout.gnss_position < 0 ? noise.position : noise.white_position).cwiseAbs2();
            if (event.constellation_change) variance += slow.change_white_position.cwiseAbs2();
            // Where the latency had to be found it jitters from fix to fix as well, by some milliseconds.
            const double jitter = settings_.gnss.jitter.value_or(std::min(0.4 * settings_.gnss.latency_std, 0.01));   // s
            variance += jitter * jitter * e.nav.v_eb_n.cwiseAbs2();
            if (model_.layout.gnss_latency >= 0) variance += of_latency(filter, e, model_.layout.gnss_latency).template segment<3>(Layout::position);
            return gnss_position(e, data_.recording->gnss[event.index].position, variance, settings_.gnss.lever_arm_b, use);
        }
        case AidKind::GnssVelocity: {
            const FixNoise& noise = data_.fix_noise[event.index];
            Eigen::Vector3d variance = (model_.layout.gnss_velocity < 0 ? noise.velocity : noise.white_velocity).cwiseAbs2();
            if (event.constellation_change) variance += slow.change_white_velocity.cwiseAbs2();
            // A latency that had to be found jitters from fix to fix; without a state it is off by what fits of it are good for.
            const GnssSettings& g = settings_.gnss;
            const bool own = model_.layout.gnss_velocity_latency >= 0;
            const double off = g.jitter.value_or(own ? std::min(0.4 * g.velocity_latency_std, 0.01) : std::min(g.latency_std, 0.015));   // s
            variance += off * off * e.a_n.cwiseAbs2();
            const int latency = own ? model_.layout.gnss_velocity_latency : g.velocity_latency ? -1 : model_.layout.gnss_latency;
            if (latency >= 0) variance += of_latency(filter, e, latency).template segment<3>(Layout::velocity);
            return gnss_velocity(e, data_.recording->gnss[event.index].velocity_n, variance, g.lever_arm_b, latency, use);
        }
        case AidKind::Baro:
            return baro_height(e, data_.recording->baro[event.index].height, settings_.baro.std * settings_.baro.std);
        case AidKind::Mag: {
            const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings_.imu.mounting_rpy) * settings_.imu.C_bs;
            return magnetic_azimuth(e, C_bs * data_.recording->mag[event.index].field_b, data_.declination,
                                    settings_.mag.heading_std * settings_.mag.heading_std);
        }
        case AidKind::Odometer: {
            const OdometerSample& s = data_.recording->odometer[event.index];
            const double std = s.std > 0.0 ? s.std : settings_.odometer.std;
            return odometer_speed(e, s.speed, std * std);
        }
        case AidKind::Heading: {
            const HeadingSample& s = data_.recording->heading[event.index];
            const double std = s.std > 0.0 ? s.std : settings_.heading.std;
            return heading_of_body(e, s.heading, std * std);
        }
        case AidKind::Gauges:
            return gauge_heights(e, data_.recording->gauges[event.index].height, settings_.gauges.std * settings_.gauges.std,
                                 settings_.gauges.lever_arms_b);
        case AidKind::BodyVelocity:
            return body_velocity(e, data_.recording->body_velocity[event.index].velocity_b, settings_.log.std * settings_.log.std,
                                 settings_.log.lever_arm_b);
        default: return {};
    }
}

template <class Frame>
void Pass<Frame>::recover(Walk<Frame>& walk, Channel channel, const Measurement& local) const {
    // The estimate is wrong by about the innovation: say so in the covariance, isotropically, and in what may have caused it.
    if (channel.kind == AidKind::Baro && model_.layout.baro_bias >= 0) {
        walk.filter.P(model_.layout.baro_bias, model_.layout.baro_bias) += local.innovation.squaredNorm();
        return;
    }
    const GateState& gate = walk.gates[channel.gate()];
    Opening opening;
    opening.span = (walk.filter.time() - gate.since).seconds();
    if (channel.kind == AidKind::GnssPosition) {
        opening.position = local.innovation;
        opening.rate = gate.rate;
    } else {
        opening.velocity = local.innovation;
    }
    open(walk, opening);
}

template <class Frame>
AidRecord Pass<Frame>::try_update(Walk<Frame>& walk, Channel channel, const Measurement& local, Time stamp, bool withheld,
                                  Observer& observer) const {
    const AidKind kind = channel.kind;
    AidRecord record;
    record.time = walk.filter.time();
    record.stamp = stamp;
    record.kind = kind;
    record.dof = local.dof;
    record.innovation = local.innovation;
    const Measurement m = walk.filter.to_own(model_, local);
    const Eigen::Matrix3d S = walk.filter.innovation_covariance(m);
    for (int i = 0; i < m.dof; ++i) {
        record.sigma(i) = std::sqrt(S(i, i));
        record.sigma_state(i) = std::sqrt(std::max(0.0, S(i, i) - m.variance(i)));
    }
    // Unused components have zero innovations and unit variance: they add nothing.
    record.nis = m.innovation.dot(S.inverse() * m.innovation);
    if (!std::isfinite(record.nis))
        throw computation_error(fmt::format("the filter diverged at {:.3f} s, channel {}", record.time.seconds(), info_of(kind).name),
                                "check the IMU's units and axes with `schuler inspect`");
    if (withheld) {
        record.status = AidStatus::Withheld;
        return record;
    }
    const double drift = std::sqrt(walk.filter.P.diagonal().template segment<3>(kind == AidKind::GnssVelocity ? 6 : 3).maxCoeff()) *
                         (kind == AidKind::GnssVelocity ? 10.0 : 1.0);
    Eigen::Vector3d used = Eigen::Vector3d::Zero();
    for (int i = 0; i < m.dof; ++i) used(i) = std::sqrt(m.variance(i));
    if (settings_.integrity.use && is_sub_vector(kind)) {
        const Examined examined{kind, record.time, m.innovation, used, record.sigma.squaredNorm()};
        record.status = examine(walk, channel, record, examined, observer);
        if (record.status == AidStatus::Accepted && !use(walk, channel, local, m, stamp, observer)) record.status = AidStatus::Withheld;
        return record;
    }
    if (contests(kind)) {
        Measurement moved = local, own = m;
        record.status = judge(walk, channel, record, moved, own, observer);
        if (record.status == AidStatus::Accepted && !use(walk, channel, moved, own, stamp, observer)) record.status = AidStatus::Withheld;
        return record;
    }
    const GateDecision decision = decide(walk.gates[channel.gate()], data_.gates, record.time, m.dof, record.nis, m.innovation, used, drift);
    if (decision == GateDecision::Reject || (decision == GateDecision::Recover && !is_sub_vector(kind) && kind != AidKind::Baro)) {
        record.status = AidStatus::Rejected;
        return record;
    }
    if (decision == GateDecision::Recover) recover(walk, channel, local);
    record.status = use(walk, channel, local, m, stamp, observer) ? AidStatus::Accepted : AidStatus::Withheld;
    return record;
}

template <class Frame>
void Pass<Frame>::change_constellation(Walk<Frame>& walk, const Event& event) const {
    const bool position = event.kind == AidKind::GnssPosition;
    const int offset = position ? model_.layout.gnss_position : model_.layout.gnss_velocity;
    if (offset < 0) return;
    const Eigen::Vector3d& jump = position ? model_.gnss.change_correlated_position : model_.gnss.change_correlated_velocity;
    for (int axis = 0; axis < 3; ++axis)
        if ((event.components >> axis & 1) != 0) walk.filter.P(offset + axis, offset + axis) += jump(axis) * jump(axis);
}

template <class Frame>
void Pass<Frame>::process(Walk<Frame>& walk, const Event& event, Observer& observer) const {
    // The table of an outage is made before the epoch's own update, with the height even where that has an age of its own.
    const bool in_table = event.outage >= 0 && event.kind == AidKind::GnssPosition && (event.components & 3) == 3;
    if (!uses(event.kind) && !in_table) return;
    propagate_covariance(walk, observer);
    if (event.constellation_change) change_constellation(walk, event);
    if (!walk.shadows.empty() && is_sub_vector(event.kind) && !event.withheld) look_back(walk, event, observer);
    const Measurement local = measurement_of(walk.filter, event);
    if (local.dof == 0) return;
    if (in_table) {
        Observer nobody;
        Event whole = event;
        if (std::isfinite(data_.recording->gnss[event.index].position.h)) whole.components = 7;
        const Measurement all = measurement_of(walk.filter, whole);
        observer.outage_epoch(walk, event, all, try_update(walk, event.kind, all, event.stamp, true, nobody));
    }
    if (!uses(event.kind)) return;
    AidRecord record = try_update(walk, {event.kind, event.components}, local, event.stamp, event.withheld, observer);
    if (record.status == AidStatus::Accepted && event.kind == AidKind::Baro) {
        for (Shadow<Frame>& s : walk.shadows) {
            if (!s.alive) continue;
            estim::Transition phi;
            (void)s.filter.propagate_covariance(model_, phi);
            (void)s.filter.update(model_, s.filter.to_own(model_, measurement_of(s.filter, event)), [](const auto&) {});
        }
    }
    if (record.status == AidStatus::Accepted && event.kind == AidKind::GnssPosition) renew_shadows(walk);
    if (is_sub_vector(event.kind)) unpack(record, event.components);
    observer.aid(record);
    observer.measured(walk, event, record);
}

template <class Frame>
void Pass<Frame>::process(Walk<Frame>& walk, const RangeEpoch& epoch, Observer& observer) const {
    propagate_covariance(walk, observer);
    const RangingLog& log = data_.recording->ranges;
    RangeListener* listener = observer.records() ? &observer : nullptr;
    if (in_outage(settings_, data_.origin, epoch.time)) {   // satellites are withheld, stations are not
        std::array<RangeSample, RangeEpochWork::most> stations;
        std::size_t n = 0;
        for (const RangeSample& s : log.of(epoch))
            if (log.sources[s.source].station && n < stations.size()) stations[n++] = s;
        (void)update_with_ranges_(walk.filter, walk.ranges, log, {stations.data(), n}, listener);
    } else {
        (void)update_with_ranges_(walk.filter, walk.ranges, log, log.of(epoch), listener);
    }
    if (!walk.filter.P.diagonal().allFinite())
        throw computation_error(fmt::format("the filter diverged at {:.3f} s, channel {}", walk.filter.time().seconds(),
                                            info_of(AidKind::Pseudorange).name),
                                "check the ranges and the IMU with `schuler inspect`");
    observer.ranges(walk, epoch);
}

template <class Frame>
void Pass<Frame>::stand_still(Walk<Frame>& walk, Observer& observer) const {
    const Time now = walk.filter.time();
    const AidSettings& aids = settings_.aids;
    for (; walk.still < data_.still.windows.size() && data_.still.windows[walk.still].end <= now; ++walk.still) {
        const StillWindow& w = data_.still.windows[walk.still];
        if (!aids.zero_velocity || (now - w.end).seconds() > 0.1) continue;
        walk.last_still = now;
        propagate_covariance(walk, observer);
        const AidRecord velocity = try_update(walk, AidKind::ZeroVelocity, zero_velocity(walk.filter.estimate(model_), aids.zero_velocity_std),
                                              now, false, observer);
        observer.aid(velocity);
        if (velocity.status != AidStatus::Accepted) continue;
        const double variance = model_.gyro_psd / w.length + aids.zero_rate_std * aids.zero_rate_std;
        observer.aid(try_update(walk, AidKind::ZeroRate, zero_rate(walk.filter.estimate(model_), w.mean_rate_b, variance), now, false,
                                observer));
    }
}

template <class Frame>
void Pass<Frame>::constrain(Walk<Frame>& walk, Observer& observer) const {
    stand_still(walk, observer);
    const Time now = walk.filter.time();
    const AidSettings& aids = settings_.aids;
    const bool imposed = aids.nonholonomic || walk.wheels.verdict == WheelEvidence::Verdict::Wheels;
    const bool open = aids.nonholonomic_auto && walk.wheels.verdict == WheelEvidence::Verdict::Open;
    if (!(imposed || open) || now < walk.next_constraint) return;
    walk.next_constraint = now + Duration::from_seconds(1.0 / aids.constraint_rate);
    if ((now - walk.last_still).seconds() < 0.3) return;
    propagate_covariance(walk, observer);
    const Estimate e = walk.filter.estimate(model_);
    if (!imposed) {
        observe_wheels(walk, e);
        return;
    }
    const double speed = e.nav.v_eb_n.norm();
    const double turn = std::abs(e.w_ib_b.z());
    // Tyres slip in proportion to the sideways acceleration, speed times turn rate. What was seen to scatter, scatters.
    double lateral = aids.nonholonomic_std_lateral + 0.02 * speed * turn, vertical = aids.nonholonomic_std_vertical;
    if (!aids.nonholonomic) {
        lateral = 0.03 + 2.0 * walk.wheels.std_side() * speed;
        vertical = 0.03 + 2.0 * walk.wheels.std_down() * speed;
    }
    observer.aid(try_update(walk, AidKind::Nonholonomic, nonholonomic(e, lateral, vertical), now, false, observer));
}

template <class Frame>
void Pass<Frame>::observe_wheels(Walk<Frame>& walk, const Estimate& e) const {
    InertialFilter<Frame>& f = walk.filter;
    const int mounting = model_.layout.mounting;
    const double along = data_.backward ? -1.0 : 1.0;   // wheels roll forward in the time of the log
    const Eigen::Vector3d v_b = along * (e.C_nb.transpose() * e.nav.v_eb_n);
    const bool good = f.P.diagonal().template segment<3>(Layout::velocity).maxCoeff() < 0.05 &&
                      f.P.diagonal().template segment<3>(Layout::attitude).maxCoeff() < 4e-4;
    if (v_b.x() < 3.0 || !good) return;
    walk.wheels.add(v_b, along * e.w_ib_b.z(), 1.0 / settings_.aids.constraint_rate);
    if (walk.wheels.verdict != WheelEvidence::Verdict::Wheels) return;
    f.parameters(mounting) = -std::atan(walk.wheels.mean_down);
    f.parameters(mounting + 1) = std::atan(walk.wheels.mean_side);
    f.P.diagonal().template segment<2>(mounting).setConstant(2.5e-5);
    f.P(model_.layout.axle, model_.layout.axle) = 1.5 * 1.5;
}

template class Pass<GeographicFrame>;
template class Pass<EarthFixedFrame>;

}  // namespace schuler::filter
