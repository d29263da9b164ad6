// Framing of messages. Private to the room.
#pragma once

#include "schuler/live/decoder.h"

#include <string>
#include <string_view>

namespace schuler::live::detail {

inline constexpr std::size_t longest_message = 1 << 16;  ///< bytes; anything longer is invalid

/// Calls `line(text)` for each complete line, without its line end. A line that is too long is `bad`.
class Lines {
public:
    template <class Line, class Bad>
    void take(std::string_view bytes, Line line, Bad bad) {
        waiting_ += bytes;
        std::size_t from = 0;
        for (std::size_t end = 0; (end = waiting_.find('\n', from)) != std::string::npos; from = end + 1) {
            std::string_view text(waiting_.data() + from, end - from);
            if (text.ends_with('\r')) text.remove_suffix(1);
            if (!text.empty()) line(text);
        }
        waiting_.erase(0, from);
        if (waiting_.size() <= longest_message) return;
        bad();
        waiting_.clear();
    }
    void reset() { waiting_.clear(); }

private:
    std::string waiting_;
};

[[nodiscard]] std::unique_ptr<Decoder> json_decoder();
[[nodiscard]] std::unique_ptr<Decoder> gpsd_decoder();

}  // namespace schuler::live::detail
