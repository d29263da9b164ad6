#include "schuler/receiver/if_samples.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace schuler::receiver {

namespace {

constexpr double period = 1e-3;  ///< s
constexpr double chip_rate = 1.023e6;
constexpr int guard = 2;  ///< chips before the period in a correlator's table

double fraction(double x) { return x - std::floor(x); }

}  // namespace

void IfFormat::check() const {
    if (!(sample_rate >= 2.0 * chip_rate && sample_rate <= 200e6))
        throw input_error(fmt::format("sample rate {} Hz", sample_rate), {.key = "sample_rate"},
                          "give 2.046e6 to 200e6 complex samples a second");
    if (!(std::abs(intermediate_frequency) + chip_rate <= 0.5 * sample_rate))
        throw input_error(fmt::format("the signal at {} Hz does not fit into {} samples/s", intermediate_frequency, sample_rate),
                          {.key = "intermediate_frequency"}, "give less than half the sample rate less 1.023 MHz");
}

std::size_t IfFormat::samples_per_period() const { return static_cast<std::size_t>(std::lround(sample_rate * period)); }

IfGenerator::IfGenerator(const IfFormat& format, std::span<const IfSatellite> satellites, std::uint64_t seed, double noise_std)
    : format_((format.check(), format)), sum_(format.samples_per_period()), random_(seed, "if"), noise_std_(noise_std) {
    const double samples = format.sample_rate * period;
    if (std::abs(samples - std::round(samples)) > 1e-9 * samples)
        throw input_error(fmt::format("sample rate {} Hz has no whole number of samples a millisecond", format.sample_rate),
                          {.key = "sample_rate"}, "give a multiple of 1000 Hz");
    if (!(noise_std > 0.5 && noise_std < 42.0))
        throw input_error(fmt::format("noise of {} steps does not fit 8 bits", noise_std), {.key = "noise_std"},
                          "give 0.5 to 42");
    for (const IfSatellite& s : satellites) sources_.push_back({s, ca_code(s.prn)});
}

void IfGenerator::generate(std::span<IfSample> out) {
    if (out.size() != sum_.size()) throw input_error(fmt::format("{} samples for a period of {}", out.size(), sum_.size()));
    const SignalStructure signal = gps_l1_ca();
    const double begin = static_cast<double>(period_) * period, dt = 1.0 / format_.sample_rate;
    for (std::complex<float>& x : sum_)
        x = {static_cast<float>(noise_std_ * random_.normal()), static_cast<float>(noise_std_ * random_.normal())};
    for (const Source& s : sources_) {
        // white noise of variance s^2 in I and Q over the sample rate: N0 = 2 s^2 / f_s
        const double amplitude = noise_std_ * std::sqrt(2.0 * s.satellite.cn0 / format_.sample_rate);
        const LineOfSight a = s.satellite.motion.after(begin);
        const LineOfSight b = s.satellite.motion.after(begin + period);
        const double rate = (b.range - a.range) / period;
        const double code = chip_rate * begin - a.range / signal.chip_length(),
                     code_step = (chip_rate - rate / signal.chip_length()) * dt;
        const double cycles = format_.intermediate_frequency * begin - a.range / signal.wavelength();
        const double cycles_step = (format_.intermediate_frequency - rate / signal.wavelength()) * dt;
        std::complex<double> phasor = std::polar(amplitude, turn * fraction(cycles));
        const std::complex<double> rotate = std::polar(1.0, turn * cycles_step);
        double symbol_of_sign = -1e300, sign = 1.0;
        for (std::size_t i = 0; i < sum_.size(); ++i) {
            const double chips = code + code_step * static_cast<double>(i);
            const double periods = std::floor(chips / 1023.0), symbol = std::floor(periods / 20.0);
            if (symbol != symbol_of_sign) {
                symbol_of_sign = symbol;
                const auto number = static_cast<std::uint64_t>(static_cast<std::int64_t>(symbol));
                sign =
                    math::Random(s.satellite.message ^ (number * 0x9e3779b97f4a7c15ULL), "message").bits() % 2 == 0 ? 1.0 : -1.0;
            }
            const double value = sign * s.code[static_cast<std::size_t>(chips - 1023.0 * periods)];
            sum_[i] += std::complex<float>(value * phasor);
            phasor *= rotate;
        }
    }
    const auto quantize = [](float x) { return static_cast<std::int8_t>(std::clamp(std::nearbyint(x), -127.0F, 127.0F)); };
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {quantize(sum_[i].real()), quantize(sum_[i].imag())};
    ++period_;
}

