#include "schuler/math/fft.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <kissfft/kissfft.hh>

namespace schuler::math {

struct Fft::Plans {
    explicit Plans(std::size_t n) : size(n), forward(n, false), inverse(n, true) {}
    void check(std::size_t in, std::size_t out) const {
        if (in != size || out != size) throw input_error(fmt::format("a transform of {} of {} numbers into {}", size, in, out));
    }
    std::size_t size;
    kissfft<float> forward, inverse;
};

Fft::Fft(std::size_t size) {
    if (size == 0) throw input_error("a transform of no numbers");
    plans_ = std::make_unique<const Plans>(size);
}
Fft::~Fft() = default;
Fft::Fft(Fft&&) noexcept = default;
Fft& Fft::operator=(Fft&&) noexcept = default;

std::size_t Fft::size() const { return plans_->size; }

void Fft::forward(std::span<const std::complex<float>> in, std::span<std::complex<float>> out) const {
    plans_->check(in.size(), out.size());
    plans_->forward.transform(in.data(), out.data());
}

void Fft::inverse(std::span<const std::complex<float>> in, std::span<std::complex<float>> out) const {
    plans_->check(in.size(), out.size());
    plans_->inverse.transform(in.data(), out.data());
    const float scale = 1.0F / static_cast<float>(size());
    for (std::complex<float>& x : out) x *= scale;
}

}  // namespace schuler::math
