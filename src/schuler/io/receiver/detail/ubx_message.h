// The frame of a u-blox message. Private to the readers.
#pragma once

#include "schuler/core/log.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
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

enum class Scan {
    Message,
    Damaged,
    Cut,  ///< the bytes end before the message does, if its length is true
};

/// The message at the start of the bytes, which begin with the two synchronisation characters.
inline Scan message_at(std::string_view bytes, UbxMessage& m) {
    if (bytes.size() < 8) return Scan::Cut;
    const std::size_t length = number_at<std::uint16_t>(bytes, 4);
    if (bytes.size() < length + 8) return Scan::Cut;
    std::uint32_t a = 0, b = 0;  // sums modulo 256, which divides the 2^32 of their overflow
    for (const char c : bytes.substr(2, length + 4)) {
        a += static_cast<unsigned char>(c);
        b += a;
    }
    if ((a & 0xFFU) != static_cast<unsigned char>(bytes[length + 6]) ||
        (b & 0xFFU) != static_cast<unsigned char>(bytes[length + 7]))
        return Scan::Damaged;
    m.kind = static_cast<unsigned>(static_cast<unsigned char>(bytes[2])) << 8 | static_cast<unsigned char>(bytes[3]);
    m.payload = bytes.substr(6, length);
    m.size = length + 8;
    return Scan::Message;
}

/// Messages that cannot be used, and whether the log ends within one.
class UbxDamage {
public:
    void bad(std::size_t offset) {
        if (cut_) ++behind_cut_;  // the rest of a message looks like the start of one
        else if (count_++ == 0) first_ = offset;
    }
    /// The log ends within this message, unless another follows: then its length is damaged.
    void cut(std::size_t offset) {
        if (cut_) ++behind_cut_;
        else cut_ = offset;
    }
    void message() {
        if (!cut_) return;
        if (count_ == 0) first_ = *cut_;
        count_ += 1 + behind_cut_;
        behind_cut_ = 0;
        cut_.reset();
    }
    [[nodiscard]] std::size_t count() const { return count_ + (cut_ ? 1 : 0); }
    [[nodiscard]] std::size_t first() const { return count_ > 0 ? first_ : cut_.value_or(0); }

    void tell(const std::string& file, WarningLog& log) const {
        if (count_ > 0)
            log.add(file + " ubx.bad", fmt::format("{}: damaged UBX messages: skipped, the first at byte {}", file, first_),
                    count_);
        if (cut_)
            log.add(file + " ubx.cut",
                    fmt::format("{}: is cut in its last message, at byte {}: that is left out; copy the log completely", file,
                                *cut_));
    }

private:
    std::size_t count_ = 0, first_ = 0, behind_cut_ = 0;
    std::optional<std::size_t> cut_;
};

}  // namespace schuler::io::detail
