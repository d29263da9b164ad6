// Power spectral density of a series by averaged periodograms, in one pass and bounded memory.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace schuler::math {

/// Estimates the one-sided power spectral density: segments of a power of two that overlap by half, each less its mean, under
/// Hann's window [Welch1967]. For white noise of variance s^2 it is 2 s^2 / rate at every frequency; its integral over frequency is the
/// variance.
class Spectrum {
public:
    /// `rate` in Hz; `segment`: samples, a power of two from 8 on. @throws Error(Input)
    Spectrum(double rate, std::size_t segment);
    ~Spectrum();
    Spectrum(Spectrum&&) noexcept;
    Spectrum& operator=(Spectrum&&) noexcept;

    void add(double value);

    [[nodiscard]] std::size_t segments() const;
    /// Of density()[i]: i rate / segment, Hz, up to half the rate.
    [[nodiscard]] double frequency(std::size_t i) const;
    /// Units of the values squared per Hz, segment / 2 + 1 of them; empty before the first whole segment.
    [[nodiscard]] std::vector<double> density() const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace schuler::math
