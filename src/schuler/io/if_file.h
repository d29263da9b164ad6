// Recordings of an intermediate frequency: signed bytes, I and Q in turn.
#pragma once

#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

namespace schuler::io {

/// What gnss-sdr and common recorders call "ibyte": one signed byte of I, one of Q, no header. The sample rate and the
/// intermediate frequency are not in the file.
class IfFile {
public:
    /// Throws Error(Input) when `path` cannot be read, is empty or ends within a sample, or `format` is not "ibyte".
    explicit IfFile(const std::filesystem::path& path, std::string_view format = "ibyte");

    [[nodiscard]] std::uintmax_t size() const { return size_; }  ///< complex samples
    /// Fills `out` with the next samples; false, and `out` unspecified, when fewer are left.
    [[nodiscard]] bool read(std::span<std::complex<std::int8_t>> out);

private:
    std::ifstream file_;
    std::uintmax_t size_ = 0;
};

}  // namespace schuler::io
