#include "schuler/core/error.h"
#include "schuler/math/chi_square.h"
#include "schuler/receiver/if_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::receiver {

namespace {

/// The largest product of powers of 2, 3 and 5 not above n.
std::size_t quick_size(std::size_t n) {
    for (;; --n) {
        std::size_t rest = n;
        for (const std::size_t prime : {2, 3, 5})
            while (rest % prime == 0) rest /= prime;
        if (rest == 1) return n;
    }
}

/// Mean square of a C/A code's side lobes relative to the peak: that of a random code at whole chips, two thirds between them.
constexpr double side_lobes = 2.0 / 3.0 / 1023.0;

/// Mean of the cells of a Doppler over one and a half chips from the peak: at other Dopplers the signal is spread over all cells.
double mean_beside(std::span<const float> power, std::size_t peak) {
    const std::size_t n = power.size(), reach = 3 * n / (2 * 1023) + 1;
    double sum = 0.0;
    for (std::size_t i = reach + 1; i < n - reach; ++i) sum += power[(peak + i) % n];
    return sum / static_cast<double>(n - 2 * reach - 1);
}

}  // namespace

double Acquired::cn0(int periods) const { return std::max(0.0, statistic / (2.0 * periods) - 1.0) / gps_l1_ca().code_period(); }

FftAcquisition::FftAcquisition(const IfFormat& format, double doppler, int periods, double false_alarm)
    : format_((format.check(), format)),
      doppler_(doppler),
      step_(500.0),
      false_alarm_(false_alarm),
      periods_(periods),
      fft_(quick_size(format.samples_per_period())) {
    if (!(doppler >= 0.0 && doppler <= 0.25 * format.sample_rate))
        throw input_error(fmt::format("a Doppler of {} Hz", doppler), {.key = "doppler"},
                          "give 0 to a quarter of the sample rate");
    if (periods < 1 || periods > 10'000)
        throw input_error(fmt::format("{} code periods", periods), {.key = "periods"}, "give 1 to 10000");
    if (!(false_alarm > 0.0 && false_alarm < 1.0))
        throw input_error(fmt::format("false alarm probability {}", false_alarm), {.key = "false_alarm"}, "give 0 to 1");
}

std::size_t FftAcquisition::samples_needed() const { return beginning(periods_ - 1) + format_.samples_per_period(); }

std::size_t FftAcquisition::beginning(int number) const {
    return static_cast<std::size_t>(std::lround(number * format_.sample_rate * gps_l1_ca().code_period()));
}

Acquired FftAcquisition::acquire(std::span<const IfSample> samples, int prn) const {
    if (samples.size() < samples_needed())
        throw input_error(fmt::format("{} samples are too few to search, {} are needed", samples.size(), samples_needed()));
    const std::size_t n = fft_.size(), all = format_.samples_per_period();
    const CaCode code = ca_code(prn);
    std::vector<std::complex<float>> reference(n), block(n), spectrum(n);
    for (std::size_t i = 0; i < n; ++i)
        block[i] = static_cast<float>(code[static_cast<std::size_t>(static_cast<double>(i) * 1023.0 / static_cast<double>(n))]);
    fft_.forward(block, reference);
    const int bins = static_cast<int>(std::ceil(doppler_ / step_));
    std::vector<float> power(n), power_of_best(n);
    double best = 0.0, total = 0.0, doppler = 0.0;
    std::size_t place = 0;
    for (int bin = -bins; bin <= bins; ++bin) {
        std::ranges::fill(power, 0.0F);
        const double frequency = format_.intermediate_frequency + bin * step_;
        for (int p = 0; p < periods_; ++p) {
            std::complex<double> phasor = 1.0;
            const std::complex<double> rotate = std::polar(1.0, -2.0 * std::numbers::pi * frequency / format_.sample_rate);
            const std::size_t begin = beginning(p);
            for (std::size_t i = 0, k = 0; i < n; ++i) {
                for (const std::size_t picked = i * all / n; k < picked; ++k) phasor *= rotate;
                const IfSample s = samples[begin + k];
                block[i] = std::complex<float>(phasor) * std::complex<float>(s.real(), s.imag());
            }
            fft_.forward(block, spectrum);
            for (std::size_t i = 0; i < n; ++i) spectrum[i] *= std::conj(reference[i]);
            fft_.inverse(spectrum, block);
            for (std::size_t i = 0; i < n; ++i) power[i] += std::norm(block[i]);
        }
        bool in_this_bin = false;
        for (std::size_t i = 0; i < n; ++i) {
            total += power[i];
            if (power[i] > best) {
                best = power[i];
                place = i;
                doppler = bin * step_;
                in_this_bin = true;
            }
        }
        if (in_this_bin) power_of_best = power;
    }
    const double cells = static_cast<double>(n) * (2.0 * bins + 1.0), freedom = 2.0 * periods_;
    Acquired out;
    out.statistic = best / (total / cells) * freedom;
    // the cells of one chip and of neighbouring bins are not independent: the threshold is conservative
    out.threshold = math::chi_square_quantile(1.0 - false_alarm_ / cells, freedom);
    out.found = out.statistic > out.threshold;
    const double beside = mean_beside(power_of_best, place);
    out.noise = std::sqrt(std::max(0.1 * beside, beside - side_lobes * (best - beside)) / (freedom * static_cast<double>(n)));
    // the code starts this fraction of a period after the first sample
    out.replica.code_phase = -static_cast<double>(place) * 1023.0 / static_cast<double>(n);
    out.replica.carrier_frequency = doppler;
    out.replica.code_rate = doppler * gps_l1_ca().chips_per_cycle();
    return out;
}

}  // namespace schuler::receiver
