// Samples of an intermediate frequency: how they are taken, made for tests, correlated and searched.
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

    /// Throws Error(Input) below two samples a chip, above 200 MHz, or when the signal's main lobe does not fit between the
    /// frequencies of half the sample rate.
    void check() const;
    [[nodiscard]] std::size_t samples_per_period() const;  ///< nearest to a millisecond
};

/// A satellite to be made. Time counts from the first sample, when `motion` holds.
struct IfSatellite {
    int prn;
    LineOfSight motion;
    double cn0;             ///< Hz
    std::uint64_t message;  ///< seed of its random message
};

/// GPS L1 C/A in white noise, 8 bits, a noise of `noise_std` steps in I and in Q.
class IfGenerator {
public:
    /// Throws Error(Input) for no whole number of samples a millisecond, and a noise that does not fit.
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

/// Correlates a code period of samples with the replicas of one satellite, scaled as CorrelatorModel does: noise of unit
/// variance. Allocates at construction only.
class SampleCorrelator {
public:
    SampleCorrelator(const IfFormat& format, int prn, double spacing);
    /// @param begin time of the first sample since the replica's time zero, s; @param replica at that moment;
    /// @param noise_std of I and of Q in steps.
    [[nodiscard]] Correlators correlate(std::span<const IfSample> samples, double begin, const Replica& replica,
                                        double noise_std);

private:
    IfFormat format_;
    double spacing_;
    std::vector<float> table_;  ///< chips, with two before and three after a period
    std::vector<float> carrier_re_, carrier_im_, early_, prompt_, late_;
};

/// Root mean square of I and Q together over sqrt(2): the noise, since the signals lie below it.
[[nodiscard]] double noise_of(std::span<const IfSample> samples);

struct Acquired {
    bool found = false;
    Replica replica;         ///< at the first sample
    double statistic = 0.0;  ///< twice the largest cell over the mean of all: chi-square for noise
    double threshold = 0.0;
    double noise = 0.0;  ///< of I and of Q, steps: what white noise needs for the mean of the cells, as the code's band sees it

    /// Hz, from the statistic of a search over `periods` milliseconds: a decibel or two low between cells.
    [[nodiscard]] double cn0(int periods) const;
};

/// Searches code and Doppler with circular correlations by FFT, one code period coherent, `periods` of them noncoherently. Where
/// a period has a number of samples whose transform is slow, some of them are left out.
class FftAcquisition {
public:
    /// @param doppler Hz, half width of the search; @param false_alarm probability over all the cells.
    FftAcquisition(const IfFormat& format, double doppler = 5000.0, int periods = 10, double false_alarm = 1e-4);
    /// Throws Error(Input) when there are fewer samples than `periods` need.
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
