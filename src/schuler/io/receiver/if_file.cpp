#include "schuler/io/receiver/if_file.h"

#include "schuler/core/error.h"
#include "schuler/io/regular_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace schuler::io {

namespace {

constexpr std::size_t looked_at = 65536, least_looked_at = 1000;  // samples, for recognising a format
constexpr float wanted_rms = 24.0F;                               // steps: quantisation costs 0.001 dB, clipping is 5 sigma away
constexpr unsigned sign_bit = 0x80U;                              ///< if inverted, signed bytes become unsigned ones less 128
constexpr const char* own_format = "give the format it was written in: ibyte, ubyte, ishort or gr_complex";

static_assert(std::endian::native == std::endian::little, "words and floats are read as they lie");

std::size_t bytes_of(IfEncoding encoding) { return encoding == IfEncoding::Floats ? 8 : encoding == IfEncoding::Words ? 4 : 2; }

template <class T>
float value_at(const char* raw) {
    T out;
    std::memcpy(&out, raw, sizeof out);
    return static_cast<float>(out);
}

/// The numbers of one sample as stored; unsigned bytes relative to their middle.
std::complex<float> sample_at(const char* raw, IfEncoding encoding) {
    switch (encoding) {
        case IfEncoding::SignedBytes: return {value_at<std::int8_t>(raw), value_at<std::int8_t>(raw + 1)};
        case IfEncoding::UnsignedBytes: return {value_at<std::uint8_t>(raw) - 127.5F, value_at<std::uint8_t>(raw + 1) - 127.5F};
        case IfEncoding::Words: return {value_at<std::int16_t>(raw), value_at<std::int16_t>(raw + 2)};
        case IfEncoding::Floats: break;
    }
    return {value_at<float>(raw), value_at<float>(raw + 4)};
}

int turned(char byte, unsigned turned_over) { return static_cast<std::int8_t>(static_cast<unsigned char>(byte) ^ turned_over); }

/// Fraction of bytes in the outer quarter of the scale.
double outer_share(std::span<const char> raw, unsigned turned_over) {
    const auto outside = [&](char c) {
        const int v = turned(c, turned_over);
        return v >= 96 || v < -96;
    };
    return static_cast<double>(std::ranges::count_if(raw, outside)) / static_cast<double>(raw.size());
}

/// Low and high bytes of words have similar statistics, and low ones are not uniform: two bytes were read as a word.
bool words_made_of_bytes(std::span<const char> raw, unsigned turned_over) {
    double low = 0.0, high = 0.0;
    for (std::size_t i = 0; i + 1 < raw.size(); i += 2) {
        const double a = turned(raw[i], turned_over), b = turned(raw[i + 1], turned_over);
        low += a * a;
        high += b * b;
    }
    const double words = static_cast<double>(raw.size()) / 2.0;
    constexpr double even = 128.0 * 128.0 / 3.0;  // mean square of a uniformly distributed byte
    return high > words && low < 0.65 * even * words && std::max(low, high) < 4.0 * std::min(low, high);
}

struct Moments {
    std::complex<double> mean;
    double power_i = 0.0, power_q = 0.0;
};

Moments moments_of(std::span<const std::complex<float>> samples) {
    Moments m;
    const auto n = static_cast<double>(samples.size());
    for (const std::complex<float>& s : samples) m.mean += std::complex<double>(s) / n;
    for (const std::complex<float>& s : samples) {
        const std::complex<double> d = std::complex<double>(s) - m.mean;
        m.power_i += d.real() * d.real() / n;
        m.power_q += d.imag() * d.imag() / n;
    }
    return m;
}

void check_numbers(std::span<const std::complex<float>> samples, const SourcePlace& place) {
    const auto absurd = [](const std::complex<float>& s) { return !(std::abs(s.real()) < 1e30F && std::abs(s.imag()) < 1e30F); };
    if (std::ranges::any_of(samples, absurd))
        throw input_error("contains values that are not samples of a signal", place, own_format);
    const Moments m = moments_of(samples);
    const double power = m.power_i + m.power_q;
    if (!(power > 0.0))
        throw input_error(fmt::format("holds one value throughout {} samples", samples.size()), place,
                          "give a recording with a signal, or leave out its silent beginning");
    if (!(16.0 * std::min(m.power_i, m.power_q) > std::max(m.power_i, m.power_q)))
        throw input_error(fmt::format("I and Q differ in power, {:.3g} and {:.3g}", m.power_i, m.power_q), place,
                          std::string(own_format) + "; real samples have to be made complex");
    if (std::norm(m.mean) > power)
        throw input_error(fmt::format("a constant of {:.3g} exceeds the noise of {:.3g}", std::abs(m.mean), std::sqrt(power)),
                          place, own_format);
}

void check_bytes(std::span<const char> raw, IfEncoding encoding, const SourcePlace& place) {
    if (encoding == IfEncoding::Words && (words_made_of_bytes(raw, 0U) || words_made_of_bytes(raw, sign_bit)))
        throw input_error("its words look like pairs of bytes", place, "give the format ibyte, or ubyte");
    if (encoding != IfEncoding::SignedBytes && encoding != IfEncoding::UnsignedBytes) return;
    const bool is_signed = encoding == IfEncoding::SignedBytes;
    const double outer = outer_share(raw, is_signed ? 0U : sign_bit);
    if (outer < 0.15) return;
    if (outer_share(raw, is_signed ? sign_bit : 0U) < 0.02)
        throw input_error(fmt::format("its bytes look {}, or saturated", is_signed ? "unsigned" : "signed"), place,
                          fmt::format("give the format {}, or a recording with less gain", is_signed ? "ubyte" : "ibyte"));
    throw input_error(
        fmt::format("{:.0f} % of its bytes lie near the ends of the scale: saturated, compressed or of another format",
                    100.0 * outer),
        place, own_format);
}

}  // namespace

