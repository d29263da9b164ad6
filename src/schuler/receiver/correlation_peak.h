// Correlation of a band-limited signal with its replica.
#pragma once

#include <limits>
#include <vector>

namespace schuler::receiver {

/// R(tau) = integral over |f| < b of sinc^2(f) cos(2 pi f tau) df, b half the two-sided band in chip rates: a rectangular code of
/// random chips through an ideal front end [Groves2013]. R is both the signal's amplitude at a code error tau and the covariance
/// of the noise of two correlators tau apart, because both passed the same filter. Side lobes of a particular code are neglected:
/// beyond two chips R is zero.
class CorrelationPeak {
public:
    /// @param bandwidth two-sided, Hz; infinite: the triangle. Throws Error(Input) below 0.5 chip rates.
    CorrelationPeak(double chip_rate, double bandwidth = std::numeric_limits<double>::infinity());

    [[nodiscard]] double operator()(double tau) const;  ///< tau in chips
    [[nodiscard]] double slope(double tau) const;       ///< dR/dtau, 1/chip; 0 at the tip of the triangle
    [[nodiscard]] bool triangle() const { return table_.empty(); }

private:
    struct Node {
        double value, slope;
    };
    std::vector<Node> table_;  ///< for tau = 0 to 2, from the closed form; cubic between the nodes
};

/// Sine integral Si(x), error below 1e-12.
[[nodiscard]] double sine_integral(double x);

}  // namespace schuler::receiver
