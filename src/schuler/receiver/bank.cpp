#include "schuler/receiver/bank.h"

#include "schuler/receiver/loop_theory.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace schuler::receiver {

namespace {

constexpr double c = gnss::speed_of_light;
/// Beyond these a prediction may be outside the range of a deep channel's discriminators (half a chip, a quarter of the inverse
/// symbol).
constexpr double deep_range = 40.0, deep_rate = 0.8;  // m, m/s, one sigma
constexpr int rate_span = 200;                        // code periods over which a tracked phase gives a rate
constexpr int pause = 100;  // code periods between a successful search and the next, while the navigation uses it

theory::PllResponse response_of(const BankSettings& settings) {
    const TrackingSettings& s = settings.guidance == Guidance::Loops ? settings.aided : settings.alone;
    return theory::pll_response(s.pll_bandwidth, s.integration, Bank::period);
}

}  // namespace

double shared_rate_span(const BankSettings& settings) {
    // spans with uniformly distributed ends within a symbol are a third of it apart on average
    constexpr double span = rate_span * Bank::period, symbol = 0.02;  // s
    if (settings.guidance == Guidance::Generators) return span / (1.0 - symbol / (3.0 * span));
    return 1.0 / response_of(settings).clock_common;
}

Bank::Channel::Channel(const SignalStructure& signal_, const BankSettings& settings, std::uint64_t seed, std::size_t number)
    : signal(signal_),
      peak(signal_.chip_rate, settings.front_end),
      model(peak, (settings.guidance == Guidance::Generators ? settings.deep.spacing
                   : settings.guidance == Guidance::Loops    ? settings.aided.spacing
                                                             : settings.alone.spacing)),
      noise(seed, "bank.noise." + std::to_string(number)),
      message(seed, "bank.message." + std::to_string(number)),
      tracker(signal_, peak, settings.guidance == Guidance::Loops ? settings.aided : settings.alone, settings.oscillator.h0),
      deep(signal_, peak, settings.deep),
      symbol(static_cast<int>(std::lround(signal_.symbol_duration / period))),
      // the light times of the signals differ by tens of milliseconds
      phase(static_cast<int>(7 * number) % symbol) {}

Bank::Bank(const SignalField& field, const BankSettings& settings, std::uint64_t seed, double start)
    : field_(field),
      settings_(settings),
      oscillator_noise_(seed, "bank.oscillator"),
      oscillator_((settings.oscillator.check(), settings.oscillator), oscillator_noise_),
      predictions_(field.size()),
      ticks_(std::llround(start / period)),
      response_(response_of(settings)) {
    settings.search.check();
    settings.aided_search.check();
    channels_.reserve(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) channels_.emplace_back(field.structure(i), settings, seed, i);
}

void Bank::guide(std::span<const Prediction> predictions, double t) {
    std::ranges::copy(predictions.first(predictions_.size()), predictions_.begin());
    guided_at_ = t;
}

LineOfSight Bank::predicted(std::size_t i, double t) const { return predictions_[i].motion.after(t - guided_at_); }

void Bank::step(const Eigen::Vector3d& f_b) {
    const double t = now(), before = clock_;
    oscillator_.step(period, f_b, oscillator_noise_);
    clock_ = c * oscillator_.offset();
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        Channel& ch = channels_[i];
        if (ch.phase == 0) ch.sign = ch.message.uniform() < 0.5 ? -1 : 1;
        LineOfSight truth = field_.motion(i, t);
        truth.range += before;
        truth.rate += (clock_ - before) / period;
        const bool view = field_.in_view(i, t);
        const double cn0 = view ? field_.cn0(i, t) : 0.0;
        if (settings_.guidance == Guidance::Generators) step_deep(i, truth, cn0, view);
        else step_alone(i, truth, cn0, view);
        ch.phase = (ch.phase + 1) % ch.symbol;
    }
    ++ticks_;
}