IfEncoding if_encoding(std::string_view name) {
    if (name == "ibyte") return IfEncoding::SignedBytes;
    if (name == "ubyte") return IfEncoding::UnsignedBytes;
    if (name == "ishort") return IfEncoding::Words;
    if (name == "gr_complex") return IfEncoding::Floats;
    throw input_error(fmt::format("unknown sample format '{}'", name), {.key = "format"},
                      "give ibyte, ubyte, ishort or gr_complex: signed or unsigned bytes, 16-bit words, floats, I and Q in turn");
}

IfFile::IfFile(const std::filesystem::path& path, std::string_view format, std::uintmax_t start)
    : path_(path), encoding_(if_encoding(format)) {
    const SourcePlace place{.file = path.string()};
    std::error_code failed;
    check_regular_file(path);
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    file_.open(path, std::ios::binary);
    if (failed || !file_) throw input_error("cannot be read", place, "give a recording of samples");
    if (bytes == 0) throw input_error("holds no samples", place, "give a recording of samples");
    const std::size_t each = bytes_of(encoding_);
    if (bytes % each != 0)
        throw input_error(fmt::format("{} bytes end within a sample of {}", bytes, each), place,
                          "give pairs of I and Q; a file cut short loses its last bytes, real samples have to be made complex");
    if (start >= bytes / each)
        throw input_error(fmt::format("holds {} samples, none after {}", bytes / each, start),
                          {.file = path.string(), .key = "start"}, "begin earlier");
    size_ = bytes / each - start;
    const auto begin = static_cast<std::streamoff>(start * each);
    file_.seekg(begin);
    const std::vector<std::complex<float>> samples = head();
    if (samples.size() >= least_looked_at) {
        check_bytes(raw_, encoding_, place);
        check_numbers(samples, place);
    }
    if (encoding_ == IfEncoding::Words || encoding_ == IfEncoding::Floats) {
        const Moments m = moments_of(samples);
        const double rms = std::sqrt((m.power_i + m.power_q) / 2.0);
        if (rms > 0.0 && std::isfinite(rms)) scale_ = wanted_rms / static_cast<float>(rms);
    }
    file_.clear();
    file_.seekg(begin);
}

std::vector<std::complex<float>> IfFile::head() {
    const std::size_t each = bytes_of(encoding_), count = static_cast<std::size_t>(std::min<std::uintmax_t>(size_, looked_at));
    raw_.resize(count * each);
    if (!file_.read(raw_.data(), static_cast<std::streamsize>(raw_.size())))
        throw input_error("cannot be read", {.file = path_.string()}, "give a recording of samples");
    std::vector<std::complex<float>> out(count);
    for (std::size_t i = 0; i < count; ++i) out[i] = sample_at(raw_.data() + i * each, encoding_);
    return out;
}

bool IfFile::read(std::span<std::complex<std::int8_t>> out) {
    const std::size_t each = bytes_of(encoding_);
    if (encoding_ == IfEncoding::SignedBytes)
        return static_cast<bool>(
            file_.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(each * out.size())));
    raw_.resize(each * out.size());
    if (!file_.read(raw_.data(), static_cast<std::streamsize>(raw_.size()))) return false;
    if (encoding_ == IfEncoding::UnsignedBytes) {
        // the middle 127.5 is not a step: a constant of half a step remains
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = {static_cast<std::int8_t>(static_cast<unsigned char>(raw_[2 * i]) - 128),
                      static_cast<std::int8_t>(static_cast<unsigned char>(raw_[2 * i + 1]) - 128)};
        return true;
    }
    const auto step = [](float x) {
        return static_cast<std::int8_t>(std::isnan(x) ? 0.0F : std::clamp(std::nearbyint(x), -127.0F, 127.0F));
    };
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::complex<float> s = scale_ * sample_at(raw_.data() + i * each, encoding_);
        out[i] = {step(s.real()), step(s.imag())};
    }
    return true;
}

}  // namespace schuler::io
