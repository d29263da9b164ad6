#include "schuler/fusion/tight_filter.h"

#include "schuler/core/units.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {

using L = TightLayout;

namespace {

const sensor::RangeErrorModel& errors_of(const TightModel& model, bool station) {
    return station ? model.ranging.errors.station : model.ranging.errors.satellite;
}

/// Scale factors and misalignments act where the vehicle turns and where its specific force is not that of rest, which the biases
/// take over: as white noise that leaves, after a manoeuvre of `manoeuvre` seconds, the error that they do.
BridgeNoise with_gain_errors(const TightModel& model, const ImuIncrement& increment, const BridgeNoise& bridge) {
    constexpr double manoeuvre = 10.0;   // s
    const double dt2 = increment.dt * increment.dt, g0 = units::g0;
    const double beyond_rest = std::max(0.0, increment.dv.squaredNorm() / dt2 - g0 * g0);
    const double turning = increment.dtheta.squaredNorm() / dt2;
    return {bridge.gyro_psd + model.gyro_gain * model.gyro_gain * turning * manoeuvre,
            bridge.accel_psd + model.accel_gain * model.accel_gain * beyond_rest * manoeuvre};
}

}  // namespace

template <class Frame>
void TightFilter<Frame>::start(const TightModel& model, const Eigen::Matrix<double, L::inertial, L::inertial>& P_inertial) {
    P.setZero();
    P.topLeftCorner<L::inertial, L::inertial>() = P_inertial;
    const sensor::RangingErrorModel& e = model.ranging.errors;
    P(L::clock, L::clock) = e.clock.bias * e.clock.bias;
    P(L::drift, L::drift) = e.clock.drift * e.clock.drift;
    P(L::network, L::network) = e.network * e.network;
    for (int i = 0; i < 3; ++i) P(L::intersystem + i, L::intersystem + i) = e.intersystem * e.intersystem;
    inertial.P.setZero();
    gathered.reset();
    brought = inertial.time();
    watch.on = model.ranging.protection.use;
}

template <class Frame>
void TightFilter<Frame>::propagate(const TightModel& model, const ImuIncrement& increment, const BridgeNoise& bridge) {
    estim::Transition<L::inertial> phi;
    inertial.propagate(model.inertial, increment, with_gain_errors(model, increment, bridge), phi);
    gathered.then(phi);
}

template <class Frame>
void TightFilter<Frame>::bring_up(const TightModel& model) {
    const double dt = (time() - brought).seconds();
    if (!(dt > 0.0)) return;
    brought = time();
    const sensor::RangingErrorModel& e = model.ranging.errors;
    TightVector decay = TightVector::Ones(), q = TightVector::Zero();
    const auto markov = [&](int i, double sigma, double correlation_time) {
        decay(i) = std::exp(-dt / correlation_time);
        q(i) = -std::expm1(-2.0 * dt / correlation_time) * sigma * sigma;
    };
    markov(L::network, e.network, e.network_time);
    for (int k = 0; k < L::slots; ++k) {
        const Slot& slot = slots[static_cast<std::size_t>(k)];
        if (slot.source < 0) continue;
        const sensor::RangeErrorModel& m = errors_of(model, slot.station);
        markov(L::source + k, m.correlated, m.correlation_time);
    }
    const double sf = e.clock.phase_psd(), sd = e.clock.frequency_psd();
    q(L::clock) = sf * dt + sd * dt * dt * dt / 3.0;
    q(L::drift) = sd * dt;
    estim::propagate_staged<N, L::inertial>(P, gathered, inertial.P, decay, TightVector::Zero());
    // the clock's own transition commutes with the rest, which it does not meet
    P.row(L::clock) += dt * P.row(L::drift);
    P.col(L::clock) += dt * P.col(L::drift);
    P.diagonal() += q;
    P(L::clock, L::drift) += 0.5 * sd * dt * dt;
    P(L::drift, L::clock) = P(L::clock, L::drift);
    parameters(L::clock) += dt * parameters(L::drift);
    parameters.tail<N - L::network>() = parameters.tail<N - L::network>().cwiseProduct(decay.tail<N - L::network>());
    watch.propagate(gathered, decay);
    for (auto& h : watch.all) h.response(L::clock) += dt * h.response(L::drift);
    inertial.P.setZero();
    gathered.reset();
}

template <class Frame>
void TightFilter<Frame>::apply(const TightModel& model, const TightVector& dx) {
    inertial.apply(model.inertial, dx.head<L::inertial>());
    parameters.tail<N - L::inertial>() -= dx.tail<N - L::inertial>();
}

template <class Frame>
int TightFilter<Frame>::slot_of(const TightModel& model, int source, bool station) {
    const sensor::RangeErrorModel& m = errors_of(model, station);
    if (!(m.correlated > 0.0)) return -1;
    constexpr double forgotten = 5.0;   // correlation times after which a slot may go to another source
    int free = -1;
    for (int k = 0; k < L::slots; ++k) {
        const Slot& slot = slots[static_cast<std::size_t>(k)];
        if (slot.source == source) return L::source + k;
        if (free < 0 && slot.source < 0) free = k;
    }
    for (int k = 0; k < L::slots && free < 0; ++k) {
        const Slot& slot = slots[static_cast<std::size_t>(k)];
        if ((time() - slot.last).seconds() > forgotten * errors_of(model, slot.station).correlation_time) free = k;
    }
    if (free < 0) return -1;
    watch.forget(slots[static_cast<std::size_t>(free)].source);
    slots[static_cast<std::size_t>(free)] = {source, station, time(), {}};
    const int state = L::source + free;
    for (auto& h : watch.all) h.response(state) = 0.0;
    P.row(state).setZero();
    P.col(state).setZero();
    P(state, state) = m.correlated * m.correlated;
    parameters(state) = 0.0;
    used = std::max(used, (state + 4) / 4 * 4);
    return state;
}

template <class Frame>
Matrix9 TightFilter<Frame>::local_covariance(const TightModel& model) const {
    const Matrix9 T = inertial.to_local_level(model.inertial);
    return T * P.template topLeftCorner<9, 9>() * T.transpose();
}

template struct TightFilter<GeographicFrame>;
template struct TightFilter<EarthFixedFrame>;

}  // namespace schuler::fusion
