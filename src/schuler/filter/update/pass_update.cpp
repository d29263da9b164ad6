// Measurement updates: the measurement of a source with its gate; instantiated for both frames.

#include "schuler/filter/update/pass.h"

#include "schuler/core/error.h"
#include "schuler/filter/measurement/body_velocity.h"
#include "schuler/filter/measurement/environment.h"
#include "schuler/filter/measurement/gauge.h"
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/measurement/odometer.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

/// Variances of terms neglected in a row linear in the latency: its error times that of the velocity (in positions) and of the
/// acceleration, which depends on the level (in velocities), and the change of velocity and acceleration within it. After an outage,
/// before the level is known, and under vibration they exceed the receiver's noise; neglecting them would bias the latency, and the
/// heading with it (Maybeck 1982, section 12.3: modified second-order filter).
template <class Frame>
Eigen::Matrix<double, 9, 1> Pass<Frame>::of_latency(const InertialFilter<Frame>& filter, const Estimate& e, int state) const {
    const Matrix9 P = filter.local_covariance(model_);
    const Eigen::Vector3d f_n = e.a_n - earth::terms_at(e.earth, e.nav.position, e.nav.v_eb_n).g_n;
    const Eigen::Matrix3d by_attitude = math::skew(f_n), attitude = P.template block<3, 3>(Layout::attitude, Layout::attitude);
    Eigen::Matrix<double, 9, 1> out = Eigen::Matrix<double, 9, 1>::Zero();
    out.template segment<3>(Layout::position) = P.diagonal().template segment<3>(Layout::velocity);
    out.template segment<3>(Layout::velocity) = (by_attitude * attitude * by_attitude.transpose()).diagonal();
    const double variance = filter.P(state, state), estimate = e.parameters(state);
    out *= variance;
    // The fourth moment of a Gaussian latency is 3 variance^2. The velocity changes by half of what the acceleration changes within it.
    out.template segment<3>(Layout::position) += 0.75 * variance * variance * e.a_n.cwiseAbs2();
    const double time2 = variance + estimate * estimate;
    out.template segment<3>(Layout::velocity) += time2 * filter.force_change_square(model_, 0.75 * time2);
    return out;
}

template <class Frame>
Eigen::Vector3d Pass<Frame>::position_variance(const InertialFilter<Frame>& filter, const Estimate& e, const Event& event) const {
    const FixNoise& noise = data_.fix_noise[event.index];
    // errors without states are part of the noise
    const double lasting = event.outage < 0 ? data_.recording->gnss[event.index].lasting : 1.0;  // compared: by itself
    Eigen::Vector3d variance = lasting * (model_.layout.gnss_position < 0 ? noise.position : noise.white_position).cwiseAbs2();
    if (event.constellation_change) variance += settings_.gnss.errors.change_white_position.cwiseAbs2();
    // An estimated latency also varies from fix to fix, by some milliseconds.
    const double jitter = settings_.gnss.jitter.value_or(std::min(0.4 * settings_.gnss.latency_std, 0.01));  // s
    variance += jitter * jitter * e.nav.v_eb_n.cwiseAbs2();
    if (model_.layout.gnss_latency >= 0)
        variance += of_latency(filter, e, model_.layout.gnss_latency).template segment<3>(Layout::position);
    return variance;
}

template <class Frame>
Eigen::Vector3d Pass<Frame>::velocity_variance(const InertialFilter<Frame>& filter, const Estimate& e, const Event& event,
                                               int latency) const {
    const FixNoise& noise = data_.fix_noise[event.index];
    Eigen::Vector3d variance = (model_.layout.gnss_velocity < 0 ? noise.velocity : noise.white_velocity).cwiseAbs2();
    if (event.constellation_change) variance += settings_.gnss.errors.change_white_velocity.cwiseAbs2();
    // An estimated latency varies from fix to fix; without a state its error is that of the fits.
    const GnssSettings& g = settings_.gnss;
    const bool own = model_.layout.gnss_velocity_latency >= 0;
    const double off =
        g.jitter.value_or(own ? std::min(0.4 * g.velocity_latency_std, 0.01) : std::min(g.latency_std, 0.015));  // s
    variance += off * off * e.a_n.cwiseAbs2();
    if (latency >= 0) variance += of_latency(filter, e, latency).template segment<3>(Layout::velocity);
    return variance;
}

template <class Frame>
Measurement Pass<Frame>::measurement_of(const InertialFilter<Frame>& filter, const Event& event) const {
    const Estimate e = filter.estimate(model_);
    const GnssSettings& g = settings_.gnss;
    const Layout& L = model_.layout;
    const Components use{(event.components & 1) != 0, (event.components & 2) != 0, (event.components & 4) != 0};
    if (event.kind == MeasurementKind::GnssPosition)
        return gnss_position(e, data_.recording->gnss[event.index].position, position_variance(filter, e, event), g.lever_arm_b,
                             use);
    if (event.kind == MeasurementKind::GnssVelocity) {
        const int latency = L.gnss_velocity_latency >= 0 ? L.gnss_velocity_latency : g.velocity_latency ? -1 : L.gnss_latency;
        return gnss_velocity(e, data_.recording->gnss[event.index].velocity_n, velocity_variance(filter, e, event, latency),
                             g.lever_arm_b, latency, use);
    }
    Measurement m;
    for_each_instrument([&](const auto& instrument) {
        if (instrument.kind == event.kind)
            m = filter::measurement_of(e, (data_.recording->*instrument.log)[event.index], settings_);
    });
    return m;
}

