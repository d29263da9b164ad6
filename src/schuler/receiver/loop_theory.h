// Closed formulas of tracking: thermal jitter and dynamic stress error. Reference for evaluating the loops, which do not use
// them; a receiver derives its stated sigmas from them.
#pragma once

#include "schuler/receiver/discriminators.h"

namespace schuler::receiver::theory {

/// Standard deviation of a Costas loop's phase, rad, with the squaring loss [Kaplan2017]. cn0 in Hz.
[[nodiscard]] double pll_jitter(double bandwidth, double cn0, double interval);

/// Response of a third-order phase loop to noise in its commanded frequency: sums over the impulse responses of the sampled loop;
/// at 15 Hz with updates every 10 ms it passes half as much again as the continuous one.
struct PllResponse {
    double noise = 0.0;  ///< Hz^2: variance of the command for a phase error of one cycle, one sigma, in each sum
    /// 1/s: variance of the command (cycles^2/s^2) for white frequency noise of density 1 (cycles^2/s): the part common to the
    /// commands of all channels at one instant, and the part of each channel, because their sums do not end simultaneously.
    double clock_common = 0.0, clock_own = 0.0;
};
/// For a loop that sums `integration` code periods of `period` s. Bandwidth in Hz.
[[nodiscard]] PllResponse pll_response(double bandwidth, int integration, double period);

/// Standard deviation of the frequency commanded by such a loop, Hz, due to the noise of its sums of `interval` s, with squaring loss.
[[nodiscard]] double pll_command_jitter(const PllResponse& response, double cn0, double interval);

/// Standard deviation of a frequency loop's frequency, Hz, with a discriminator that uses disjoint pairs of prompts of `interval`
/// s [Kaplan2017], F = 1.
[[nodiscard]] double fll_jitter(double bandwidth, double cn0, double interval);

/// Standard deviation of a noncoherent code loop, chips: [Betz2009] for early minus late power, written with the peak of the
/// front end used; the dot product differs in its squaring loss [VanDierendonck1996].
[[nodiscard]] double dll_jitter(double bandwidth, double cn0, double interval, const CorrelationPeak& peak, double spacing,
                                CodeDiscriminator kind);

/// Steady-state error of a loop under the lowest derivative it does not follow [Kaplan2017]: third-order phase loop and jerk
/// (cycles/s^3 to cycles), second-order frequency loop and the second derivative of frequency (Hz/s^2 to Hz), second-order code
/// loop and acceleration (chips/s^2 to chips). Sign: replica minus signal.
[[nodiscard]] double pll_stress(double bandwidth, double jerk);
[[nodiscard]] double fll_stress(double bandwidth, double second_derivative);
[[nodiscard]] double dll_stress(double bandwidth, double acceleration);

}  // namespace schuler::receiver::theory
