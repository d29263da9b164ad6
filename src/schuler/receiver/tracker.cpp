#include "schuler/receiver/tracker.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::receiver {

namespace {

constexpr double cn0_time = 0.5;       ///< s, time constant of the C/N0 estimate
constexpr double cn0_guess = 3000.0;   ///< Hz, before the first estimate
constexpr double lock_time = 0.25;     ///< s, of the phase lock detector
constexpr double settled_aided = 2.0;  ///< s, averaging of the frequency stored for reacquisition
constexpr double settled_alone = 0.2;  ///< s, likewise: without aiding it varies
constexpr double assist = 3.0;         ///< Hz, frequency loop assisting the phase loop during lock-in
constexpr double retry_time = 2.0;     ///< s between attempts at a lost carrier
constexpr int most_attempts = 3;       ///< to recover the carrier without aiding
constexpr int most_escapes = 4;        ///< from false locks per attempt

int dumps_per_symbol(const SignalStructure& signal) {
    return static_cast<int>(std::lround(signal.symbol_duration / signal.code_period()));
}

}  // namespace

void TrackingSettings::check(const SignalStructure& signal) const {
    const auto positive = [](double value, const char* key) {
        if (!(value > 0.0 && std::isfinite(value))) throw input_error(fmt::format("{} is not positive", value), {.key = key});
    };
    const int symbol = dumps_per_symbol(signal);
    if (symbol < 2 || symbol > SymbolSync::longest || symbol % 2 != 0)
        throw input_error(fmt::format("a symbol of {} code periods is not tracked", symbol), {.key = "signal"}, "2 to 20, even");
    if (integration < 1 || integration > symbol || symbol % integration != 0)
        throw input_error(fmt::format("{} code periods do not divide a symbol of {}", integration, symbol),
                          {.key = "integration"}, "give a divisor of it");
    if (!(spacing > 0.0 && spacing <= 1.0))
        throw input_error(fmt::format("correlator spacing {} chips", spacing), {.key = "spacing"}, "give at most 1 chip");
    positive(pll_bandwidth, "pll_bandwidth");
    positive(pull_in_fll, "pull_in_fll");
    positive(pull_in_time, "pull_in_time");
    positive(sync_time, "sync_time");
    positive(phase_patience, "phase_patience");
    positive(code_patience, "code_patience");
    if (!(phase_lock > 0.0 && phase_lock < 1.0))
        throw input_error(fmt::format("{} is not a valid threshold of phase lock", phase_lock), {.key = "phase_lock"},
                          "give 0 to 1");
}

Tracker::Tracker(const SignalStructure& signal, const CorrelationPeak& peak, const TrackingSettings& settings, double clock_h0)
    : signal_(signal),
      settings_((settings.check(signal), settings)),
      peak_(peak(0.0)),
      period_(signal.code_period()),
      symbol_(dumps_per_symbol(signal)),
      code_error_(peak, settings.spacing, settings.discriminator),
      blind_(0.0, settings.pull_in_fll, 2.0 * period_),
      listening_(0.0, settings.pull_in_fll / 4.0, 2.0 * period_),
      aligned_(0.0, std::min(settings.pull_in_fll, 4.0), symbol_ * period_),
      assisted_(settings.pll_bandwidth, std::max(assist, settings.fll_bandwidth), settings.integration * period_),
      phase_(settings.pll_bandwidth, settings.fll_bandwidth, settings.integration * period_),
      code_blind_(settings.pull_in_dll, 2.0 * period_),
      code_aligned_(settings.pull_in_dll, symbol_ * period_),
      code_phase_(settings.dll_bandwidth, settings.integration * period_),
      code_only_(settings.code_only_dll, symbol_ * period_),
      of_blind_(LoopModel::Carrier::Frequency, blind_, code_blind_, 2.0 * period_, signal.chips_per_cycle()),
      of_listening_(LoopModel::Carrier::Frequency, listening_, code_blind_, 2.0 * period_, signal.chips_per_cycle()),
      of_aligned_(LoopModel::Carrier::Frequency, aligned_, code_aligned_, symbol_ * period_, signal.chips_per_cycle()),
      of_assisted_(LoopModel::Carrier::Phase, assisted_, code_phase_, settings.integration * period_, signal.chips_per_cycle()),
      of_phase_(LoopModel::Carrier::Phase, phase_, code_phase_, settings.integration * period_, signal.chips_per_cycle()),
      of_code_only_(LoopModel::Carrier::Held, aligned_, code_only_, symbol_ * period_, signal.chips_per_cycle()),
      stress_(settings.pll_bandwidth, settings.integration * period_, 0.0),
      cn0_(period_, cn0_time, peak_, cn0_guess),
      fading_(period_, 0.5 / settings.pll_bandwidth, peak_, cn0_guess),
      lock_(settings.integration * period_, lock_time),
      sync_(symbol_),
      rotation_(period_, peak_) {
    // of the phase loop in its steady state: the jitter that the oscillator adds, a random walk of the phase of density h0 f^2 / 2, and
    // that of the sampled loop over that of the continuous one, 2 B T times the variance of its sums, for which the threshold is given
    const double interval = settings.integration * period_;
    const DiscriminatorNoise walk{.walk = 0.5 * clock_h0 * signal.carrier_frequency * signal.carrier_frequency * interval};
    constexpr double small = 1e-6;  // cycles^2
    const DiscriminatorNoise unit{.carrier_variance = small};
    LoopError walked, noisy;
    for (double t = 0.0; t < 20.0 / settings.pll_bandwidth; t += interval) {
        walked.update(of_phase_, walk);
        noisy.update(of_phase_, unit);
    }
    clock_phase_ = walked.phase_variance();
    stress_ = PhaseStress(settings.pll_bandwidth, interval, walked.output_variance());
    threshold_ = phase_threshold * std::sqrt(noisy.phase_variance() / (small * 2.0 * settings.pll_bandwidth * interval));
}

