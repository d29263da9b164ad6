#include "schuler/scenario/simulated_receiver.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/gnss/acceleration.h"
#include "schuler/math/rotation.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/sensor/range_errors.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/scenario/sections.h"

#include <algorithm>
#include <cmath>

namespace schuler::scenario {

namespace {

constexpr double c = gnss::speed_of_light;
constexpr double deep_interval = 0.02;  // s, a symbol of GPS
constexpr int row_ticks = 100;          // ms

/// Rotation of the Earth-fixed axes of transmission to those at reception, `tau` s later.
fusion::EarthFixedMotion at_reception(const gnss::SatelliteState& s, const earth::Ellipsoid& earth, double tau) {
    const Eigen::Matrix3d C = Eigen::AngleAxisd(-earth.w_ie * tau, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d r = s.position.r, v = s.velocity, a = point_mass_acceleration(s, earth);
    return {C * r, C * v, C * a};
}

}  // namespace

SimulatedSky::SimulatedSky(const settings::ScenarioConfig& scenario)
    : settings_(scenario.receiver_channels),
      frame_(settings::ranging_frame(scenario)),
      ranging_(settings::ranging_settings(scenario)),
      path_(sim::make_path(scenario.sim.path, scenario.sim.earth.ellipsoid)),
      signals_(frame_, *path_, settings::signal_settings(scenario, ranging_)),
      orbits_(ranging_.navigation) {
    if (signals_.size() == 0)
        throw input_error("no satellite is ever in view", {.file = {}, .key = "ranges.systems"},
                          "give \"G\", or a lower elevation mask");
    const sensor::Oscillator& clock = ranging_.errors.clock;
    settings_.bank.oscillator = {clock.h0, settings_.clock_flicker, clock.h_minus2, clock.drift / c,
                                 Eigen::Vector3d::Constant(settings_.clock_per_g / units::g0)};
}

receiver::SignalStructure SimulatedSky::structure(std::size_t signal) const {
    const gnss::SatelliteId id = signals_.satellite(signal);
    return id.system == gnss::System::Glonass ? receiver::glonass_l1_of(0) : receiver::gps_l1_ca();
}

receiver::LineOfSight SimulatedSky::motion(std::size_t signal, double t) const {
    const sim::SignalMotion m = signals_.motion(signal, t);
    return {m.range, m.rate, m.acceleration, m.jerk};
}

Eigen::Vector3d SimulatedSky::force(double t) const {
    const sim::Kinematics k = path_->at(t);
    return math::dcm_from_rpy(k.rpy).transpose() * (k.dv_eb_n - Eigen::Vector3d(0.0, 0.0, units::g0));
}

std::optional<gnss::SatelliteState> SimulatedSky::satellite(std::size_t signal, double t) const {
    const auto found = orbits_.at(signals_.satellite(signal), {}, frame_.gps + Duration::from_seconds(t));
    if (!found) return std::nullopt;
    return found->state;
}

SimulatedReceiver::SimulatedReceiver(const SimulatedSky& sky, receiver::Guidance guidance)
    : sky_(sky), settings_(sky.settings().bank), predictions_(sky.size()) {
    settings_.guidance = guidance;
    rate_span_ = receiver::shared_rate_span(settings_);
    interval_ = guidance == receiver::Guidance::Generators ? deep_interval : 1.0 / sky.settings().rate;
}

void SimulatedReceiver::begin(double t) { bank_.emplace(sky_, settings_, sky_.frame().seed, t); }

void SimulatedReceiver::run(const fusion::ReceiverAiding& aiding, Time until, RangingLog& log) {
    const double now = sky_.seconds(aiding.time);
    if (!bank_) begin(now);
    const earth::Ellipsoid& ellipsoid = sky_.frame().earth.ellipsoid;
    // the filter does not know a clock that is taken out of the measurements, but the channels need it
    const bool hidden = sky_.settings().exact_clock;
    const double clock = aiding.clock + (hidden ? bank_->clock() : 0.0), drift = aiding.drift + (hidden ? clock_drift(1.0) : 0.0);
    for (std::size_t i = 0; i < predictions_.size(); ++i) {
        const auto first = sky_.satellite(i, now - 0.075);
        if (!first) continue;
        const double tau = (aiding.antenna.r_e - first->position.r).norm() / c;
        const auto sent = sky_.satellite(i, now - tau);
        if (!sent) continue;
        const fusion::LineOfSightPrediction predicted =
            fusion::line_of_sight_prediction(aiding.antenna, at_reception(*sent, ellipsoid, tau), aiding.C_en, aiding.P);
        const double jerk = aiding.jerk_e.dot((aiding.antenna.r_e - sent->position.r).normalized());
        predictions_[i] = {{predicted.range + clock - c * sent->clock, predicted.rate + drift - c * sent->clock_rate,
                            predicted.acceleration, jerk},
                           std::hypot(predicted.std_range, aiding.std_clock),
                           std::hypot(predicted.std_rate, aiding.std_drift),
                           drift};
    }
    bank_->guide(predictions_, now);
    listen(sky_.seconds(until), log);
}

RangingLog SimulatedReceiver::run_alone() {
    RangingLog log;
    begin(0.0);
    listen(sky_.frame().duration, log);
    return log;
}

void SimulatedReceiver::listen(double until, RangingLog& log) {
    const auto every = static_cast<std::int64_t>(std::lround(interval_ / receiver::Bank::period));
    Eigen::Vector3d force = sky_.force(bank_->now());
    while (bank_->now() < until - 0.5 * receiver::Bank::period) {
        bank_->step(force);
        const std::int64_t tick = std::llround(bank_->now() / receiver::Bank::period);
        clocks_[static_cast<std::size_t>(tick) % clocks_.size()] = bank_->clock();
        ++ticks_;
        if (tick % 10 == 0) force = sky_.force(bank_->now());
        if (tick % every == 0) measure(log);
        if (tick % row_ticks == 0) note();
    }
}

double SimulatedReceiver::clock_drift(double span) const {
    const std::int64_t tick = std::llround(bank_->now() / receiver::Bank::period), kept = std::min(std::ssize(clocks_), ticks_);
    const std::int64_t ago = std::min<std::int64_t>(std::llround(span / receiver::Bank::period), kept - 1);
    if (ago <= 0) return 0.0;
    const double before = clocks_[static_cast<std::size_t>(tick - ago) % clocks_.size()];
    return (bank_->clock() - before) / (static_cast<double>(ago) * receiver::Bank::period);
}

void SimulatedReceiver::make_exact(receiver::BankMeasurement& m, double t) const {
    const settings::ReceiverScenarioConfig& s = sky_.settings();
    const double span = std::max(receiver::Bank::period, m.rate_span), clock = bank_->clock();
    const double drift = clock_drift(span);
    // by phase the mean over the interval, from a loop the present rate
    const auto mean_rate = [&](double at) {
        return m.phase_variance > 0.0 ? (sky_.motion(m.signal, at).range - sky_.motion(m.signal, at - span).range) / span
                                      : sky_.motion(m.signal, at).rate;
    };
    const double channel = m.range - (sky_.motion(m.signal, t).range + clock), channel_rate = m.rate - (mean_rate(t) + drift);
    const double at = s.exact_clock ? bank_->now() : t;
    m.range = sky_.motion(m.signal, at).range + (s.exact_clock ? 0.0 : clock) + (s.exact_channels ? 0.0 : channel);
    m.rate = mean_rate(at) + (s.exact_clock ? 0.0 : drift) + (s.exact_channels ? 0.0 : channel_rate);
}

void SimulatedReceiver::measure(RangingLog& log) {
    bank_->measure(measured_, interval_);
    RangeEpoch epoch{sky_.time(bank_->now()), log.samples.size(), 0};
    const double t = bank_->now() - bank_->clock() / c;  // true time at which the receiver's clock shows now
    sensor::Oscillator clock;
    clock.h0 = settings_.oscillator.h0;
    const double clock_density = clock.phase_psd();
    for (receiver::BankMeasurement& m : measured_) {
        if (partly_exact()) make_exact(m, t);
        const double left = bank_->now() - m.range / c;  // by the satellite's clock: the receiver's error is in both
        const auto guess = sky_.satellite(m.signal, left);
        if (!guess) continue;
        const auto sent = sky_.satellite(m.signal, left - guess->clock);
        if (!sent) continue;
        RangeSample s;
        const gnss::SatelliteId id = sky_.signals().satellite(m.signal);
        s.source = log.source(gnss::name_of(id), false);
        s.pseudorange = m.range + sky_.signals().code_delay(m.signal, t);
        s.std = std::sqrt(m.range_variance);
        if (std::isfinite(m.rate_variance)) {
            s.range_rate = m.rate + sky_.signals().rate_error(m.signal, t - 0.5 * m.rate_span);
            // part of a rate's clock noise beyond the common part, for which the filter has a state
            const double more = clock_density * std::max(0.0, 1.0 / m.rate_span - 1.0 / rate_span_);
            s.std_rate = std::sqrt(m.rate_variance + more);
            if (m.phase_variance > 0.0) {
                // each end has half of it, permanently: the clock's change between the ends of different channels
                s.phase_std = std::sqrt(m.phase_variance + 0.5 * more * m.rate_span * m.rate_span);
                s.phase_span = m.rate_span;
                s.phase_goes_on = m.phase_goes_on;
            }
        }
        s.cn0 = receiver::db_from_cn0(m.cn0);
        s.tx = sent->position;
        s.tx_velocity = sent->velocity;
        s.tx_clock = sent->clock;
        s.tx_clock_rate = sent->clock_rate;
        s.frequency = gnss::frequency_of(id.system, '1');
        log.samples.push_back(s);
    }
    epoch.count = log.samples.size() - epoch.first;
    if (epoch.count > 0) log.epochs.push_back(epoch);
}

void SimulatedReceiver::note() {
    ReceiverRow row;
    const double t = bank_->now();
    row.time = sky_.time(t);
    row.jammed = sky_.signals().jammer_to_signal(t);
    for (std::size_t i = 0; i < sky_.size(); ++i) {
        const double cn0 = sky_.cn0(i, t);
        if (cn0 > 0.0) {
            ++row.heard;
            row.cn0 = receiver::db_from_cn0(cn0);
        }
        using State = receiver::ChannelState;
        const State state = bank_->state(i);
        if (state == State::Phase || state == State::DeepCoherent) ++row.phase;
        if (state == State::Phase || state == State::CodeOnly || state == State::Deep || state == State::DeepCoherent) ++row.code;
    }
    rows_.push_back(row);
}

}  // namespace schuler::scenario
