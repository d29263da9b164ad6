// Numbers in binary files, least significant byte first. Private to the readers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace schuler::io::detail {

static_assert(std::endian::native == std::endian::little, "binary logs are read as they lie in memory");

/// The number at a position known to be inside the buffer.
template <class T>
[[nodiscard]] inline T load(const char* at) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

/// The same; zero if it would extend beyond the end.
template <class T>
[[nodiscard]] inline T load(std::string_view bytes, std::size_t at) {
    return at <= bytes.size() && bytes.size() - at >= sizeof(T) ? load<T>(bytes.data() + at) : T{};
}

template <class T>
inline void store(std::string& out, T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
}

}  // namespace schuler::io::detail