TrackState Tracker::state() const {
    switch (mode_) {
        case Mode::Idle: return TrackState::Idle;
        case Mode::Blind:
        case Mode::Aligned: return TrackState::PullIn;
        case Mode::Assisted:
        case Mode::Phase: return TrackState::Phase;
        case Mode::CodeOnly: return TrackState::CodeOnly;
        case Mode::Lost: break;
    }
    return TrackState::Lost;
}

int Tracker::dumps_per_update() const {
    switch (mode_) {
        case Mode::Blind: return 2;
        case Mode::Aligned:
        case Mode::CodeOnly: return symbol_;
        default: return settings_.integration;
    }
}

void Tracker::start(const Replica& replica, std::optional<int> dumps_into_symbol, const ReplicaUncertainty& uncertainty) {
    replica_ = replica;
    error_.start(uncertainty);
    dump_ = dumps_into_symbol ? ((*dumps_into_symbol % symbol_) + symbol_) % symbol_ : 0;
    attempts_ = escapes_ = 0;
    aided_ = anchored_ = false;
    code_rate_ = 0.0;  // a search gives the code rate only via the carrier
    loop_frequency_ = settled_ = replica.carrier_frequency;
    aligned_.start(loop_frequency_);
    sync_ = SymbolSync(symbol_);
    mode_ = Mode::Idle;
    cn0_ = Cn0Estimator(period_, cn0_time, peak_, cn0_guess);
    fading_ = FadingCn0(period_, 0.5 / settings_.pll_bandwidth, peak_, cn0_guess);
    enter(dumps_into_symbol ? Mode::Aligned : Mode::Blind);
    command();
}

const CarrierLoop& Tracker::carrier() const {
    switch (mode_) {
        case Mode::Blind: return listening_;
        case Mode::Assisted: return assisted_;
        case Mode::Phase: return phase_;
        default: return aligned_;
    }
}

void Tracker::enter(Mode mode) {
    // After a loss of phase the loop's own memory is wrong: restart from the last steady value.
    const bool lost_phase = mode_ == Mode::CodeOnly || mode == Mode::CodeOnly ||
                            (mode == Mode::Aligned && (mode_ == Mode::Assisted || mode_ == Mode::Phase));
    const double frequency = lost_phase ? settled_ : carrier().frequency(), rate = lost_phase ? 0.0 : carrier().rate();
    if (lost_phase) {
        loop_frequency_ = settled_;
        error_.return_to_settled();
    }
    for (CarrierLoop* loop : loops()) loop->start(frequency, rate);
    // An aided code hardly drifts relative to its carrier; the memory of a wide loop is mostly noise.
    for (CodeLoop* loop : {&code_blind_, &code_aligned_, &code_phase_, &code_only_}) loop->start(0.0);
    code_rate_ = 0.0;
    error_.clear_code_rate();
    stress_.restart();
    if (mode == Mode::Assisted) {
        error_.close_phase();
        // moved there from a false lock, by what the rotation tells, it is known no better
        const bool moved = mode_ == Mode::Assisted || mode_ == Mode::Phase;
        opened_ = frequency;
        opened_variance_ = moved ? std::numeric_limits<double>::infinity() : error_.frequency_variance();
        if (aided_ && !moved && !lost_phase) {
            settled_ = frequency;
            error_.take_for_settled();
        }
    }
    mode_ = mode;
    time_in_mode_ = unlocked_ = weak_ = 0.0;
    sums_ = {};
    before_ = 0.0;
    rotation_.restart();
    verified_ = followed_ = false;
    const double prompt = (mode == Mode::Blind ? 1 : mode == Mode::Aligned ? symbol_ / 2 : dumps_per_update()) * period_;
    cn0_.change_interval(prompt);
    fading_.change_interval(prompt);
    if (mode == Mode::Assisted) lock_ = PhaseLockDetector(settings_.integration * period_, lock_time);
}

