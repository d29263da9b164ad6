// Lock detectors: signal strength, and whether the carrier phase is tracked.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace schuler::receiver {

/// Exponential average of C/N0 from the power of prompts, noise known to have unit variance in I and Q: an aligned prompt of T s has
/// E|P|^2 = 2 C/N0 T R0^2 + 2 R0.
class Cn0Average {
public:
    /// @param interval s per prompt; @param time_constant s; @param peak R0 = R(0) of the front end; @param guess initial, Hz.
    Cn0Average(double interval, double time_constant, double peak, double guess)
        : time_constant_(time_constant), peak_(peak), cn0_(guess) {
        change_interval(interval);
    }
    void change_interval(double interval) {
        interval_ = interval;
        gain_ = std::min(1.0, interval / time_constant_);
    }

protected:
    /// By one prompt, Hz.
    [[nodiscard]] double cn0_of(std::complex<double> prompt) const {
        return (std::norm(prompt) - 2.0 * peak_) / (2.0 * interval_ * peak_ * peak_);
    }

    double time_constant_, peak_, cn0_;
    double interval_ = 0.0, gain_ = 0.0;
};

/// The average that a channel states.
class Cn0Estimator : public Cn0Average {
public:
    using Cn0Average::Cn0Average;

    void add(std::complex<double> prompt) {
        mean_gain_ = std::max(gain_, mean_gain_ / (1.0 + mean_gain_));
        cn0_ += mean_gain_ * (cn0_of(prompt) - cn0_);
    }
    /// Continues from a value as accurate as an average over the time constant, or restarts: the mean of the following
    /// data.
    void restart(double cn0) {
        cn0_ = cn0;
        mean_gain_ = gain_;
    }
    void forget() { mean_gain_ = 1e9; }
    /// Hz; not below 1 Hz.
    [[nodiscard]] double cn0() const { return std::max(1.0, cn0_); }

private:
    double mean_gain_ = 0.0;
};

/// C/N0 of the last prompts, to detect where an average no longer describes the noise of a loop: a signal that fades or breaks off. The
/// averaging time is the memory of the loop, 1/(2 bandwidth). The amplitude of a prompt has unit noise: one that is smaller than
/// expected by more than that allows restarts the mean, since an average takes long to forget a strong signal.
class FadingCn0 : public Cn0Average {
public:
    using Cn0Average::Cn0Average;

    void add(std::complex<double> prompt) {
        constexpr double breaks_off = 3.0;  // sigmas
        const double amplitude = std::abs(prompt) / std::sqrt(peak_);
        const bool broken = amplitude + breaks_off < std::sqrt(2.0 * interval_ * peak_ * std::max(0.0, cn0_));
        cn0_ += (broken ? 1.0 : gain_) * (cn0_of(prompt) - cn0_);
    }
    /// The C/N0 to be assumed for the noise of the last prompts, Hz: `averaged`, or if the mean of the last ones differs from it by
    /// more than its scatter explains, this mean. Not below 1 Hz.
    [[nodiscard]] double recent(double averaged) const { return differs(averaged) ? std::max(1.0, cn0_) : averaged; }
    /// The same, but of a mean that differs what is surely there: without a signal the mean scatters about zero.
    [[nodiscard]] double surely(double averaged) const {
        return differs(averaged) ? std::clamp(cn0_ - scatters * scatter(std::max(0.0, cn0_)), 0.0, averaged) : averaged;
    }

private:
    static constexpr double scatters = 3.0;  // sigmas
    /// One sigma of the mean, Hz, of prompts of this C/N0.
    [[nodiscard]] double scatter(double cn0) const {
        const double unit = 2.0 * interval_ * peak_;
        return 2.0 * std::sqrt((unit * cn0 + 1.0) * gain_ / (2.0 - gain_)) / unit;
    }
    [[nodiscard]] bool differs(double averaged) const { return std::abs(cn0_ - averaged) > scatters * scatter(averaged); }
};

/// Narrow-band difference over narrow-band power, the low-passed (I^2 - Q^2) / (I^2 + Q^2) [VanDierendonck1996]: near cos(2 phi)
/// for a tracked carrier, near zero for noise or another frequency.
class PhaseLockDetector {
public:
    PhaseLockDetector(double interval, double time_constant) : gain_(std::min(1.0, interval / time_constant)) {}

    void add(std::complex<double> prompt) {
        difference_ += gain_ * (prompt.real() * prompt.real() - prompt.imag() * prompt.imag() - difference_);
        power_ += gain_ * (std::norm(prompt) - power_);
    }
    [[nodiscard]] double value() const { return power_ > 0.0 ? difference_ / power_ : 0.0; }

private:
    double gain_, difference_ = 0.0, power_ = 0.0;
};

/// Rotation of the prompts of single code periods, which no message and no phase loop conceals: a Costas loop also locks half a cycle
/// a sum away from the signal.
class PromptRotation {
public:
    /// @param period s per prompt; @param peak R0 = R(0) of the front end.
    PromptRotation(double period, double peak) : period_(period), peak_(peak) {}

    void restart() {
        sum_ = last_ = 0.0;
        count_ = 0;
    }
    void add(std::complex<double> prompt) {
        sum_ += prompt * std::conj(last_);
        last_ = prompt;
        ++count_;
    }
    /// Mean frequency since the restart, Hz, replica minus signal; within +-1/(2 period).
    [[nodiscard]] double frequency() const { return -std::arg(sum_) / (2.0 * std::numbers::pi * period_); }
    /// One sigma of it, Hz: a product of neighbours, of power P over the noise, has the variance 2 P + 2 across its mean P. P is that of
    /// the sum itself if this is less than `cn0` says.
    [[nodiscard]] double std(double cn0) const {
        const double n = std::max(1, count_), power = std::min(2.0 * cn0 * period_ * peak_, std::abs(sum_) / (n * peak_));
        return std::sqrt((2.0 * power + 2.0) / n) / power / (2.0 * std::numbers::pi * period_);
    }

private:
    double period_, peak_;
    std::complex<double> sum_ = 0.0, last_ = 0.0;
    int count_ = 0;
};

/// Location of the sign changes of the message: for each possible location the products of successive prompts are accumulated,
/// and the start of the symbols has the smallest sum. Insensitive to frequency errors much below the code rate.
class SymbolSync {
public:
    static constexpr int longest = 20;  ///< dumps a symbol
    explicit SymbolSync(int dumps_per_symbol) : length_(dumps_per_symbol) {}

    void add(std::complex<double> prompt) {
        kept_[place_] += (prompt * std::conj(before_)).real();
        before_ = prompt;
        place_ = (place_ + 1) % length_;
    }
    /// For the next dump; 0 starts a symbol.
    [[nodiscard]] int dumps_into_symbol() const {
        const auto begin = static_cast<int>(std::min_element(kept_, kept_ + length_) - kept_);
        return (place_ - begin + length_) % length_;
    }

private:
    int length_, place_ = 0;
    std::complex<double> before_ = 0.0;
    double kept_[longest]{};
};

}  // namespace schuler::receiver