template <class Frame>
void Pass<Frame>::recover(FilterRun<Frame>& run, Channel channel, const Measurement& local) const {
    // The estimate is wrong by about the innovation: increase the covariance accordingly, isotropically, and that of the cause.
    if (channel.kind == MeasurementKind::Baro && model_.layout.baro_bias >= 0) {
        run.filter.P(model_.layout.baro_bias, model_.layout.baro_bias) += local.innovation.squaredNorm();
        return;
    }
    const GateState& gate = run.gates[channel.gate()];
    Opening opening;
    opening.span = (run.filter.time() - gate.since).seconds();
    if (channel.kind == MeasurementKind::GnssPosition) {
        opening.position = local.innovation;
        opening.rate = gate.rate;
    } else {
        opening.velocity = local.innovation;
    }
    open(run, opening);
}

template <class Frame>
MeasurementRecord Pass<Frame>::try_update(FilterRun<Frame>& run, Channel channel, const Measurement& local, Time stamp,
                                          bool withheld, Observer& observer) const {
    const MeasurementKind kind = channel.kind;
    MeasurementRecord record;
    record.time = run.filter.time();
    record.stamp = stamp;
    record.kind = kind;
    record.dof = local.dof;
    record.innovation = local.innovation;
    const Measurement m = run.filter.to_own(model_, local);
    const Eigen::Matrix3d S = examined_covariance(run.filter, run.second_order, m);
    for (int i = 0; i < m.dof; ++i) {
        record.sigma(i) = std::sqrt(S(i, i));
        record.sigma_state(i) = std::sqrt(std::max(0.0, S(i, i) - m.variance(i)));
    }
    // Unused components have zero innovations and unit variance: they add nothing.
    record.nis = m.innovation.dot(S.inverse() * m.innovation);
    if (!std::isfinite(record.nis)) {
        run.diverged = Divergence{record.time, kind};
        return record;
    }
    if (withheld) {
        record.status = MeasurementStatus::Withheld;
        return record;
    }
    const double drift =
        std::sqrt(run.filter.P.diagonal().template segment<3>(kind == MeasurementKind::GnssVelocity ? 6 : 3).maxCoeff()) *
        (kind == MeasurementKind::GnssVelocity ? 10.0 : 1.0);
    if (settings_.integrity.use && is_part_of_fix(kind)) {
        const Eigen::Vector3d of_state = record.sigma_state.cwiseAbs2();
        const Examined examined{
            kind, record.time, m.innovation, record.sigma.squaredNorm(), of_state, record.sigma.cwiseAbs2() - of_state};
        record.status = examine(run, channel, record, examined, observer);
        if (record.status == MeasurementStatus::Accepted && !use(run, channel, local, m, stamp, observer))
            record.status = MeasurementStatus::Withheld;
        return record;
    }
    if (contests(kind)) {
        Measurement moved = local, own = m;
        record.status = judge(run, channel, record, moved, own, observer);
        if (record.status == MeasurementStatus::Accepted && !use(run, channel, moved, own, stamp, observer))
            record.status = MeasurementStatus::Withheld;
        return record;
    }
    Eigen::Vector3d used = Eigen::Vector3d::Zero();
    for (int i = 0; i < m.dof; ++i) used(i) = std::sqrt(m.variance(i));
    const GateDecision decision =
        decide(run.gates[channel.gate()], data_.gates, record.time, m.dof, record.nis, m.innovation, used, drift);
    if (decision == GateDecision::Reject ||
        (decision == GateDecision::Recover && !is_part_of_fix(kind) && kind != MeasurementKind::Baro)) {
        if (decision == GateDecision::Recover && kind == MeasurementKind::Heading)
            run.refused_heading = std::abs(m.innovation.x());
        record.status = MeasurementStatus::Rejected;
        return record;
    }
    if (decision == GateDecision::Recover) recover(run, channel, local);
    if (kind == MeasurementKind::Heading) run.refused_heading = 0.0;
    record.status = use(run, channel, local, m, stamp, observer) ? MeasurementStatus::Accepted : MeasurementStatus::Withheld;
    return record;
}

template <class Frame>
void Pass<Frame>::change_constellation(FilterRun<Frame>& run, const Event& event) const {
    const bool position = event.kind == MeasurementKind::GnssPosition;
    const int offset = position ? model_.layout.gnss_position : model_.layout.gnss_velocity;
    if (offset < 0) return;
    const Eigen::Vector3d& jump = position ? model_.gnss.change_correlated_position : model_.gnss.change_correlated_velocity;
    for (int axis = 0; axis < 3; ++axis)
        if ((event.components >> axis & 1) != 0) run.filter.P(offset + axis, offset + axis) += jump(axis) * jump(axis);
}

#define SCHULER_INSTANTIATE(Frame)                                                                                              \
    template Eigen::Matrix<double, 9, 1> Pass<Frame>::of_latency(const InertialFilter<Frame>&, const Estimate&, int) const;     \
    template Eigen::Vector3d Pass<Frame>::position_variance(const InertialFilter<Frame>&, const Estimate&, const Event&) const; \
    template Eigen::Vector3d Pass<Frame>::velocity_variance(const InertialFilter<Frame>&, const Estimate&, const Event&, int)   \
        const;                                                                                                                  \
    template Measurement Pass<Frame>::measurement_of(const InertialFilter<Frame>&, const Event&) const;                         \
    template MeasurementRecord Pass<Frame>::try_update(FilterRun<Frame>&, Channel, const Measurement&, Time, bool, Observer&)   \
        const;                                                                                                                  \
    template void Pass<Frame>::recover(FilterRun<Frame>&, Channel, const Measurement&) const;                                   \
    template void Pass<Frame>::change_constellation(FilterRun<Frame>&, const Event&) const;
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::filter
