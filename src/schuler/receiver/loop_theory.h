// Closed formulas of tracking: thermal jitter and the error that dynamics leave. What the loops are judged by; no loop uses them,
// but a receiver states its sigmas by them.
#pragma once

#include "schuler/receiver/discriminators.h"

namespace schuler::receiver::theory {

/// Standard deviation of a Costas loop's phase, rad, with the squaring loss [Kaplan2017]. cn0 in Hz.
[[nodiscard]] double pll_jitter(double bandwidth, double cn0, double interval);

/// What a third-order phase loop makes of noise in the frequency that it commands: sums over its impulse responses as it is sampled, which a
/// loop of 15 Hz updated every 10 ms passes on half as much again as the continuous one.
struct PllResponse {
    double noise = 0.0;  ///< Hz^2: variance of the command where the phase of each sum errs by one cycle, one sigma
    /// 1/s: variance of the command (cycles^2/s^2) by a white frequency noise of density 1 (cycles^2/s): what the commands of all channels at one
    /// instant have in common, and what each has by itself, because their sums do not end together.
    double clock_common = 0.0, clock_own = 0.0;
};
/// Of a loop that sums `integration` code periods of `period` s. Bandwidth in Hz.
[[nodiscard]] PllResponse pll_response(double bandwidth, int integration, double period);

/// Standard deviation of the frequency that such a loop commands, Hz, by the noise of its sums of `interval` s, with the squaring loss.
[[nodiscard]] double pll_command_jitter(const PllResponse& response, double cn0, double interval);

/// Standard deviation of a frequency loop's frequency, Hz, its discriminator taking prompts of `interval` s in pairs that share
/// none [Kaplan2017], F = 1.
[[nodiscard]] double fll_jitter(double bandwidth, double cn0, double interval);

/// Standard deviation of a noncoherent code loop, chips: [Betz2009] for early minus late power, written with the peak of the
/// front end used; the dot product differs in its squaring loss [VanDierendonck1996].
[[nodiscard]] double dll_jitter(double bandwidth, double cn0, double interval, const CorrelationPeak& peak, double spacing,
                                CodeDiscriminator kind);

/// Steady error a loop keeps under the derivative that its order does not follow [Kaplan2017]: third-order phase loop and
/// jerk (cycles/s^3 to cycles), second-order frequency loop and the second derivative of frequency (Hz/s^2 to Hz), second-order
/// code loop and acceleration (chips/s^2 to chips). Sign: replica minus signal.
[[nodiscard]] double pll_stress(double bandwidth, double jerk);
[[nodiscard]] double fll_stress(double bandwidth, double second_derivative);
[[nodiscard]] double dll_stress(double bandwidth, double acceleration);

}  // namespace schuler::receiver::theory
