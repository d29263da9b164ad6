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

/// CRC-32 of NovAtel: reversed polynomial 0xEDB88320, from zero (or the sum of what stands before), without the final inversion.
[[nodiscard]] std::uint32_t novatel_crc(std::string_view bytes, std::uint32_t crc = 0);

/// One log whose check sum is right.
struct NovatelMessage {
    std::string_view name;                ///< of an ASCII log, without the letter of its form: "RANGE"; empty of a binary one
    int id = 0;                           ///< of a binary log, or of an ASCII log of raw measurements; 0 where it is not known
    std::int64_t ns = 0;                  ///< GPS time of its header; 0 where the receiver had none
    bool secondary = false;               ///< of the second antenna
    std::string_view payload;             ///< of a binary log
    std::vector<std::string_view> cells;  ///< of an ASCII log
};

struct NovatelScan {
    std::size_t damaged = 0, first_damaged = 0;  ///< logs with a wrong check sum, and the byte of the first
};

/// Gives every log in turn to `take`, until it says false.
NovatelScan scan_novatel(std::string_view bytes, const std::function<bool(const NovatelMessage&)>& take);

/// Compressed raw measurements (RANGECMP and its kin) are not read.
void tell_compressed(const std::string& file, std::size_t count, WarningLog& warnings);
[[nodiscard]] bool is_compressed(const NovatelMessage& m);

/// GPS time of week and seconds; 0 where they are none.
[[nodiscard]] std::int64_t novatel_time(double week, double seconds);

/// The fields of a log in their order, binary or ASCII.
class NovatelFields {
public:
    explicit NovatelFields(const NovatelMessage& m) : m_(m) {}

    /// The next field of this type; NaN (0 of whole numbers) where there is none.
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
    /// A whole number that ASCII writes in base 16.
    [[nodiscard]] std::uint32_t hex();
    /// A truth value of four bytes, TRUE or FALSE in ASCII.
    [[nodiscard]] bool flag();
    /// Passes over bytes, which ASCII writes as so many cells.
    void skip(std::size_t bytes, std::size_t cells) {
        if (m_.name.empty()) at_ += bytes;
        else at_ += cells;
    }
    /// Whether more was asked for than there is.
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
