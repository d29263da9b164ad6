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
/// Largest product of bandwidth and update interval that a loop is allowed: beyond it the sampled loop is far from the continuous
/// one it was computed as, and unstable from about 0.4 on.
inline constexpr double largest_product = 0.35;
}  // namespace loop

/// Carrier loop: third-order phase loop, second-order frequency loop, or the phase loop assisted by the frequency loop. Phase
/// errors enter in cycles, frequency errors in Hz; errors are replica minus signal.
class CarrierLoop {
public:
    /// Bandwidths in Hz; zero leaves that loop out. Throws Error(Input) when both are zero or one is too wide for the interval
    /// (s).
    CarrierLoop(double pll_bandwidth, double fll_bandwidth, double interval);

    /// Frequency and its rate to begin with, Hz and Hz/s.
    void start(double frequency, double rate = 0.0);
    /// Next frequency command, Hz.
    [[nodiscard]] double update(double phase_error, double frequency_error);
    /// Moves the loop's memory by -`frequency`, -`rate`: an aid that is fed forward takes this part over.
    void hand_over(double frequency, double rate);

    [[nodiscard]] double frequency() const { return frequency_; }  ///< Hz, without the proportional part
    [[nodiscard]] double rate() const { return rate_; }            ///< Hz/s

private:
    double interval_, w_phase_, w_frequency_;
    double frequency_ = 0.0, rate_ = 0.0;
};

/// Second-order code loop. Errors in chips, commands in chips/s beyond what aids it.
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
