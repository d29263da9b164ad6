#include "schuler/io/bytes.h"

#include "schuler/io/place.h"
#include "schuler/io/regular_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace schuler::io {
namespace {

struct CloseGz {
    void operator()(gzFile file) const { gzclose(file); }
};

/// Reads to the end or until there are more than `limit` bytes.
std::string read_until(const TextInput& input, std::size_t limit) {
    if (input.in_memory()) return std::string(input.content());
    check_regular_file(input.name());
    std::error_code ec;
    const std::unique_ptr<gzFile_s, CloseGz> file(gzopen(input.name().c_str(), "rb"));
    if (!file) throw input_error("cannot be opened", place_in(input.name()), "check the permissions");
    const std::size_t chunk = std::min<std::size_t>(limit, 1024 * 1024) + 1;
    gzbuffer(file.get(), 256 * 1024);
    std::string bytes;
    const std::uintmax_t on_disk = std::filesystem::file_size(input.name(), ec);
    if (!ec) bytes.reserve(std::min<std::uintmax_t>(on_disk, limit) + chunk);
    for (;;) {
        const std::size_t before = bytes.size();
        bytes.resize(before + chunk);
        const int n = gzread(file.get(), bytes.data() + before, static_cast<unsigned>(chunk));
        int status = Z_OK;
        const char* text = gzerror(file.get(), &status);
        if (n < 0 || status == Z_BUF_ERROR || status == Z_DATA_ERROR)
            throw input_error(
                fmt::format("cannot be read, or the compressed file is damaged or cut ({})", text != nullptr ? text : ""),
                place_in(input.name()), "copy or compress it again");
        bytes.resize(before + static_cast<std::size_t>(n));
        if (n == 0 || bytes.size() > limit) return bytes;
    }
}

}  // namespace

std::string read_bytes(const TextInput& input, std::size_t limit) {
    std::string bytes = read_until(input, limit);
    if (bytes.size() > limit)
        throw input_error(fmt::format("is larger than {} bytes", limit), place_in(input.name()), "is it the right file?");
    return bytes;
}

std::string read_head(const TextInput& input, std::size_t count) {
    std::string bytes = read_until(input, count);
    bytes.resize(std::min(bytes.size(), count));
    return bytes;
}

}  // namespace schuler::io
