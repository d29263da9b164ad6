// Intermediate-frequency samples: format, generation for tests, correlation and search.
#pragma once

#include "schuler/math/fft.h"
#include "schuler/math/random.h"
#include "schuler/receiver/ca_code.h"
#include "schuler/receiver/correlator.h"

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

namespace schuler::receiver {

using IfSample = std::complex<std::int8_t>;

struct IfFormat {
    double sample_rate = 4e6;             ///< complex samples/s
    double intermediate_frequency = 0.0;  ///< Hz

    /// Throws Error(Input) below two samples per chip, above 200 MHz, or if the signal's main lobe does not fit within plus and
    /// minus half the sample rate.
    void check() const;
    [[nodiscard]] std::size_t samples_per_period() const;  ///< nearest to a millisecond
};

/// A satellite to be generated. Time starts at the first sample, to which `motion` refers.
struct IfSatellite {
    int prn;
    LineOfSight motion;
    double cn0;             ///< Hz
    std::uint64_t message;  ///< seed of its random message
};

/// GPS L1 C/A in white noise, 8 bits, noise of `noise_std` steps in I and in Q.
class IfGenerator {
public:
    /// Throws Error(Input) if a millisecond is not a whole number of samples, or the noise does not fit.
    IfGenerator(const IfFormat& format, std::span<const IfSatellite> satellites, std::uint64_t seed, double noise_std = 24.0);
    /// The next code period's samples.
    void generate(std::span<IfSample> out);

private:
    struct Source {
        IfSatellite satellite;
        CaCode code;
    };
    IfFormat format_;
    std::vector<Source> sources_;
    std::vector<std::complex<float>> sum_;
    math::Random random_;
    double noise_std_;
    long period_ = 0;
};

/// Correlates a code period of samples with the replicas of one satellite, scaled as in CorrelatorModel: noise of unit variance.
/// Allocates at construction only.
class SampleCorrelator {
public:
    SampleCorrelator(const IfFormat& format, int prn, double spacing);
    /// @param begin time of the first sample since the replica's time zero, s; @param replica at that instant;
    /// @param noise_std of I and of Q in steps.
    [[nodiscard]] Correlators correlate(std::span<const IfSample> samples, double begin, const Replica& replica,
                                        double noise_std);

private:
    IfFormat format_;
    double spacing_;
    std::vector<float> table_;  ///< chips, with two before and three after a period
    std::vector<float> carrier_re_, carrier_im_, early_, prompt_, late_;
};

/// Root mean square of I and Q together over sqrt(2): the noise, since the signals are below it.
[[nodiscard]] double noise_of(std::span<const IfSample> samples);

struct Acquired {
    bool found = false;
    Replica replica;         ///< at the first sample
    double statistic = 0.0;  ///< twice the largest cell over the mean of all: chi-square for noise
    double threshold = 0.0;
    double noise = 0.0;  ///< of I and of Q, steps: white noise that explains the mean of the cells, in the band of the code

    /// Hz, from the statistic of a search over `periods` milliseconds: a decibel or two low between cells.
    [[nodiscard]] double cn0(int periods) const;
};

/// Searches code and Doppler with circular correlations by FFT, one code period coherent, `periods` of them noncoherent. If the
/// number of samples per period has a slow transform, some samples are omitted.
class FftAcquisition {
public:
    /// @param doppler Hz, half width of the search; @param false_alarm probability over all cells.
    FftAcquisition(const IfFormat& format, double doppler = 5000.0, int periods = 10, double false_alarm = 1e-4);
    /// Throws Error(Input) if there are fewer samples than `periods` require.
    [[nodiscard]] Acquired acquire(std::span<const IfSample> samples, int prn) const;
    [[nodiscard]] std::size_t samples_needed() const;

private:
    [[nodiscard]] std::size_t beginning(int number) const;  ///< first sample of a code period

    IfFormat format_;
    double doppler_, step_, false_alarm_;
    int periods_;
    math::Fft fft_;
};

}  // namespace schuler::receiver
