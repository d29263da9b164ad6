// Closed formulas of tracking: thermal jitter and the error that dynamics leave. What the loops are judged by; no loop uses them,
// but a receiver states its sigmas by them.
#pragma once

#include "schuler/receiver/discriminators.h"

namespace schuler::receiver::theory {

/// Standard deviation of a Costas loop's phase, rad, with the squaring loss [Kaplan2017]. cn0 in Hz.
[[nodiscard]] double pll_jitter(double bandwidth, double cn0, double interval);

/// Standard deviation of the frequency that a third-order phase loop commands, Hz: its proportional part passes the noise of each
/// sum and of the phase on, its memory the integral of |(a3 w^2 s^2 + w^3 s) / (s^3 + b3 w s^2 + a3 w^2 s + w^3)|^2.
[[nodiscard]] double pll_command_jitter(double bandwidth, double cn0, double interval);

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
