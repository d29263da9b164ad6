#include "schuler/receiver/oscillator.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::receiver {

namespace {

constexpr double shortest = 0.01;  ///< s, time constant of the fastest part of the flicker; neighbours differ by a decade

}  // namespace

void OscillatorSettings::check() const {
    const auto need = [](double value, const char* key) {
        if (!(std::isfinite(value) && value >= 0.0))
            throw input_error(fmt::format("{} is not a size of noise", value), {.key = key}, "give zero or more");
    };
    need(h0, "h0");
    need(h_1, "h_1");
    need(h_2, "h_2");
    need(frequency_std, "frequency_std");
    if (!g_sensitivity.allFinite()) throw input_error("not a number", {.key = "g_sensitivity"});
}

OscillatorSettings tcxo() { return {2e-21, 1e-22, 2e-20, 1e-6, Eigen::Vector3d::Constant(1e-9 / units::g0)}; }

OscillatorSettings ocxo() { return {2e-25, 7e-25, 6e-25, 1e-8, Eigen::Vector3d::Constant(1e-10 / units::g0)}; }

Oscillator::Oscillator(const OscillatorSettings& settings, math::Random& random) : settings_(settings) {
    settings.check();
    // A Gauss-Markov process of variance s^2 and time constant T has S_y = 4 s^2 T / (1 + (2 pi f T)^2); the sum over T with n
    // parts per natural logarithm is n s^2 / f, so one part per decade has s^2 = h_1 ln 10.
    flicker_std_ = std::sqrt(settings.h_1 * std::numbers::ln10);
    for (double& part : flicker_) part = flicker_std_ * random.normal();
    walk_ = settings.frequency_std * random.normal();
}

void Oscillator::prepare(double dt) {
    // A Gauss-Markov process and its integral over a step, jointly; a slow part is linear within the step.
    double constant = shortest;
    for (Transition& t : transitions_) {
        const double a = dt / constant, k = std::exp(-a), left = -std::expm1(-a);
        const double noise = std::sqrt(-std::expm1(-2.0 * a));
        t.kept = k;
        t.noise = flicker_std_ * noise;
        if (a < 0.01) {
            t.phase_from_state = 0.5 * dt * (1.0 + k);
            t.phase_shared = 0.5 * dt * t.noise;
            t.phase_own = 0.0;
        } else {
            const double covariance = left * left, variance = 2.0 * a - 3.0 + 4.0 * k - k * k;
            t.phase_from_state = constant * left;
            t.phase_shared = flicker_std_ * constant * covariance / noise;
            t.phase_own = flicker_std_ * constant * std::sqrt(variance - covariance * covariance / (noise * noise));
        }
        constant *= 10.0;
    }
    prepared_ = dt;
}

void Oscillator::step(double dt, const Eigen::Vector3d& f_b, math::Random& random) {
    if (!(dt > 0.0)) return;
    double phase = settings_.g_sensitivity.dot(f_b) * dt;
    if (settings_.h0 > 0.0) phase += std::sqrt(0.5 * settings_.h0 * dt) * random.normal();
    // Random walk of density q = 2 pi^2 h_2: the increments of frequency and phase are correlated [Brown2012:9.3].
    const double step = std::sqrt(2.0 * settings_.h_2 * dt) * std::numbers::pi * random.normal();
    const double bridge = std::sqrt(2.0 * settings_.h_2 * dt * dt * dt / 12.0) * std::numbers::pi * random.normal();
    phase += (walk_ + 0.5 * step) * dt + bridge;
    walk_ += step;
    if (dt != prepared_) prepare(dt);
    for (std::size_t i = 0; i < decades; ++i) {
        const Transition& t = transitions_[i];
        const double n = random.normal();
        phase += t.phase_from_state * flicker_[i] + t.phase_shared * n;
        if (t.phase_own > 0.0) phase += t.phase_own * random.normal();
        flicker_[i] = t.kept * flicker_[i] + t.noise * n;
    }
    offset_ += phase;
    drift_ = phase / dt;
}

}  // namespace schuler::receiver