void Tracker::fail() {
    escapes_ = 0;
    if (aided_) enter(Mode::CodeOnly);
    else enter(++attempts_ < most_attempts ? Mode::Aligned : Mode::Lost);
}

void Tracker::step(const Correlators& dump, const LineOfSight* aid, double std_rate) {
    replica_ = replica_.after(period_);
    std_aid_ = std_rate;
    if (aided_ != (aid != nullptr)) {
        // Transfers a part of the loops' state to the aid, or back.
        const LineOfSight& motion = aid != nullptr ? *aid : aid_;
        const double sign = aid != nullptr ? -1.0 : 1.0;
        const double frequency = sign * motion.rate / signal_.wavelength(),
                     rate = sign * motion.acceleration / signal_.wavelength();
        for (CarrierLoop* loop : loops()) loop->hand_over(frequency, rate);
        loop_frequency_ -= frequency;
        settled_ -= frequency;
        opened_ -= frequency;
        aided_ = aid != nullptr;
        if (!aided_ && mode_ == Mode::CodeOnly) enter(Mode::Aligned);
    }
    if (aided_) aid_ = *aid;
    const bool waits = sums_.count == 0 && mode_ != Mode::Blind && dump_ % dumps_per_update() != 0;
    dump_ = (dump_ + 1) % symbol_;
    if (follows() && !waits) {
        if (mode_ == Mode::Blind) {
            sync_.add(dump.prompt);
            cn0_.add(dump.prompt);
            fading_.add(dump.prompt);
        }
        if (mode_ == Mode::Assisted || mode_ == Mode::Phase) rotation_.add(dump.prompt);
        sums_.all.early += dump.early;
        sums_.all.prompt += dump.prompt;
        sums_.all.late += dump.late;
        if (++sums_.count == dumps_per_update() / 2) sums_.first = sums_.all.prompt;
        if (sums_.count == dumps_per_update()) {
            update();
            sums_ = {};
            transitions();
        }
    }
    command();
}

void Tracker::update() {
    const int count = sums_.count;
    const double scale = 1.0 / std::sqrt(count), interval = count * period_;
    const Correlators c{sums_.all.early * scale, sums_.all.prompt * scale, sums_.all.late * scale};
    const std::complex<double> second = sums_.all.prompt - sums_.first;
    time_in_mode_ += interval;
    const double power = 2.0 * std::max(cn0_.cn0(), 10.0) * interval;  // 10 dB-Hz: bounds the gain for weak signals
    const double across = before_ == 0.0 ? 0.0 : frequency_across_bits(before_, c.prompt, interval);
    const double phase = costas_phase(c.prompt) / (2.0 * std::numbers::pi);
    switch (mode_) {
        case Mode::Blind:
            // first the wide range, although a sign change within the pair corrupts it; then the narrow one, insensitive to signs
            loop_frequency_ = time_in_mode_ - interval < settings_.pull_in_time
                                  ? blind_.update(0.0, frequency_between(sums_.first, second, interval / 2.0))
                                  : listening_.update(0.0, frequency_across_bits(sums_.first, second, interval / 2.0));
            code_rate_ = code_blind_.update(code_error_(c, power));
            break;
        case Mode::Aligned: {
            const double half = std::sqrt(2.0) * scale;
            for (const std::complex<double>& prompt : {sums_.first, second}) {
                cn0_.add(prompt * half);
                fading_.add(prompt * half);
            }
            loop_frequency_ = aligned_.update(0.0, frequency_between(sums_.first, second, interval / 2.0));
            code_rate_ = code_aligned_.update(code_error_(c, power));
            break;
        }
        case Mode::Assisted:
        case Mode::Phase:
            cn0_.add(c.prompt);
            fading_.add(c.prompt);
            lock_.add(c.prompt);
            loop_frequency_ = (mode_ == Mode::Phase ? phase_ : assisted_).update(phase, across);
            code_rate_ = code_phase_.update(code_error_(c, power));
            before_ = c.prompt;
            break;
        case Mode::CodeOnly:
            cn0_.add(c.prompt);
            fading_.add(c.prompt);
            code_rate_ = code_only_.update(code_error_(c, power));
            break;
        case Mode::Idle:
        case Mode::Lost: break;
    }
    follow_error(phase, power);
}

