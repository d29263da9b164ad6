// Bit fields of binary messages, most significant bit first, and their checks. Private to the readers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace schuler::io::detail {

/// Reads bits from a buffer; beyond its end they are zero, and ok() is false from then on.
class Bits {
public:
    explicit Bits(std::string_view bytes) : bytes_(bytes) {}

    [[nodiscard]] std::uint64_t at(std::size_t first, std::size_t count) const {
        std::uint64_t value = 0;
        for (std::size_t i = first, left = count; left > 0;) {  // byte by byte: single bits took a third of the time of a log
            const std::size_t in_byte = i % 8, some = std::min(left, 8 - in_byte);
            const auto b = i / 8 < bytes_.size() ? static_cast<unsigned char>(bytes_[i / 8]) : 0U;
            value = value << some | (b >> (8 - in_byte - some) & ((1U << some) - 1U));
            i += some;
            left -= some;
        }
        return value;
    }
    /// The next `count` bits, up to 64.
    [[nodiscard]] std::uint64_t take(std::size_t count) {
        const std::uint64_t value = at(position_, count);
        position_ += count;
        return value;
    }
    [[nodiscard]] int integer(std::size_t count) { return static_cast<int>(take(count)); }
    /// Two's complement.
    [[nodiscard]] std::int64_t take_signed(std::size_t count) {
        const std::uint64_t value = take(count);
        const bool negative = count > 0 && (value >> (count - 1) & 1U) != 0;
        return negative ? static_cast<std::int64_t>(value) - (std::int64_t{1} << count) : static_cast<std::int64_t>(value);
    }
    /// Sign and magnitude, as used by GLONASS.
    [[nodiscard]] std::int64_t take_sign_magnitude(std::size_t count) {
        const bool negative = take(1) != 0;
        const auto magnitude = static_cast<std::int64_t>(take(count - 1));
        return negative ? -magnitude : magnitude;
    }
    void skip(std::size_t count) { position_ += count; }
    void seek(std::size_t position) { position_ = position; }
    [[nodiscard]] std::size_t position() const { return position_; }
    [[nodiscard]] bool ok() const { return position_ <= 8 * bytes_.size(); }

private:
    std::string_view bytes_;
    std::size_t position_ = 0;
};

/// Assembles bits into bytes; the last byte is padded with zeros.
class BitWriter {
public:
    /// The lowest `count` bits of a value.
    void put(std::uint64_t value, std::size_t count) {
        while (count > 0) {
            if (size_ % 8 == 0) bytes_.push_back('\0');
            const std::size_t room = 8 - size_ % 8, some = std::min(count, room);
            const auto part = static_cast<unsigned>(value >> (count - some)) & ((1U << some) - 1U);
            bytes_.back() = static_cast<char>(static_cast<unsigned char>(bytes_.back()) | part << (room - some));
            size_ += some;
            count -= some;
        }
    }
    /// Bits [first, first + count) of another buffer.
    void put(const Bits& from, std::size_t first, std::size_t count) {
        for (std::size_t i = first, some = 0; i < first + count; i += some) {
            some = std::min<std::size_t>(first + count - i, 64);
            put(from.at(i, some), some);
        }
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::size_t size_ = 0;
};

/// CRC-24Q of whole bytes [RTCM10403:4.2].
[[nodiscard]] inline std::uint32_t crc24q(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t byte = 0; byte < 256; ++byte) {
            std::uint32_t crc = byte << 16;
            for (int i = 0; i < 8; ++i) crc = (crc & 0x800000U) != 0 ? (crc << 1 ^ 0x1864CFBU) & 0xFFFFFFU : crc << 1;
            t[byte] = crc;
        }
        return t;
    }();
    std::uint32_t crc = 0;
    for (const char c : bytes) crc = (crc << 8 & 0xFFFFFFU) ^ table[crc >> 16 ^ static_cast<unsigned char>(c)];
    return crc;
}

}  // namespace schuler::io::detail
