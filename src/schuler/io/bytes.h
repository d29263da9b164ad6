// Whole files in memory: binary logs and text formats that require random access.
#pragma once

#include "schuler/io/text/text_input.h"

#include <cstddef>
#include <string>
#include <string_view>

namespace schuler::io {

/// The whole input, decompressed if gz-compressed.
/// @throws Error(Input): no such file, a directory, not readable, damaged or truncated compression, more than `limit` bytes.
[[nodiscard]] std::string read_bytes(const TextInput& input, std::size_t limit = std::size_t{4} << 30);

/// The first `count` bytes of the input, or as many as there are, decompressed: to recognise a format without a full read.
/// @throws as read_bytes does
[[nodiscard]] std::string read_head(const TextInput& input, std::size_t count);

/// Lines of a text in memory, without their ends (LF, CR LF); the last one may lack an end.
class Lines {
public:
    explicit Lines(std::string_view text) : rest_(text) {}
    [[nodiscard]] bool next() {
        if (rest_.empty()) return false;
        const std::size_t stop = rest_.find('\n');
        line_ = rest_.substr(0, stop);
        rest_.remove_prefix(stop == std::string_view::npos ? rest_.size() : stop + 1);
        if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
        ++number_;
        return true;
    }
    [[nodiscard]] std::string_view line() const { return line_; }
    [[nodiscard]] long number() const { return number_; }  ///< starting at 1
    /// First byte of the next line; zero at the end.
    [[nodiscard]] char peek() const { return rest_.empty() ? '\0' : rest_.front(); }

private:
    std::string_view rest_, line_;
    long number_ = 0;
};

/// Columns [from, from + count) of a line, as far as they exist.
[[nodiscard]] inline std::string_view columns_of(std::string_view line, std::size_t from, std::size_t count) {
    return from >= line.size() ? std::string_view{} : line.substr(from, count);
}

}  // namespace schuler::io
