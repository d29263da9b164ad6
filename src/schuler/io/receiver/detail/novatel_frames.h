// Framing of NovAtel logs, ASCII and binary [NovAtelOEM7]. Private to the readers.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/time.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/text/number.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace schuler::io::detail {

/// NovAtel CRC-32: reversed polynomial 0xEDB88320, initial value zero (or the sum of the preceding bytes), no final inversion.
[[nodiscard]] std::uint32_t novatel_crc(std::string_view bytes, std::uint32_t crc = 0);

/// One log with a correct checksum.
struct NovatelMessage {
    std::string_view name;                ///< of an ASCII log, without the letter of its form: "RANGE"; empty for a binary one
    int id = 0;                           ///< of a binary log, or of an ASCII log of raw measurements; 0 if unknown
    std::int64_t ns = 0;                  ///< GPS time of its header; 0 if the receiver had none
    bool secondary = false;               ///< from the second antenna
    std::string_view payload;             ///< of a binary log
    std::vector<std::string_view> cells;  ///< of an ASCII log
};

struct NovatelScan {
    std::size_t damaged = 0, first_damaged = 0;  ///< logs with a wrong checksum, and the byte offset of the first
};

/// Passes every log to `take`, until that returns false.
NovatelScan scan_novatel(std::string_view bytes, const std::function<bool(const NovatelMessage&)>& take);

/// The more compressed raw measurements (RANGECMP2, 4 and 5) are not read.
void tell_compressed(const std::string& file, std::size_t count, WarningLog& warnings);
[[nodiscard]] bool is_compressed(const NovatelMessage& m);

/// GPS time from week and seconds; 0 if invalid.
[[nodiscard]] std::int64_t novatel_time(double week, double seconds);

/// The fields of a log in order, binary or ASCII.
class NovatelFields {
public:
    explicit NovatelFields(const NovatelMessage& m) : m_(m) {}

    /// The next field of this type; NaN (0 for integers) if there is none.
    template <class T>
    [[nodiscard]] T next() {
        if (m_.name.empty()) {
            const std::size_t at = at_;
            at_ += sizeof(T);
            if (at_ > m_.payload.size()) short_ = true;
            return load<T>(m_.payload, at);
        }
        const double v = number();
        if constexpr (std::is_floating_point_v<T>) return static_cast<T>(v);
        const bool fits =
            v >= static_cast<double>(std::numeric_limits<T>::lowest()) && v <= static_cast<double>(std::numeric_limits<T>::max());
        return fits ? static_cast<T>(v) : T{};
    }
    /// An integer written in base 16 in ASCII.
    [[nodiscard]] std::uint32_t hex();
    /// Raw bytes, in ASCII one cell with two digits of base 16 each; empty if there are fewer.
    [[nodiscard]] std::string bytes(std::size_t size);
    /// A Boolean of four bytes, TRUE or FALSE in ASCII.
    [[nodiscard]] bool flag();
    /// Skips bytes, or the corresponding number of ASCII cells.
    void skip(std::size_t bytes, std::size_t cells) {
        if (m_.name.empty()) at_ += bytes;
        else at_ += cells;
    }
    /// True if more data were requested than available.
    [[nodiscard]] bool is_short() const { return short_; }

private:
    double number() {
        if (at_ >= m_.cells.size()) {
            short_ = true;
            return std::numeric_limits<double>::quiet_NaN();
        }
        return number_from(m_.cells[at_++]);
    }
    const NovatelMessage& m_;
    std::size_t at_ = 0;
    bool short_ = false;
};

}  // namespace schuler::io::detail
