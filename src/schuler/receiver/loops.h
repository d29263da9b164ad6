// Loop filters of code and carrier: from discriminator outputs to generator commands.
#pragma once

namespace schuler::receiver {

/// Natural frequency (rad/s) of a loop for its one-sided noise bandwidth (Hz), and the damping terms of the standard form
/// [Kaplan2017]: second order s^2 + a2 w s + w^2, third order s^3 + b3 w s^2 + a3 w^2 s + w^3.
namespace loop {
inline constexpr double a2 = 1.414, a3 = 1.1, b3 = 2.4;
[[nodiscard]] constexpr double second_order(double bandwidth) { return bandwidth * 4.0 * a2 / (1.0 + a2 * a2); }
[[nodiscard]] constexpr double third_order(double bandwidth) {
    return bandwidth * 4.0 * (a3 * b3 - 1.0) / (a3 * b3 * b3 + a3 * a3 - b3);
}
/// Largest permitted product of bandwidth and update interval: beyond it the sampled loop deviates strongly from its continuous
/// design, and it is unstable from about 0.4.
inline constexpr double largest_product = 0.35;
}  // namespace loop

/// Carrier loop: third-order phase loop, second-order frequency loop, or the phase loop assisted by the frequency loop. Phase
/// errors enter in cycles, frequency errors in Hz; errors are replica minus signal.
class CarrierLoop {
public:
    /// Bandwidths in Hz; zero disables a loop. Throws Error(Input) if both are zero or one is too wide for the interval
    /// (s).
    CarrierLoop(double pll_bandwidth, double fll_bandwidth, double interval);

    /// Initial frequency and its rate, Hz and Hz/s.
    void start(double frequency, double rate = 0.0);
    /// Next frequency command, Hz.
    [[nodiscard]] double update(double phase_error, double frequency_error);
    /// Changes the loop's memory by -`frequency`, -`rate`, which are then supplied by a feed-forward aid.
    void hand_over(double frequency, double rate);

    [[nodiscard]] double frequency() const { return frequency_; }  ///< Hz, without the proportional part
    [[nodiscard]] double rate() const { return rate_; }            ///< Hz/s

private:
    double interval_, w_phase_, w_frequency_;
    double frequency_ = 0.0, rate_ = 0.0;
};

/// Second-order code loop. Errors in chips, commands in chips/s in addition to the aiding rate.
class CodeLoop {
public:
    /// Throws Error(Input) for a bandwidth (Hz) that is not positive or too wide for the interval (s).
    CodeLoop(double bandwidth, double interval);

    void start(double rate) { rate_ = rate; }
    [[nodiscard]] double update(double code_error);
    [[nodiscard]] double rate() const { return rate_; }

private:
    double interval_, w_;
    double rate_ = 0.0;
};

}  // namespace schuler::receiver