Search Bank::new_search(std::size_t i, const LineOfSight& truth) {
    Channel& ch = channels_[i];
    if (settings_.guidance != Guidance::None) {
        const Prediction& p = predictions_[i];
        return {ch.signal, ch.model, settings_.aided_search, predicted_window(ch.signal, p.std_range, p.std_rate),
                aligned_replica(ch.signal, predicted(i, now()))};
    }
    LineOfSight guess = truth;
    guess.range += settings_.hot_range * ch.noise.normal();
    guess.rate += settings_.hot_rate * ch.noise.normal();
    return {ch.signal, ch.model, settings_.search, predicted_window(ch.signal, settings_.hot_range, settings_.hot_rate),
            aligned_replica(ch.signal, guess)};
}

bool Bank::search(std::size_t i, const LineOfSight& truth, double cn0) {
    Channel& ch = channels_[i];
    if (ch.wait == 0) {
        if (ch.search && ch.found) {
            ch.found = false;
            return true;
        }
        // after each sweep with the current prediction: the window of a long search would remain at the old position
        const bool swept =
            ch.search && !ch.search->candidate() && ch.search->elapsed() >= ch.search->dwells_per_sweep() * ch.search->dwell();
        if (!ch.search || swept) ch.search.emplace(new_search(i, truth));
        const LineOfSight aid = predicted(i, now());
        ch.found = ch.search->step(truth, cn0, ch.noise, settings_.guidance != Guidance::None ? &aid : nullptr);
        ch.wait = std::max(1, static_cast<int>(std::lround(ch.search->dwell() / period)));
    }
    --ch.wait;
    return false;
}

void Bank::step_alone(std::size_t i, const LineOfSight& truth, double cn0, bool view) {
    Channel& ch = channels_[i];
    const bool guided = settings_.guidance == Guidance::Loops;
    const TrackState state = ch.tracker.state();
    if (state == TrackState::Idle || state == TrackState::Lost) {
        if (!view) ch.search.reset();
        if (!view || !search(i, truth, cn0)) return;
        // the coarse search of an autonomous receiver leaves a larger frequency error than sums over half symbols can resolve
        ch.tracker.start(ch.search->replica(), guided ? std::optional(ch.phase) : std::nullopt, ch.search->uncertainty());
        ch.search.reset();
    }
    const ReplicaError error = replica_error(ch.signal, ch.tracker.replica(), truth, period);
    LineOfSight aid = predicted(i, now() + period);
    aid.rate -= predictions_[i].drift;
    ch.tracker.step(ch.model.dump(error, cn0, period, ch.sign, ch.noise), guided ? &aid : nullptr, predictions_[i].std_rate);
}

void Bank::step_deep(std::size_t i, const LineOfSight& truth, double cn0, bool view) {
    Channel& ch = channels_[i];
    if (!view) {
        ch.running = ch.fresh = false;
        ch.search.reset();
        return;
    }
    const Prediction& p = predictions_[i];
    // a running channel is kept longer: a signal too weak to be found may still be tracked
    const double patience = ch.running ? 2.0 : 1.0;
    if (!(p.std_range < patience * deep_range && p.std_rate < patience * deep_rate)) {
        // a prediction outside the range of the discriminators would give invalid measurements: search for the signal
        ch.running = false;  // a restarted channel uses the current prediction
        if (!search(i, truth, cn0)) return;
        ch.measured = {};
        ch.measured.status = ChannelMeasurement::Status::Noncoherent;
        ch.measured.range_variance = std::pow(settings_.aided_search.code_step * ch.signal.chip_length(), 2) / 4.0;
        ch.measured.rate_variance = std::pow(ch.search->frequency_step() * ch.signal.wavelength(), 2) / 4.0;
        ch.measured.duration = ch.search->dwell();
        ch.expected = followed(ch.signal, ch.search->replica());
        ch.at = now();
        ch.fresh = true;
        ch.search.reset();
        ch.wait = pause;
        return;
    }
    if (!ch.running) {
        ch.search.reset();
        ch.wait = 0;
        ch.deep.start(predicted(i, now()), ch.phase);
        ch.running = true;
    }
    if (now() < guided_at_ + 0.5 * period) ch.deep.steer(predicted(i, now()));  // a new prediction: steer the generators at once
    const ReplicaError error = replica_error(ch.signal, ch.deep.replica(), truth, period);
    const auto out = ch.deep.step(ch.model.dump(error, cn0, period, ch.sign, ch.noise));
    if (!out) return;
    ch.measured = *out;
    ch.expected = ch.deep.predicted();
    ch.at = now() + period;
    ch.fresh = out->status != ChannelMeasurement::Status::NoSignal;
    // the white frequency noise of the oscillator, averaged over the symbol, exceeds the navigation's uncertainty
    const double clock_noise = c * std::sqrt(0.5 * settings_.oscillator.h0 / ch.signal.symbol_duration);
    ch.deep.command(predicted(i, now() + period), std::hypot(p.std_rate, clock_noise));
}

