#include "schuler/math/spectrum.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <kissfft/kissfft.hh>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace schuler::math {

struct Spectrum::Work {
    Work(double rate_, std::size_t segment_) : rate(rate_), segment(segment_), transform(segment_ / 2, false), window(segment_) {
        for (std::size_t i = 0; i < segment; ++i)
            window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(segment));
        square = std::inner_product(window.begin(), window.end(), window.begin(), 0.0);
        values.reserve(segment);
        windowed.resize(segment);
        lines.resize(segment / 2);
        sum.assign(segment / 2 + 1, 0.0);
    }

    void take_segment() {
        const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(segment);
        for (std::size_t i = 0; i < segment; ++i) windowed[i] = window[i] * (values[i] - mean);
        transform.transform_real(windowed.data(), lines.data());
        // zero and the highest frequency, both real, share the first element
        sum.front() += lines.front().real() * lines.front().real();
        sum.back() += lines.front().imag() * lines.front().imag();
        for (std::size_t i = 1; i < segment / 2; ++i) sum[i] += 2.0 * std::norm(lines[i]);
        ++count;
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(segment / 2));
    }

    double rate;
    std::size_t segment;
    kissfft<double> transform;
    std::vector<double> window, values, windowed, sum;
    std::vector<std::complex<double>> lines;
    double square = 0.0;
    std::size_t count = 0;
};

Spectrum::Spectrum(double rate, std::size_t segment) {
    if (!(rate > 0.0) || segment < 8 || !std::has_single_bit(segment))
        throw input_error(fmt::format("no spectrum at {} Hz in segments of {}", rate, segment), {},
                          "give a positive rate and a power of two from 8 on");
    work_ = std::make_unique<Work>(rate, segment);
}

Spectrum::~Spectrum() = default;
Spectrum::Spectrum(Spectrum&&) noexcept = default;
Spectrum& Spectrum::operator=(Spectrum&&) noexcept = default;

void Spectrum::add(double value) {
    work_->values.push_back(value);
    if (work_->values.size() == work_->segment) work_->take_segment();
}

std::size_t Spectrum::segments() const { return work_->count; }

double Spectrum::frequency(std::size_t i) const {
    return static_cast<double>(i) * work_->rate / static_cast<double>(work_->segment);
}

std::vector<double> Spectrum::density() const {
    if (work_->count == 0) return {};
    std::vector<double> out = work_->sum;
    const double scale = 1.0 / (work_->rate * work_->square * static_cast<double>(work_->count));
    for (double& x : out) x *= scale;
    return out;
}

}  // namespace schuler::math
