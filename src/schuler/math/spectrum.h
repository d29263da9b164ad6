// Power spectral density of a series by averaged periodograms, in one pass and bounded memory.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace schuler::math {

/// Estimates the one-sided power spectral density: half-overlapping segments whose length is a power of two, mean removed, with
/// Hann window [Welch1967]. For white noise of variance s^2 it is 2 s^2 / rate at every frequency; its integral over frequency is the
/// variance.
class Spectrum {
public:
    /// `rate` in Hz; `segment`: number of samples, a power of two, at least 8. @throws Error(Input)
    Spectrum(double rate, std::size_t segment);
    ~Spectrum();
    Spectrum(Spectrum&&) noexcept;
    Spectrum& operator=(Spectrum&&) noexcept;

    void add(double value);

    [[nodiscard]] std::size_t segments() const;
    /// Frequency of density()[i]: i rate / segment, Hz, up to half the rate.
    [[nodiscard]] double frequency(std::size_t i) const;
    /// segment / 2 + 1 values in units of the input squared per Hz; empty before the first complete segment.
    [[nodiscard]] std::vector<double> density() const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace schuler::math
