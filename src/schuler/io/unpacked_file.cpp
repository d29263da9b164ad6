#include "schuler/io/unpacked_file.h"

#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace schuler::io {
namespace {

bool is_compressed(const std::string& file) {
    std::array<char, 2> magic{};
    std::ifstream in(file, std::ios::binary);
    return in.read(magic.data(), magic.size()) && is_gzip({magic.data(), magic.size()});
}

bool write_all(int fd, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd, bytes.data(), bytes.size());
        if (n <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
}

}  // namespace

UnpackedFile::UnpackedFile(const TextInput& input) : path_(input.name()) {
    if (!is_compressed(path_)) return;
    const std::string bytes = read_bytes(input);
    std::error_code ec;
    const std::string unique(6, 'X');  // mkstemp() replaces it
    std::string name = (std::filesystem::temp_directory_path(ec) / ("schuler_unpacked_" + unique)).string();
    const int fd = ec ? -1 : mkstemp(name.data());
    if (fd < 0)
        throw input_error("has to be unpacked first: the temporary folder cannot be written", place_in(path_),
                          "unpack it, or set TMPDIR");
    const bool complete = write_all(fd, bytes);
    close(fd);
    if (!complete) {
        std::filesystem::remove(name, ec);
        throw input_error("has to be unpacked first: the temporary folder is full", place_in(path_), "unpack it, or set TMPDIR");
    }
    path_ = name;
    temporary_ = true;
}

UnpackedFile::~UnpackedFile() {
    std::error_code ec;
    if (temporary_) std::filesystem::remove(path_, ec);
}

}  // namespace schuler::io
