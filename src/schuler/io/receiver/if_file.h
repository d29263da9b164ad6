// Intermediate-frequency recordings: complex samples without a header, in common recorder formats.
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

namespace schuler::io {

/// Sample encoding, I before Q: signed bytes, unsigned bytes about 127.5, signed 16-bit words, 32-bit floats; the wider ones
/// little-endian.
enum class IfEncoding { SignedBytes, UnsignedBytes, Words, Floats };

/// "ibyte", "ubyte", "ishort" or "gr_complex", with the names of gnss-sdr if it has one; throws Error(Input) otherwise.
[[nodiscard]] IfEncoding if_encoding(std::string_view name);

/// A recording read sequentially as samples of 8 bits. The sample rate and the intermediate frequency are not in the file. Words
/// and floats are scaled so that the first samples have a root mean square of 24 steps in I and in Q.
class IfFile {
public:
    /// Skips the first `start` samples. Throws Error(Input) if `path` cannot be read, is empty, ends within a sample or before
    /// `start`, or if the samples from there on are inconsistent with `format`: constant, no numbers, I and Q of different power,
    /// a constant above the noise, bytes of the other sign, saturated or uniformly distributed.
    explicit IfFile(const std::filesystem::path& path, std::string_view format = "ibyte", std::uintmax_t start = 0);

    [[nodiscard]] std::uintmax_t size() const { return size_; }  ///< complex samples from `start` on
    /// Fills `out` with the next samples; false, and `out` unspecified, if fewer remain.
    [[nodiscard]] bool read(std::span<std::complex<std::int8_t>> out);

private:
    std::vector<std::complex<float>> head();

    std::filesystem::path path_;
    IfEncoding encoding_;
    std::ifstream file_;
    std::vector<char> raw_;
    std::uintmax_t size_ = 0;
    float scale_ = 1.0F;  ///< steps per unit, for words and floats
};

}  // namespace schuler::io
