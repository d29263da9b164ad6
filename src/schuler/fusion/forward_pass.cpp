// The walk along the timeline; instantiated for both frames and the sizes of filters.

#include "schuler/fusion/forward_pass.h"

#include "schuler/core/error.h"
#include "schuler/fusion/aid/constraint.h"
#include "schuler/fusion/aid/environment.h"
#include "schuler/fusion/aid/gnss.h"
#include "schuler/fusion/detail/coupling_impl.h"

#include <Eigen/LU>
#include <fmt/format.h>

#include <cmath>

namespace schuler::fusion {

template <class Frame, int N>
Measurement<N> to_filter(const InertialModel<N>& model, const InertialFilter<Frame, N>& filter, const LocalMeasurement& local) {
    Measurement<N> m;
    m.dof = local.dof;
    m.innovation = local.innovation;
    m.variance = local.variance;
    m.rows = local.rows.template topRows<N>();
    if constexpr (!Frame::errors_are_geographic) {
        const Eigen::Matrix<double, 9, 3> rows = filter.to_local_level(model).transpose() * local.rows.template topRows<9>();
        m.rows.template topRows<9>() = rows;
    }
    return m;
}

template <class Frame, int N>
Estimate estimate_of(const InertialModel<N>& model, const InertialFilter<Frame, N>& filter) {
    Estimate e;
    e.earth = model.earth;
    e.layout = model.layout;
    const bool fed_back = model.loop == Loop::Closed;
    e.nav = Frame::geographic(model.earth, filter.estimated(model));
    if (Frame::errors_are_geographic && fed_back)
        e.C_nb = filter.C;
    else
        e.C_nb = e.nav.q_nb.toRotationMatrix();
    e.w_ib_b = filter.w_ib_b;
    if (!fed_back) e.w_ib_b += filter.error.template segment<3>(Layout::gyro_bias);
    e.parameters.setZero();
    e.parameters.template head<N>() = filter.estimated_parameters();
    return e;
}

namespace {

/// Name of a channel for messages.
const char* channel_name(AidKind kind) {
    switch (kind) {
        case AidKind::GnssPosition: return "GNSS position";
        case AidKind::GnssVelocity: return "GNSS velocity";
        case AidKind::Baro: return "barometer";
        case AidKind::Mag: return "magnetometer";
        case AidKind::ZeroVelocity: return "zero velocity";
        case AidKind::ZeroRate: return "zero rate";
        case AidKind::Nonholonomic: return "vehicle constraint";
        case AidKind::Pseudorange: return "pseudorange";
        case AidKind::RangeRate: return "range rate";
    }
    return "?";
}

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

}  // namespace

template <class Frame, int N>
void ForwardPass<Frame, N>::step(Walk<Frame, N>& walk, const ImuIncrement& increment, const BridgeNoise& noise,
                                 Observer& observer) const {
    estim::Transition<N> phi;
    for (Shadow<Frame, N>& s : walk.shadows)
        if (s.alive) s.filter.propagate(model_, increment, noise, phi);
    walk.filter.propagate(model_, increment, noise, phi);
    for (CarriedFix<N>& c : walk.carried)
        if (c.left > 0) c.corrected = phi.times(c.corrected);
    observer.step(phi);
}

template <class Frame, int N>
void ForwardPass<Frame, N>::advance(Walk<Frame, N>& walk, std::size_t last, Observer& observer) const {
    const Duration tolerance{100'000};   // events this near to an increment's end need no split of it
    const Duration output_step =
        settings_.output_rate > 0.0 ? Duration::from_seconds(1.0 / settings_.output_rate) : Duration{0};
    for (; walk.increment <= last && walk.increment < data_.imu.increments.size(); ++walk.increment) {
        ImuIncrement inc = data_.imu.increments[walk.increment];
        while (walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].last < walk.increment) ++walk.bridge;
        const bool bridged = walk.bridge < data_.imu.bridges.size() && data_.imu.bridges[walk.bridge].first <= walk.increment;
        const BridgeNoise noise = bridged ? data_.imu.bridges[walk.bridge].noise : BridgeNoise{};

        for (; walk.event < data_.events.size() && data_.events[walk.event].valid < inc.time + tolerance; ++walk.event) {
            const Event& event = data_.events[walk.event];
            const Time now = walk.filter.time();
            if (event.valid < now - tolerance) continue;   // before the start
            const double part = (event.valid - now).seconds(), rest = (inc.time - event.valid).seconds();
            if (part > tolerance.seconds() && rest > tolerance.seconds()) {
                const double share = part / inc.dt;
                step(walk, {event.valid, part, share * inc.dtheta, share * inc.dv}, noise, observer);
                inc = {inc.time, rest, (1.0 - share) * inc.dtheta, (1.0 - share) * inc.dv};
            } else if (rest <= tolerance.seconds() && now < inc.time) {
                step(walk, inc, noise, observer);
                inc.dt = 0.0;
            }
            meet(walk, event, observer);
        }
        if (inc.dt > 0.0) step(walk, inc, noise, observer);
        if (settings_.loose_kind == LooseKind::Aggressive) carry_on(walk, observer);
        constrain(walk, observer);
        if (model_.loop == Loop::Mixed && inc.time >= walk.next_feedback) {
            walk.filter.feed_back(model_);
            for (Shadow<Frame, N>& s : walk.shadows) s.filter.feed_back(model_);
            walk.next_feedback = inc.time + walk.feedback_period;
        }
        if (inc.time >= walk.next_output) {
            observer.output(walk.filter, inc.time);
            ++walk.outputs;
            if (output_step.ns > 0)
                while (walk.next_output <= inc.time) walk.next_output = walk.next_output + output_step;
        }
    }
}

template <class Frame, int N>
LocalMeasurement ForwardPass<Frame, N>::measurement_of(const InertialFilter<Frame, N>& filter, const Event& event) const {
    const Estimate e = estimate_of(model_, filter);
    const Components use{(event.components & 1) != 0, (event.components & 2) != 0, (event.components & 4) != 0};
    const sensor::GnssErrorModel& slow = settings_.gnss.errors;
    switch (event.kind) {
        case AidKind::GnssPosition: {
            Eigen::Vector3d variance = data_.fix_noise[event.index].white_position.cwiseAbs2();
            if (event.constellation_change) variance += slow.change_white_position.cwiseAbs2();
            return gnss_position(e, data_.recording->gnss[event.index].position, variance, settings_.gnss.lever_arm_b, use);
        }
        case AidKind::GnssVelocity: {
            Eigen::Vector3d variance = data_.fix_noise[event.index].white_velocity.cwiseAbs2();
            if (event.constellation_change) variance += slow.change_white_velocity.cwiseAbs2();
            return gnss_velocity(e, data_.recording->gnss[event.index].velocity_n, variance, settings_.gnss.lever_arm_b, use);
        }
        case AidKind::Baro:
            return baro_height(e, data_.recording->baro[event.index].height, settings_.baro.std * settings_.baro.std);
        case AidKind::Mag: {
            const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings_.imu.mounting_rpy) * settings_.imu.C_bs;
            return magnetic_azimuth(e, C_bs * data_.recording->mag[event.index].field_b, data_.declination,
                                    settings_.mag.heading_std * settings_.mag.heading_std);
        }
        default: return {};
    }
}