SampleCorrelator::SampleCorrelator(const IfFormat& format, int prn, double spacing)
    : format_((format.check(), format)), spacing_(spacing) {
    if (!(spacing > 0.0 && spacing < 2.0))
        throw input_error(fmt::format("correlator spacing {} chips is not between 0 and 2", spacing), {.key = "spacing"});
    const CaCode code = ca_code(prn);
    // two periods, so that a dump may start anywhere in the first
    for (int i = -guard; i < 2 * 1023 + 3; ++i) table_.push_back(code[static_cast<std::size_t>((i + 1023) % 1023)]);
    for (std::vector<float>* v : {&carrier_re_, &carrier_im_, &early_, &prompt_, &late_}) v->resize(format.samples_per_period());
}

Correlators SampleCorrelator::correlate(std::span<const IfSample> samples, double begin, const Replica& replica,
                                        double noise_std) {
    const std::size_t n = format_.samples_per_period();
    if (samples.size() != n) throw input_error(fmt::format("{} samples for a period of {}", samples.size(), n));
    // carrier: lanes of eight phases rotated by eight samples at a time
    constexpr std::size_t lanes = 8;
    const double cycles = fraction(format_.intermediate_frequency * begin + replica.carrier_phase);
    const double per_sample = (format_.intermediate_frequency + replica.carrier_frequency) / format_.sample_rate;
    std::array<float, lanes> re, im;
    for (std::size_t k = 0; k < lanes; ++k) {
        const double angle = -turn * (cycles + per_sample * static_cast<double>(k));
        re[k] = static_cast<float>(std::cos(angle));
        im[k] = static_cast<float>(std::sin(angle));
    }
    const auto turn_re = static_cast<float>(std::cos(turn * per_sample * lanes)),
               turn_im = static_cast<float>(-std::sin(turn * per_sample * lanes));
    const auto* raw = reinterpret_cast<const std::int8_t*>(samples.data());
    for (std::size_t i = 0; i < n; i += lanes) {
        const std::size_t count = std::min(lanes, n - i);
        for (std::size_t k = 0; k < count; ++k) {
            const float x = raw[2 * (i + k)], y = raw[2 * (i + k) + 1];
            carrier_re_[i + k] = x * re[k] - y * im[k];
            carrier_im_[i + k] = x * im[k] + y * re[k];
        }
        for (std::size_t k = 0; k < lanes; ++k) {
            const float r = re[k] * turn_re - im[k] * turn_im;
            im[k] = re[k] * turn_im + im[k] * turn_re;
            re[k] = r;
        }
    }
    const double chips = chip_rate * begin + replica.code_phase, step = (chip_rate + replica.code_rate) / format_.sample_rate;
    const double start = chips - 1023.0 * std::floor(chips / 1023.0) + guard;
    const auto fill = [&](std::vector<float>& out, double offset) {
        const auto first = static_cast<float>(start + offset), delta = static_cast<float>(step);
        for (std::size_t i = 0; i < n; ++i)
            out[i] = table_[static_cast<std::size_t>(static_cast<int>(first + delta * static_cast<float>(static_cast<int>(i))))];
    };
    fill(early_, spacing_ / 2.0);
    fill(prompt_, 0.0);
    fill(late_, -spacing_ / 2.0);
    using Row = Eigen::Map<const Eigen::ArrayXf>;
    const auto size = static_cast<Eigen::Index>(n);
    const Row x(carrier_re_.data(), size), y(carrier_im_.data(), size);
    const double scale = 1.0 / (noise_std * std::sqrt(static_cast<double>(n)));
    const auto sum = [&](const std::vector<float>& code) {
        const Row c(code.data(), size);
        return scale * std::complex<double>((x * c).sum(), (y * c).sum());
    };
    return {sum(early_), sum(prompt_), sum(late_)};
}

double noise_of(std::span<const IfSample> samples) {
    double sum = 0.0;
    for (const IfSample& s : samples) sum += s.real() * s.real() + s.imag() * s.imag();
    return std::sqrt(sum / (2.0 * static_cast<double>(samples.size())));
}

}  // namespace schuler::receiver
