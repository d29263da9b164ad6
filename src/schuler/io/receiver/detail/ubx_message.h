// The frame of a u-blox message. Private to the readers.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace schuler::io::detail {

/// A little-endian number of a payload with checked length.
template <class Number>
[[nodiscard]] Number number_at(std::string_view payload, std::size_t at) {
    Number value;
    std::memcpy(&value, payload.data() + at, sizeof value);
    return value;
}

/// One message: class and id, payload.
struct UbxMessage {
    unsigned kind = 0;  ///< class * 256 + id
    std::string_view payload;
    std::size_t size = 0;  ///< of the whole message
};

enum class Scan { Message, Damaged, None };

/// The message at the start of the bytes, which begin with the two synchronisation characters.
inline Scan message_at(std::string_view bytes, UbxMessage& m) {
    if (bytes.size() < 8) return Scan::Damaged;
    const std::size_t length = number_at<std::uint16_t>(bytes, 4);
    if (bytes.size() < length + 8) return Scan::Damaged;
    unsigned a = 0, b = 0;
    for (std::size_t i = 2; i < length + 6; ++i) {
        a = (a + static_cast<unsigned char>(bytes[i])) & 0xFFU;
        b = (b + a) & 0xFFU;
    }
    if (a != static_cast<unsigned char>(bytes[length + 6]) || b != static_cast<unsigned char>(bytes[length + 7]))
        return Scan::Damaged;
    m.kind = static_cast<unsigned>(static_cast<unsigned char>(bytes[2])) << 8 | static_cast<unsigned char>(bytes[3]);
    m.payload = bytes.substr(6, length);
    m.size = length + 8;
    return Scan::Message;
}

}  // namespace schuler::io::detail