const LoopModel& Tracker::model() const {
    switch (mode_) {
        case Mode::Blind: return time_in_mode_ - 2.0 * period_ < settings_.pull_in_time ? of_blind_ : of_listening_;
        case Mode::Assisted: return of_assisted_;
        case Mode::Phase: return of_phase_;
        case Mode::CodeOnly: return of_code_only_;
        default: return of_aligned_;
    }
}

void Tracker::follow_error(double phase, double assumed) {
    // the strength of the prompts just used, which an average may have left behind, and the one that scaled the code
    const double interval = dumps_per_update() * period_, floor = assumed / (2.0 * interval);
    const double cn0 = fading_.recent(cn0_.cn0()), surely = fading_.surely(cn0_.cn0());
    const CodeError::Limited limited = code_error_.limited(std::sqrt(code_error_.variance(2.0 * cn0 * interval, assumed)));
    DiscriminatorNoise noise;
    noise.code_slope = std::min(1.0, surely / floor) * limited.slope;
    noise.code_variance = limited.variance;
    DiscriminatorResponse carrier{0.0, 0.0};
    switch (mode_) {
        case Mode::Blind: carrier = frequency_detector(cn0 * period_ * peak_, period_, 0.5 / period_); break;
        case Mode::Aligned: carrier = frequency_detector(cn0 * interval / 2.0 * peak_, interval / 2.0, 1.0 / interval); break;
        case Mode::Assisted:
        case Mode::Phase:
            carrier = phase_detector(cn0 * interval * peak_);
            carrier.slope = std::min(carrier.slope, phase_detector(surely * interval * peak_).slope);
            if (mode_ == Mode::Phase) {
                // Beyond its linear range under dynamics, which an aid takes from it, the discriminator tells nothing, and the frequency
                // is known as well as the rotation of the prompts tells; where that is evident, the loop is off by as much.
                constexpr double evident = 4.0;  // sigmas
                const double off = rotation_.frequency(), std = rotation_.std(cn0), unambiguous = 0.5 / period_;
                const bool beyond = !aided_ && stress_.phase() > 3.0 * phase_threshold;
                if (evident * std < 0.5 * unambiguous && (beyond || std::abs(off) > evident * std)) {
                    const double square = off * off + (beyond ? std * std : 0.0);
                    if (square > error_.frequency_variance()) error_.astray(square);
                    carrier.slope = 0.0;
                }
            }
            break;
        case Mode::CodeOnly: error_.hold(std::pow(std_aid_ / signal_.wavelength(), 2)); break;
        default: break;
    }
    noise.carrier_slope = carrier.slope;
    noise.carrier_variance = carrier.variance;
    error_.update(model(), noise);
    if (mode_ == Mode::Phase) stress_.add(phase, error_.output_variance());
}

double Tracker::phase_jitter() const { return std::sqrt(error_.phase_variance() + clock_phase_) + stress_.phase() / 3.0; }

double Tracker::frequency_variance() const {
    if (mode_ != Mode::Phase || !verified_ || phase_jitter() > threshold_) return std::numeric_limits<double>::infinity();
    return error_.frequency_variance() + std::pow(stress_.frequency(), 2);
}

double Tracker::false_step() const { return 0.5 / (settings_.integration * period_); }

bool Tracker::leave_false_lock() {
    // A frequency error of half a cycle per integration appears as lock to both discriminators. An aid carries the motion, so that the
    // frequency stays where the loop started, if that is known well enough; otherwise single code periods distinguish it from the true
    // one, which takes long in weak signals.
    const double step = false_step();
    anchored_ = aided_ && std::sqrt(opened_variance_ + error_.frequency_variance()) < step / 6.0;
    const double off = anchored_ ? assisted_.frequency() - opened_ : rotation_.frequency();
    rotation_.restart();
    const double steps = std::round(off / step);
    if (steps == 0.0) return false;
    assisted_.hand_over(steps * step, 0.0);
    return true;
}

