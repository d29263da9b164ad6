// Amplitude and phase response of an estimator, measured with a harmonic or an impulse.
#pragma once

#include <vector>

namespace schuler::gravimetry {

/// Response to sin(2 pi (s - start)/length): gain sin(2 pi (s - start)/length - lag).
struct HarmonicResponse {
    double gain = 0.0;
    double lag = 0.0;       ///< rad, positive if the output is late
    double residual = 0.0;  ///< root mean square of the remainder, relative to the input's amplitude
};

/// Least squares of sine, cosine and a constant over y(s) for an input of amplitude `size`. @throws Error(Input) for fewer than four
/// points.
[[nodiscard]] HarmonicResponse harmonic_response(const std::vector<double>& s, const std::vector<double>& y, double length,
                                                 double start, double size);

/// Width of a peak at half its height, by linear interpolation; NaN if it does not fall below half on both sides.
[[nodiscard]] double half_width(const std::vector<double>& s, const std::vector<double>& y);

/// Paper E's correction: the estimate advanced by the lag (in s of the abscissa) and divided by the gain, about its mean.
[[nodiscard]] std::vector<double> corrected_for(const std::vector<double>& s, const std::vector<double>& y,
                                                const HarmonicResponse& response, double length);

}  // namespace schuler::gravimetry
