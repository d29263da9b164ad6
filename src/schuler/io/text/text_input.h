// Text files as blocks of whole lines: plain or gz-compressed files, or a buffer in memory. Memory use is bounded.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

/// Input to be read: a file by its path, or content already in memory with a name for messages.
class TextInput {
public:
    TextInput(const std::filesystem::path& path) : name_(path.string()) {}  // NOLINT: implicit, a path is an input
    TextInput(const std::string& path) : name_(path) {}                     // NOLINT
    TextInput(const char* path) : name_(path) {}                            // NOLINT
    /// The content must outlive the input.
    [[nodiscard]] static TextInput memory(std::string_view content, std::string display_name);

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool in_memory() const { return in_memory_; }
    [[nodiscard]] std::string_view content() const { return content_; }

private:
    std::string name_;
    std::string_view content_;
    bool in_memory_ = false;
};

/// True for text that begins with the byte order mark of UTF-16, either order.
[[nodiscard]] bool is_utf16(std::string_view bytes);
/// Such text as UTF-8, without the mark; a half of a pair of surrogates becomes what it may.
[[nodiscard]] std::string utf8_of_utf16(std::string_view bytes);
/// True for bytes that gzip compressed.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// Delivers the input in blocks of whole lines, each terminated by '\n' (preceding carriage returns are kept; files with carriage
/// returns only are converted). At least `padding` readable bytes follow each block, so that scanners may look ahead without
/// checking. A byte order mark is skipped; files of UTF-16 are converted.
class LineBlocks {
public:
    static constexpr std::size_t padding = 64;

    /// Throws Error(Input): no such file, a directory, not readable.
    explicit LineBlocks(const TextInput& input, std::size_t block_size = 256 * 1024);
    ~LineBlocks();
    LineBlocks(const LineBlocks&) = delete;
    LineBlocks& operator=(const LineBlocks&) = delete;

    /// Moves on to the next block; false at the end of the input. Throws Error(Input) on binary content (zero bytes), a
    /// line over 16 MB, a damaged or truncated gz file, a read error.
    [[nodiscard]] bool next();
    [[nodiscard]] const char* begin() const { return buffer_.data(); }
    [[nodiscard]] const char* end() const { return buffer_.data() + size_; }
    /// For in-place changes (decimal commas).
    [[nodiscard]] char* data() { return buffer_.data(); }
    /// Number of the first line of the block, from 1.
    [[nodiscard]] long first_line() const { return first_line_; }
    /// True if this is the last block and the file does not end with a line end (one has been appended here).
    [[nodiscard]] bool ended_without_newline() const { return ended_without_newline_; }
    /// Size of the file on disk or in memory; 0 if unknown (pipes).
    [[nodiscard]] std::size_t size_on_disk() const;
    [[nodiscard]] bool compressed() const;

private:
    struct Source;
    void fill();
    void check_text();
    void skip_byte_order_mark();

    std::string name_;
    std::unique_ptr<Source> source_;
    std::vector<char> buffer_;
    std::size_t block_size_;
    std::size_t size_ = 0;    ///< bytes of the current block
    std::size_t filled_ = 0;  ///< bytes in the buffer, including the start of the next block
    long first_line_ = 1;
    bool started_ = false;
    bool at_end_ = false;
    bool cr_only_ = false;
    bool ended_without_newline_ = false;
};

/// The whole input as one string (small files: settings), decompressed, without byte order mark.
/// Throws Error(Input) as LineBlocks does, or if it is larger than `limit` bytes.
[[nodiscard]] std::string read_text(const TextInput& input, std::size_t limit = 64 * 1024 * 1024);

}  // namespace schuler::io
