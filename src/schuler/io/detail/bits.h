// Bit fields of binary messages, most significant bit first, and their checks. Private to the readers.
#pragma once

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
        for (std::size_t i = first; i < first + count; ++i) {
            const std::size_t byte = i / 8;
            const auto b = byte < bytes_.size() ? static_cast<unsigned char>(bytes_[byte]) : 0U;
            value = value << 1 | ((b >> (7 - i % 8)) & 1U);
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
        for (std::size_t i = count; i-- > 0; ++size_) {
            if (size_ % 8 == 0) bytes_.push_back('\0');
            if ((value >> i & 1U) != 0) bytes_.back() = static_cast<char>(bytes_.back() | (0x80 >> size_ % 8));
        }
    }
    /// Bits [first, first + count) of another buffer.
    void put(const Bits& from, std::size_t first, std::size_t count) {
        for (std::size_t i = first; i < first + count; ++i) put(from.at(i, 1), 1);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::size_t size_ = 0;
};

/// CRC-24Q of whole bytes [RTCM10403:4.2].
[[nodiscard]] inline std::uint32_t crc24q(std::string_view bytes) {
    std::uint32_t crc = 0;
    for (const char c : bytes) {
        crc ^= static_cast<std::uint32_t>(static_cast<unsigned char>(c)) << 16;
        for (int i = 0; i < 8; ++i) crc = (crc & 0x800000U) != 0 ? (crc << 1 ^ 0x1864CFBU) & 0xFFFFFFU : crc << 1;
    }
    return crc;
}

}  // namespace schuler::io::detail
