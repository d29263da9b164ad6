// Decompression of container blocks: zstd, LZ4 frames, bzip2.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace schuler::io {

/// True for the methods that are read, and "none".
[[nodiscard]] bool is_compression(std::string_view method);

/// Decompressed bytes. @param method "", "none", "zstd", "lz4" or "bz2"; @param size stated by the container, 0: unknown
/// @throws Error(Input) without a place, with the error: damaged, another method, more than 4 GB
[[nodiscard]] std::string decompressed(std::string_view bytes, std::string_view method, std::size_t size);

}  // namespace schuler::io
