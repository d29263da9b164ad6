// Allan deviation of an instrument's output in one pass and bounded memory, and the noise coefficients derived from it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace schuler::analysis {

struct AllanPoint {
    double tau = 0.0;             ///< averaging time, s
    double deviation = 0.0;       ///< units of the rate
    double relative_sigma = 0.0;  ///< of the deviation: 1 / sqrt(2 (N / m - 1)) for clusters of m among N samples [IEEE952:C]
};

/// Processes a rate sample by sample. Clusters of m samples overlap: for m up to 7 by m - 1, beyond by 3/4 to 6/7 of their
/// length, because the longer ones consist of means of 2, 4, 8 ... samples.
class AllanDeviation {
public:
    /// `dt`: s between samples. @throws Error(Input) unless positive
    explicit AllanDeviation(double dt);

    /// `rate`: mean over the sample's interval.
    void add(double rate);

    /// Averaging times with at least nine clusters, ascending.
    [[nodiscard]] std::vector<AllanPoint> points() const;

private:
    static constexpr std::size_t longest = 7;  ///< clusters of one level, in samples of that level
    /// Sums over the last m samples and the m before them, for each m.
    struct Level {
        std::array<double, 2 * longest> last{};  ///< ring
        std::array<double, longest> newer{}, older{}, squares{};
        std::array<std::size_t, longest> differences{};
        std::size_t count = 0;
        double half = 0.0;  ///< first element of a pair for the next level
    };
    void add(std::size_t level, double mean);

    double dt_;
    double offset_ = 0.0;  ///< the first sample, subtracted to keep the sums small
    std::vector<Level> levels_;
};

/// Deviation squared = 3 Q^2 / t^2 + N^2 / t + (2 ln 2 / pi) B^2 + K^2 t / 3 + R^2 t^2 / 2 [IEEE952:C], in units of the rate
/// and s.
struct AllanCoefficients {
    double quantization = 0.0;      ///< Q, rate s
    double white = 0.0;             ///< N, rate sqrt(s): angle or velocity random walk
    double bias_instability = 0.0;  ///< B, rate
    double random_walk = 0.0;       ///< K, rate / sqrt(s)
    double ramp = 0.0;              ///< R, rate / s
};

/// Weighted least squares of the squared deviations, each with its own relative sigma, with non-negative coefficients: those not
/// required by the points are zero, and all of them without points.
[[nodiscard]] AllanCoefficients fitted(const std::vector<AllanPoint>& points);

}  // namespace schuler::analysis
