#include "schuler/receiver/deep_channel.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::receiver {

namespace {

constexpr double quicker = 0.1;              ///< time constant of the second C/N0 estimate over that of the first
constexpr double settled = 0.25;             ///< of the first: required duration of a signal strength before a phase is accepted
constexpr double unknown_phase = 1.0;        ///< rad^2
constexpr double unknown_frequency = 100.0;  ///< Hz^2: the navigation is within 10 Hz
constexpr double unsaid_frequency = 0.25;    ///< Hz^2: in addition to the navigation's sigma
constexpr double said_time = 1.0;            ///< s, correlation time of the navigation's error
constexpr double agreed = 0.25;              ///< minimum cosine of the rotation between symbol halves for a tracked phase

}  // namespace

void DeepSettings::check() const {
    const auto between = [](double value, double low, double high, const char* key) {
        if (!(value > low && value <= high))
            throw input_error(fmt::format("{} is not between {} and {}", value, low, high), {.key = key});
    };
    between(spacing, 0.0, 1.0, "spacing");
    between(cn0_time, 0.0, 100.0, "cn0_time");
    between(lowest_db, -10.0, 60.0, "lowest_db");
    between(acceleration, 0.0, 1e4, "acceleration");
    between(followed, 0.0, 1.0, "followed");
}

DeepChannel::DeepChannel(const SignalStructure& signal, const CorrelationPeak& peak, const DeepSettings& settings)
    : signal_(signal),
      settings_((settings.check(), settings)),
      code_error_(peak, settings.spacing, CodeDiscriminator::EarlyLatePower),
      peak_(peak(0.0)),
      slope_(-peak.slope(settings.spacing / 2.0)),
      noise_(2.0 * (peak(0.0) - peak(settings.spacing))),
      period_(signal.code_period()),
      symbol_(static_cast<int>(std::lround(signal.symbol_duration / period_))),
      cn0_(signal.symbol_duration / 2.0, settings.cn0_time, peak_, 1000.0),
      quick_(signal.symbol_duration / 2.0, quicker * settings.cn0_time, peak_, 1000.0) {}

void DeepChannel::place() {
    // The middle of the coming code period is used; the carrier phase remains continuous.
    const double phase = replica_.carrier_phase;
    replica_ = aligned_replica(signal_, {predicted_.range, predicted_.after(period_ / 2.0).rate});
    replica_.carrier_phase = phase;
}

void DeepChannel::start(const LineOfSight& predicted, int dumps_into_symbol) {
    predicted_ = predicted;
    dump_ = ((dumps_into_symbol % symbol_) + symbol_) % symbol_;
    counted_ = 0;
    cn0_ = Cn0Estimator(signal_.symbol_duration / 2.0, settings_.cn0_time, peak_, 1.0);
    cn0_.forget();
    quick_ = Cn0Estimator(signal_.symbol_duration / 2.0, quicker * settings_.cn0_time, peak_, 1.0);
    quick_.forget();
    listened_ = steady_ = 0.0;
    carrier_.setZero();
    turns_ = agreement_ = 0.0;
    P_ << unknown_phase, 0.0, 0.0, unknown_frequency;
    scatter_ = P_;
    halves_[0] = halves_[1] = {};
    place();
}

void DeepChannel::command(const LineOfSight& predicted, double std_rate) {
    std_rate_ = std_rate;
    steer(predicted);
}

void DeepChannel::steer(const LineOfSight& predicted) {
    predicted_ = predicted;
    place();
}

std::optional<ChannelMeasurement> DeepChannel::step(const Correlators& dump) {
    replica_ = replica_.after(period_);
    predicted_ = predicted_.after(period_);
    const bool whole = counted_ == dump_;  // a symbol joined in its middle is skipped
    Correlators& half = halves_[2 * dump_ / symbol_];
    half.early += dump.early;
    half.prompt += dump.prompt;
    half.late += dump.late;
    dump_ = (dump_ + 1) % symbol_;
    std::optional<ChannelMeasurement> out;
    if (whole) ++counted_;
    if (dump_ == 0) {
        if (counted_ == symbol_) out = finish();
        counted_ = 0;
        halves_[0] = halves_[1] = {};
    }
    place();
    return out;
}