void Bank::measure(std::vector<BankMeasurement>& out, double interval) {
    out.clear();
    const double late = clock_ / c;  // delay in s of the instant at which the receiver's clock showed now
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        Channel& ch = channels_[i];
        BankMeasurement m;
        m.signal = i;
        if (settings_.guidance == Guidance::Generators) {
            if (!ch.fresh) {
                ch.span.reset();
                continue;
            }
            ch.fresh = false;
            const LineOfSight here = ch.expected.after(now() - ch.at - late);
            m.range = here.range - ch.measured.range;
            m.range_variance = ch.measured.range_variance;
            const double generated = ch.deep.generated() - here.rate * late;
            if (const auto span = ch.span.add(ch.measured, now(), generated, ticks_ % rate_span == 0)) {
                m.rate = span->phase_variance > 0.0 ? span->rate : here.rate - span->rate;
                m.rate_variance = span->variance;
                m.rate_span = span->duration;
                m.phase_variance = span->phase_variance;
                m.phase_goes_on = span->goes_on;
            }
            m.cn0 = ch.measured.cn0;
            out.push_back(m);
            continue;
        }
        const bool locked = ch.tracker.phase_locked(), code_only = ch.tracker.state() == TrackState::CodeOnly;
        if (!locked && !code_only) continue;
        const TrackingSettings& s = settings_.guidance == Guidance::Loops ? settings_.aided : settings_.alone;
        const LineOfSight here = ch.tracker.motion().after(-late);
        const double dll = locked ? s.dll_bandwidth : s.code_only_dll;
        m.cn0 = std::max(ch.tracker.cn0(), 10.0);
        // a loop's output changes once in 1/(2 bandwidth): read more often each value has less information
        m.range = here.range;
        m.range_variance =
            std::pow(ch.signal.chip_length(), 2) * ch.tracker.code_variance() * std::max(1.0, 1.0 / (2.0 * dll * interval));
        const double frequency_variance = ch.tracker.frequency_variance();
        if (locked && std::isfinite(frequency_variance)) {
            m.rate = here.rate;
            m.rate_variance = std::pow(ch.signal.wavelength(), 2) * frequency_variance;
            m.rate_span = 1.0 / (response_.clock_common + response_.clock_own);
        }
        out.push_back(m);
    }
}

ChannelState Bank::state(std::size_t signal) const {
    const Channel& ch = channels_[signal];
    if (settings_.guidance == Guidance::Generators) {
        if (!ch.running || ch.measured.status == ChannelMeasurement::Status::NoSignal) return ChannelState::Idle;
        return ch.measured.status == ChannelMeasurement::Status::Coherent ? ChannelState::DeepCoherent : ChannelState::Deep;
    }
    if (ch.search) return ChannelState::Searching;
    switch (ch.tracker.state()) {
        case TrackState::PullIn: return ChannelState::PullIn;
        case TrackState::Phase: return ch.tracker.phase_locked() ? ChannelState::Phase : ChannelState::PullIn;
        case TrackState::CodeOnly: return ChannelState::CodeOnly;
        default: return ChannelState::Idle;
    }
}

}  // namespace schuler::receiver