bool Tracker::slipped_to_false_lock() {
    // The same in phase, where a signal that was lost for a moment, or dynamics, may have taken the loop there. The half step to the next
    // frequency has to be three sigma for a rate to be trusted, and five for the loop to be moved: that is tested all the time.
    const double step = false_step(), clear = step / 6.0, certain = step / 10.0;
    const double range = 3.0 * phase_threshold;  // cycles, where the discriminator ceases to be linear
    const bool followed = error_.phase_variance() + clock_phase_ <= range * range && stress_.phase() <= range &&
                          std::sqrt(error_.frequency_variance()) < clear;
    if (followed != followed_) rotation_.restart();  // what was before does not tell of what is now
    followed_ = followed;
    const double off = rotation_.frequency(), std = rotation_.std(cn0_.cn0());
    if (!followed) {
        verified_ = false;
    } else if (aided_ && anchored_ && std::sqrt(error_.unsettled_variance()) < clear) {
        verified_ = std::abs(phase_.frequency() - settled_) < step / 2.0;
    } else if (std < clear) {
        verified_ = std::abs(off) < step / 2.0;
        anchored_ = anchored_ || verified_;
    }
    if (!(std < certain)) return false;
    const double steps = std::round(off / step);
    rotation_.restart();
    phase_.hand_over(steps * step, 0.0);
    return steps != 0.0;
}

void Tracker::transitions() {
    const double interval = dumps_per_update() * period_;
    const auto longer = [&](double& clock, bool so) { return (clock = so ? clock + interval : 0.0); };
    switch (mode_) {
        case Mode::Blind:
            // symbol detection restarts after frequency pull-in
            if (time_in_mode_ >= settings_.pull_in_time && time_in_mode_ - interval < settings_.pull_in_time) {
                sync_ = SymbolSync(symbol_);
                listening_.start(blind_.frequency(), blind_.rate());
            }
            if (time_in_mode_ >= settings_.pull_in_time + settings_.sync_time) {
                dump_ = sync_.dumps_into_symbol();
                enter(Mode::Aligned);
            }
            break;
        case Mode::Aligned:
            if (time_in_mode_ >= settings_.pull_in_time) enter(Mode::Assisted);
            break;
        case Mode::Assisted:
            if (time_in_mode_ < settings_.pull_in_time) break;
            if (leave_false_lock()) {
                // noise alone causes this repeatedly
                if (++escapes_ > most_escapes) fail();
                else enter(Mode::Assisted);
            } else if (lock_.value() >= settings_.phase_lock) {
                settled_ = assisted_.frequency();
                error_.take_for_settled();
                escapes_ = 0;
                enter(Mode::Phase);
            } else if (time_in_mode_ >= 2.0 * settings_.pull_in_time + settings_.phase_patience) {
                fail();
            }
            break;
        case Mode::Phase: {
            const bool locked = lock_.value() >= settings_.phase_lock;
            if (slipped_to_false_lock()) {
                if (++escapes_ > most_escapes) fail();
                else enter(Mode::Assisted);
                break;
            }
            if (locked && (verified_ || !aided_)) {
                const double share = interval / (aided_ ? settled_aided : settled_alone);
                settled_ += share * (phase_.frequency() - settled_);
                error_.settle(share);
            }
            if (locked && time_in_mode_ > 5.0) attempts_ = 0;
            if (longer(unlocked_, !locked) >= settings_.phase_patience) fail();
            break;
        }
        case Mode::CodeOnly:
            if (longer(weak_, cn0_.cn0() < std::pow(10.0, settings_.code_lost_db / 10.0)) >= settings_.code_patience)
                enter(Mode::Lost);
            else if (time_in_mode_ >= retry_time && cn0_.cn0() >= std::pow(10.0, settings_.retry_db / 10.0))
                enter(Mode::Assisted);
            break;
        case Mode::Idle:
        case Mode::Lost: break;
    }
}

LineOfSight Tracker::motion() const {
    LineOfSight out = followed(signal_, replica_);
    if (follows() && mode_ != Mode::CodeOnly) {
        const double age = sums_.count * period_, middle = dumps_per_update() * period_ / 2.0;
        out.acceleration = -signal_.wavelength() * carrier().rate();
        out.rate -= out.acceleration * (middle - age);
    }
    if (aided_) {
        out.acceleration += aid_.acceleration;
        out.rate -= aid_.acceleration * period_ / 2.0;
    }
    return out;
}

void Tracker::command() {
    // For an aid that changes within the next period its middle is used.
    const double aid = aided_ ? -(aid_.rate + aid_.acceleration * period_ / 2.0) / signal_.wavelength() : 0.0;
    replica_.carrier_frequency = aid + loop_frequency_;
    replica_.code_rate = replica_.carrier_frequency * signal_.chips_per_cycle() + code_rate_;
}

}  // namespace schuler::receiver