void DeepChannel::follow_phase(std::complex<double> half) {
    // Forward half a symbol: the frequency rotates the phase, the unknown acceleration is a random walk of frequency.
    const double T = signal_.symbol_duration / 2.0, q = std::pow(settings_.acceleration / signal_.wavelength(), 2);
    Eigen::Matrix2d F;
    F << 1.0, turn * T, 0.0, 1.0;
    Eigen::Matrix2d Q;
    Q << turn * turn * T * T * T / 3.0, turn * T * T / 2.0, turn * T * T / 2.0, T;
    carrier_ = F * carrier_;
    P_ = (F * P_ * F.transpose()).eval() + q * Q;
    // The sum determines the phase at the middle of the half symbol, modulo half a cycle, independent of the message; I times Q
    // is used instead of the arctangent, whose slope decreases in noise.
    const Eigen::RowVector2d H(1.0, -turn * T / 2.0);
    const double power = 2.0 * cn0_.cn0() * T * peak_, variance = 1.0 / power * (1.0 + 1.0 / power);
    const std::complex<double> turned = half * std::polar(1.0, (H * carrier_).value());
    const double innovation = -turned.real() * turned.imag() / (power * peak_);
    const double S = (H * P_ * H.transpose())(0) + variance;
    const Eigen::Vector2d K = P_ * H.transpose() / S;
    carrier_ += K * innovation;
    P_ = (P_ - K * S * K.transpose()).eval();
    const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - K * H;
    scatter_ = (left * F * scatter_ * F.transpose() * left.transpose() + variance * K * K.transpose()).eval();
}

void DeepChannel::judge_power(double both) {
    // A signal that reappears or breaks off is not averaged: residuals scaled by the old power would be wrong by the ratio of
    // both.
    constexpr double appears = 8.0, breaks_off = 5.0;  // sigmas of two squared prompts
    constexpr double changes = 4.0;                    // of the fast mean
    const double half = signal_.symbol_duration / 2.0, power = 2.0 * cn0_.cn0() * half * peak_ * peak_;
    const double expected = 2.0 * (power + 2.0 * peak_), sigma = std::sqrt(8.0 * peak_ * (peak_ + power));
    if (both > expected + appears * sigma || both < expected - breaks_off * sigma) {
        listened_ = settings_.cn0_time;
        cn0_.restart((0.5 * both - 2.0 * peak_) / (2.0 * half * peak_ * peak_));
        quick_.restart(cn0_.cn0());
        steady_ = 0.0;
        return;
    }
    listened_ += signal_.symbol_duration;
    steady_ += signal_.symbol_duration;
    for (const Correlators& c : halves_) {
        cn0_.add(c.prompt);
        quick_.add(c.prompt);
    }
    // of a mean over n prompts, whose squares have the sigma 2 sqrt(R0 (R0 + P))
    const double n = std::max(1.0, 2.0 * quicker * settings_.cn0_time / half);
    const double scatter = 2.0 * std::sqrt(peak_ * (peak_ + power) / n) / (2.0 * half * peak_ * peak_);
    if (std::abs(quick_.cn0() - cn0_.cn0()) > changes * scatter) {
        cn0_.restart(quick_.cn0());
        steady_ = 0.0;
    }
}

ChannelMeasurement DeepChannel::finish() {
    const double scale = 1.0 / std::sqrt(symbol_ / 2.0);
    for (Correlators& c : halves_) {
        c.early *= scale;
        c.prompt *= scale;
        c.late *= scale;
    }
    judge_power(std::norm(halves_[0].prompt) + std::norm(halves_[1].prompt));
    ChannelMeasurement out;
    out.duration = signal_.symbol_duration;
    out.cn0 = cn0_.cn0();
    const bool strong = listened_ >= 0.5 * settings_.cn0_time && db_from_cn0(out.cn0) >= settings_.lowest_db;
    if (strong) measure(out);
    if (settings_.prefilter == Prefilter::Coherent) follow(out);
    return out;
}