template <class Frame, int N>
void ForwardPass<Frame, N>::recover(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local) const {
    // The estimate is wrong by about the innovation: say so in the covariance, isotropically, and in what may have caused it.
    const double size2 = local.innovation.squaredNorm();
    auto& P = walk.filter.P;
    const int block = channel.kind == AidKind::GnssVelocity ? Layout::velocity : Layout::position;
    P.diagonal().template segment<3>(block).array() += size2;
    const double span = std::max(1.0, settings_.aids.recovery_time);
    if (channel.kind == AidKind::GnssPosition)
        P.diagonal().template segment<3>(Layout::velocity).array() +=
            std::max(size2 / (span * span), walk.gates[channel.gate()].rate.squaredNorm());
}

template <class Frame, int N>
AidRecord ForwardPass<Frame, N>::try_update(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local, Time stamp,
                                            bool withheld, Observer& observer) const {
    const AidKind kind = channel.kind;
    AidRecord record;
    record.time = walk.filter.time();
    record.stamp = stamp;
    record.kind = kind;
    record.dof = local.dof;
    record.innovation = local.innovation;
    Measurement<N> m = to_filter(model_, walk.filter, local);
    const Eigen::Matrix3d S = walk.filter.innovation_covariance(m);
    for (int i = 0; i < m.dof; ++i) {
        record.sigma(i) = std::sqrt(S(i, i));
        record.sigma_state(i) = std::sqrt(std::max(0.0, S(i, i) - m.variance(i)));
    }
    // Unused components have zero rows, innovations and unit variance: they add nothing.
    record.nis = m.innovation.dot(S.inverse() * m.innovation);
    if (!std::isfinite(record.nis))
        throw computation_error(fmt::format("the filter diverged at {:.3f} s, channel {}", record.time.seconds(), channel_name(kind)),
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
    const GateDecision decision = decide(walk.gates[channel.gate()], data_.gates, record.time, m.dof, record.nis, m.innovation, used, drift);
    const bool gnss = kind == AidKind::GnssPosition || kind == AidKind::GnssVelocity || kind == AidKind::Baro;
    if (decision == GateDecision::Reject || (decision == GateDecision::Recover && !gnss)) {
        record.status = AidStatus::Rejected;
        return record;
    }
    if (decision == GateDecision::Recover) recover(walk, channel, local);
    record.status = use(walk, channel, local, m, stamp, observer) ? AidStatus::Accepted : AidStatus::Withheld;
    return record;
}

template <class Frame, int N>
void ForwardPass<Frame, N>::change_constellation(Walk<Frame, N>& walk, const Event& event) const {
    const bool position = event.kind == AidKind::GnssPosition;
    const int offset = position ? model_.layout.gnss_position : model_.layout.gnss_velocity;
    if (offset < 0) return;
    const Eigen::Vector3d& jump = position ? model_.gnss.change_correlated_position : model_.gnss.change_correlated_velocity;
    for (int axis = 0; axis < 3; ++axis)
        if ((event.components >> axis & 1) != 0) walk.filter.P(offset + axis, offset + axis) += jump(axis) * jump(axis);
}

template <class Frame, int N>
void ForwardPass<Frame, N>::meet(Walk<Frame, N>& walk, const Event& event, Observer& observer) const {
    if (event.constellation_change) change_constellation(walk, event);
    if (!walk.shadows.empty() && is_sub_vector(event.kind) && !event.withheld) look_back(walk, event, observer);
    const LocalMeasurement local = measurement_of(walk.filter, event);
    if (local.dof == 0) return;
    // The table of an outage is made before the epoch's own update, with the height even where that has an age of its own.
    if (event.outage >= 0 && event.kind == AidKind::GnssPosition && (event.components & 3) == 3) {
        Observer nobody;
        Event whole = event;
        if (std::isfinite(data_.recording->gnss[event.index].position.h)) whole.components = 7;
        const LocalMeasurement all = measurement_of(walk.filter, whole);
        observer.outage_epoch(walk.filter, event, all, try_update(walk, event.kind, all, event.stamp, true, nobody));
    }
    AidRecord record = try_update(walk, {event.kind, event.components}, local, event.stamp, event.withheld, observer);
    if (record.status == AidStatus::Accepted && event.kind == AidKind::Baro) {
        for (Shadow<Frame, N>& s : walk.shadows)
            if (s.alive) s.filter.update(model_, to_filter(model_, s.filter, measurement_of(s.filter, event)), [](const auto&) {});
    }
    if (record.status == AidStatus::Accepted && event.kind == AidKind::GnssPosition) renew_shadows(walk);
    if (is_sub_vector(event.kind)) unpack(record, event.components);
    observer.aid(record);
}

template <class Frame, int N>
void ForwardPass<Frame, N>::constrain(Walk<Frame, N>& walk, Observer& observer) const {
    const Time now = walk.filter.time();
    const AidSettings& aids = settings_.aids;
    for (; walk.still < data_.still.windows.size() && data_.still.windows[walk.still].end <= now; ++walk.still) {
        const StillWindow& w = data_.still.windows[walk.still];
        if (!aids.zero_velocity || (now - w.end).seconds() > 0.1) continue;
        walk.last_still = now;
        const Estimate e = estimate_of(model_, walk.filter);
        const AidRecord velocity =
            try_update(walk, AidKind::ZeroVelocity, zero_velocity(e, aids.zero_velocity_std), now, false, observer);
        observer.aid(velocity);
        if (velocity.status != AidStatus::Accepted) continue;
        const double variance = model_.gyro_psd / w.length + aids.zero_rate_std * aids.zero_rate_std;
        observer.aid(try_update(walk, AidKind::ZeroRate,
                                zero_rate(estimate_of(model_, walk.filter), w.mean_rate_b, variance), now, false, observer));
    }
    const bool imposed = aids.nonholonomic || walk.wheels.verdict == WheelEvidence::Verdict::Wheels;
    const bool open = aids.nonholonomic_auto && walk.wheels.verdict == WheelEvidence::Verdict::Open;
    if ((imposed || open) && now >= walk.next_constraint) {
        walk.next_constraint = now + Duration::from_seconds(1.0 / aids.constraint_rate);
        if ((now - walk.last_still).seconds() < 0.3) return;
        const Estimate e = estimate_of(model_, walk.filter);
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
}

template <class Frame, int N>
void ForwardPass<Frame, N>::observe_wheels(Walk<Frame, N>& walk, const Estimate& e) const {
    InertialFilter<Frame, N>& f = walk.filter;
    const int mounting = model_.layout.mounting;
    const Eigen::Vector3d v_b = e.C_nb.transpose() * e.nav.v_eb_n;
    const bool good = f.P.diagonal().template segment<3>(Layout::velocity).maxCoeff() < 0.05 &&
                      f.P.diagonal().template segment<3>(Layout::attitude).maxCoeff() < 4e-4;
    if (v_b.x() < 3.0 || !good) return;
    walk.wheels.add(v_b, e.w_ib_b.z(), 1.0 / settings_.aids.constraint_rate);
    if (walk.wheels.verdict != WheelEvidence::Verdict::Wheels) return;
    f.parameters(mounting) = -std::atan(walk.wheels.mean_down);
    f.parameters(mounting + 1) = std::atan(walk.wheels.mean_side);
    f.P.diagonal().template segment<2>(mounting).setConstant(2.5e-5);
    f.P(model_.layout.axle, model_.layout.axle) = 1.5 * 1.5;
}

#define SCHULER_INSTANTIATE(Frame, N)                                                                                     \
    template Measurement<N> to_filter(const InertialModel<N>&, const InertialFilter<Frame, N>&, const LocalMeasurement&); \
    template Estimate estimate_of(const InertialModel<N>&, const InertialFilter<Frame, N>&);                              \
    template class ForwardPass<Frame, N>;
SCHULER_INSTANTIATE(GeographicFrame, 16)
SCHULER_INSTANTIATE(GeographicFrame, 24)
SCHULER_INSTANTIATE(GeographicFrame, 44)
SCHULER_INSTANTIATE(EarthFixedFrame, 16)
SCHULER_INSTANTIATE(EarthFixedFrame, 24)
SCHULER_INSTANTIATE(EarthFixedFrame, 44)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::fusion
