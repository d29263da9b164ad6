// Discrete Fourier transforms of any length.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>

namespace schuler::math {

/// Transforms of `size` complex numbers, single precision; fast if size is a product of powers of 2, 3 and 5. Allocates only
/// at construction, and may be shared by threads.
class Fft {
public:
    /// Throws Error(Input) for size 0.
    explicit Fft(std::size_t size);
    ~Fft();
    Fft(Fft&&) noexcept;
    Fft& operator=(Fft&&) noexcept;

    [[nodiscard]] std::size_t size() const;
    /// out_k = sum over n of in_n e^{-2 pi i k n / size}. Both of length `size`, not overlapping; throws Error(Input) otherwise.
    void forward(std::span<const std::complex<float>> in, std::span<std::complex<float>> out) const;
    /// The inverse of forward(), scaled by 1/size.
    void inverse(std::span<const std::complex<float>> in, std::span<std::complex<float>> out) const;

private:
    struct Plans;
    std::unique_ptr<const Plans> plans_;
};

}  // namespace schuler::math
