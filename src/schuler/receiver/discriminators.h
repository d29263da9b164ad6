// Replica errors from a correlator dump: estimates of replica minus signal.
#pragma once

#include "schuler/receiver/correlator.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace schuler::receiver {

/// Phase error modulo half a cycle, rad in (-pi/2, pi/2], independent of the message's sign: the two-quadrant arctangent of
/// Costas loops [Kaplan2017].
[[nodiscard]] inline double costas_phase(std::complex<double> prompt) {
    return prompt.real() == 0.0 ? 0.0 : -std::atan(prompt.imag() / prompt.real());
}

/// Frequency error in Hz from two prompts of equal sign `interval` s apart (middle to middle); within +-1/(2
/// interval).
[[nodiscard]] inline double frequency_between(std::complex<double> first, std::complex<double> second, double interval) {
    return -std::arg(second * std::conj(first)) / (2.0 * std::numbers::pi * interval);
}

/// The same if the sign may have changed between them; within +-1/(4 interval).
[[nodiscard]] inline double frequency_across_bits(std::complex<double> first, std::complex<double> second, double interval) {
    return costas_phase(second * std::conj(first)) / (2.0 * std::numbers::pi * interval);
}

enum class CodeDiscriminator {
    EarlyLatePower,  ///< |E|^2 - |L|^2
    DotProduct,      ///< Re((E - L) P*): quasi-coherent
};

/// Code error in chips, for a peak and a spacing. Normalised by a signal power known or estimated beforehand, not by that of the
/// same dump: the gain thus remains the design value of the loop bandwidth at any C/N0.
class CodeError {
public:
    CodeError(const CorrelationPeak& peak, double spacing, CodeDiscriminator kind)
        : kind_(kind),
          limit_(spacing),
          noise_(2.0 * (peak(0.0) - peak(spacing))),
          squared_(kind == CodeDiscriminator::EarlyLatePower ? peak(0.0) + peak(spacing) : peak(0.0)),
          amplitude_(kind == CodeDiscriminator::EarlyLatePower ? 2.0 * peak(spacing / 2.0) : peak(0.0)),
          gain_(-2.0 * peak.slope(spacing / 2.0) *
                (kind == CodeDiscriminator::EarlyLatePower ? 2.0 * peak(spacing / 2.0) : peak(0.0))) {}

    /// @param power squared amplitude of an aligned prompt without band limit (2 C/N0 T). The result is limited to +-spacing.
    [[nodiscard]] double operator()(const Correlators& c, double power) const {
        return std::clamp(difference(c) / (gain_ * power), -limit_, limit_);
    }
    /// Not limited: for filters that weight by variance.
    [[nodiscard]] double unlimited(const Correlators& c, double power) const { return difference(c) / (gain_ * power); }
    /// Variance of unlimited() for an aligned replica, chips^2: signal times noise and noise times noise, both linear in the
    /// noise of late minus early.
    [[nodiscard]] double variance(double power) const { return variance(power, power); }
    /// The same if the signal has another power than is `assumed` for the normalisation; the slope is then power / assumed.
    [[nodiscard]] double variance(double power, double assumed) const {
        const double products = kind_ == CodeDiscriminator::EarlyLatePower ? 4.0 * squared_ : 2.0 * squared_;
        return noise_ * (amplitude_ * amplitude_ * power + products) / (gain_ * gain_ * assumed * assumed);
    }
    /// Mean slope and variance (chips^2) of the limited error operator() if the unlimited one scatters by `sigma` chips.
    struct Limited {
        double slope, variance;
    };
    [[nodiscard]] Limited limited(double sigma) const {
        const double a = limit_ / sigma, inside = std::erf(a / std::numbers::sqrt2);
        return {inside, sigma * sigma * (inside - a * std::sqrt(2.0 / std::numbers::pi) * std::exp(-a * a / 2.0)) +
                            limit_ * limit_ * (1.0 - inside)};
    }

private:
    [[nodiscard]] double difference(const Correlators& c) const {
        if (kind_ == CodeDiscriminator::EarlyLatePower) return std::norm(c.late) - std::norm(c.early);
        return ((c.late - c.early) * std::conj(c.prompt)).real();
    }

    CodeDiscriminator kind_;
    double limit_, noise_, squared_, amplitude_, gain_;
};

}  // namespace schuler::receiver
