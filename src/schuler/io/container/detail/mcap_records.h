// Kinds of MCAP records. Private to the readers and writers.
#pragma once

#include <cstdint>
#include <string_view>

namespace schuler::io::detail {

inline constexpr std::string_view mcap_magic("\x89MCAP0\r\n", 8);
enum McapOp : unsigned char { Header = 1, Footer = 2, Schema = 3, Channel = 4, Message = 5, Chunk = 6, DataEnd = 15 };

}  // namespace schuler::io::detail
