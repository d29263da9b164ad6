#include "schuler/io/if_file.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

namespace schuler::io {

IfFile::IfFile(const std::filesystem::path& path, std::string_view format) {
    if (format != "ibyte")
        throw input_error(fmt::format("unknown sample format '{}'", format), {.file = path.string()},
                          "give ibyte: signed bytes, I and Q in turn");
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    file_.open(path, std::ios::binary);
    if (failed || !file_) throw input_error("cannot be read", {.file = path.string()}, "give a recording of samples");
    if (bytes == 0) throw input_error("holds no samples", {.file = path.string()}, "give a recording of samples");
    if (bytes % 2 != 0)
        throw input_error(fmt::format("{} bytes end within a sample", bytes), {.file = path.string()},
                          "give pairs of I and Q; a file cut short loses its last byte, real samples have to be made complex");
    size_ = bytes / 2;
}

bool IfFile::read(std::span<std::complex<std::int8_t>> out) {
    const auto bytes = static_cast<std::streamsize>(2 * out.size());
    return static_cast<bool>(file_.read(reinterpret_cast<char*>(out.data()), bytes));
}

}  // namespace schuler::io