void DeepChannel::measure(ChannelMeasurement& out) const {
    // Code from the whole symbol (its halves are out of phase by 43 degrees at 12 Hz, which costs 0.6 dB); the rotation between
    // the halves by its sine, whose noise follows the formula for any signal strength.
    const double half = out.duration / 2.0, power = 2.0 * out.cn0 * half;  // of each half symbol
    const auto whole = [&](std::complex<double> Correlators::*sum) {
        return (halves_[0].*sum + halves_[1].*sum) / std::sqrt(2.0);
    };
    const Correlators symbol{whole(&Correlators::early), whole(&Correlators::prompt), whole(&Correlators::late)};
    const double aligned = power * peak_ * peak_, per_turn = -1.0 / (turn * half * aligned);
    const double frequency = per_turn * (halves_[1].prompt * std::conj(halves_[0].prompt)).imag();
    const double chip = signal_.chip_length(), wavelength = signal_.wavelength();
    out.status = ChannelMeasurement::Status::Noncoherent;
    out.range = -chip * code_error_.unlimited(symbol, 2.0 * power);
    out.range_variance = chip * chip * code_error_.variance(2.0 * power);
    out.rate = -wavelength * frequency;
    out.rate_variance = std::pow(wavelength * per_turn, 2) * 2.0 * peak_ * (aligned + peak_);
}

void DeepChannel::follow(ChannelMeasurement& out) {
    const bool strong = out.status != ChannelMeasurement::Status::NoSignal;
    const double half = out.duration / 2.0, power = 2.0 * out.cn0 * half, aligned = power * peak_ * peak_;
    // A false frequency rotates the halves against each other, while the phase, insensitive to half cycles, may appear steady.
    // The averaging time gives an accuracy of a quarter; a strong signal is evident within one symbol.
    const double scatter = 2.0 * peak_ * (aligned + peak_) / (aligned * aligned), share = std::min(1.0, 0.125 / scatter);
    agreement_ += share * ((halves_[1].prompt * std::conj(halves_[0].prompt)).real() / aligned - agreement_);
    if (!strong) agreement_ = 0.0;
    // The frequency is the error of the navigation's prediction, which changes as the navigation improves.
    const double chip = signal_.chip_length(), wavelength = signal_.wavelength();
    const double kept = std::exp(-out.duration / said_time);
    const double said = std::min(unknown_frequency, std::pow(std_rate_ / wavelength, 2) + unsaid_frequency);
    carrier_[1] *= kept;
    P_(0, 1) = P_(1, 0) = kept * P_(0, 1);
    P_(1, 1) = kept * kept * P_(1, 1) + (1.0 - kept * kept) * said;
    scatter_(0, 1) = scatter_(1, 0) = kept * scatter_(0, 1);
    scatter_(1, 1) *= kept * kept;
    double prompt = 0.0, late_less_early = 0.0;
    for (const Correlators& c : halves_) {
        follow_phase(c.prompt);
        // rotated back to the filter's estimate of the signal at the middle of the half
        const std::complex<double> back = std::polar(std::sqrt(0.5), carrier_[0] - turn * carrier_[1] * half / 2.0);
        prompt += (c.prompt * back).real();
        late_less_early += ((c.late - c.early) * back).real();
    }
    if (P_(0, 0) > unknown_phase) {
        carrier_[0] = 0.0;
        P_ << unknown_phase, 0.0, 0.0, unknown_frequency;
        scatter_ = P_;
    }
    const double within = std::remainder(carrier_[0], turn);
    turns_ += carrier_[0] - within;
    carrier_[0] = within;
    // A newly found strength may be a noise peak, which would make the phase appear certain.
    const bool steady = steady_ >= settled * settings_.cn0_time;
    if (!strong || !steady || agreement_ < agreed || P_(0, 0) > settings_.followed * settings_.followed) return;
    // the prompt contributes the message's sign, and noise that is known for any signal strength
    const double gain = 4.0 * slope_ * peak_ * power;
    out.status = ChannelMeasurement::Status::Coherent;
    out.range = -chip * late_less_early * prompt / gain;
    out.range_variance = chip * chip * noise_ * (2.0 * aligned + peak_) / (gain * gain);
    out.carrier = -wavelength * (turns_ + within) / turn;
    out.carrier_variance = std::pow(wavelength / turn, 2) * scatter_(0, 0);
}

}  // namespace schuler::receiver
