#include "schuler/io/text/text_input.h"

#include "schuler/io/place.h"
#include "schuler/io/regular_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <system_error>

namespace schuler::io {
namespace {

constexpr std::size_t longest_line = 16 * 1024 * 1024;

}  // namespace

TextInput TextInput::memory(std::string_view content, std::string display_name) {
    TextInput input(display_name);
    input.content_ = content;
    input.in_memory_ = true;
    return input;
}

std::string utf8_of_utf16(std::string_view bytes) {
    std::string text;
    if (bytes.size() < 2) return text;
    const bool big_endian = static_cast<unsigned char>(bytes[0]) == 0xfe;
    const auto unit = [&](std::size_t i) {
        const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
        return static_cast<std::uint32_t>(big_endian ? first << 8U | second : second << 8U | first);
    };
    const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    const auto continued = [&](std::uint32_t code, unsigned shift) { put(0x80U | (code >> shift & 0x3fU)); };
    for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
        std::uint32_t code = unit(i);
        if (code >= 0xd800U && code < 0xdc00U && i + 3 < bytes.size()) {  // a pair of surrogates
            code = 0x10000U + ((code - 0xd800U) << 10U) + ((unit(i + 2) - 0xdc00U) & 0x3ffU);
            i += 2;
        }
        if (code < 0x80U) {
            put(code);
        } else if (code < 0x800U) {
            put(0xc0U | code >> 6U);
            continued(code, 0);
        } else if (code < 0x10000U) {
            put(0xe0U | code >> 12U);
            continued(code, 6);
            continued(code, 0);
        } else {
            put(0xf0U | code >> 18U);
            continued(code, 12);
            continued(code, 6);
            continued(code, 0);
        }
    }
    return text;
}

bool is_utf16(std::string_view bytes) { return bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"); }

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

/// Source of the bytes.
struct LineBlocks::Source {
    std::string name;
    int fd = -1;
    gzFile gz = nullptr;
    std::string_view memory;
    std::size_t size = 0;
    std::string converted;  // of UTF-16; `memory` is a view of it

    explicit Source(const TextInput& input) : name(input.name()) {
        if (input.in_memory()) {
            memory = input.content();
            size = memory.size();
            return;
        }
        open_file();
    }
    ~Source() {
        if (gz != nullptr) gzclose(gz);
        if (fd >= 0) close(fd);
    }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    void open_file() {
        check_regular_file(name);
        fd = open(name.c_str(), O_RDONLY | O_CLOEXEC);
        if (fd < 0) {
            throw input_error(fmt::format("cannot be opened: {}", system_message(errno)), place_in(name),
                              "check the permissions");
        }
        struct stat status {};
        if (fstat(fd, &status) == 0) size = static_cast<std::size_t>(status.st_size);
        char magic[2] = {0, 0};
        const bool has_magic = size >= 2 && pread(fd, magic, 2, 0) == 2;
        if (has_magic && is_utf16({magic, 2})) convert_utf16();
        if (has_magic && is_gzip({magic, 2})) {
            gz = gzdopen(fd, "rb");
            if (gz == nullptr) throw computation_error(fmt::format("{}: no memory to decompress", name));
            fd = -1;  // closed by gzclose
            gzbuffer(gz, 256 * 1024);
        }
    }

    /// The whole file as UTF-8, in memory.
    void convert_utf16() {
        constexpr std::size_t largest = std::size_t{1} << 30U;
        if (size > largest)
            throw input_error("is UTF-16 text of more than a gigabyte", place_in(name, 1), "save it as UTF-8 or plain text");
        std::string bytes(size, '\0');
        std::size_t filled = 0;
        for (std::size_t n = 1; n > 0 && filled < size; filled += n) n = read_some(bytes.data() + filled, size - filled);
        bytes.resize(filled);
        close(fd);
        fd = -1;
        converted = utf8_of_utf16(bytes);
        memory = converted;
    }

    /// Up to `count` bytes; 0 at the end.
    std::size_t read_some(char* into, std::size_t count) {
        if (gz != nullptr) return read_gz(into, count);
        if (fd < 0) {
            const std::size_t n = std::min(count, memory.size());
            if (n > 0) std::memcpy(into, memory.data(), n);
            memory.remove_prefix(n);
            return n;
        }
        for (;;) {
            const ssize_t n = ::read(fd, into, count);
            if (n >= 0) return static_cast<std::size_t>(n);
            if (errno != EINTR)
                throw input_error(fmt::format("cannot be read: {}", system_message(errno)), place_in(name), "check the disk");
        }
    }

    std::size_t read_gz(char* into, std::size_t count) {
        const int n = gzread(gz, into, static_cast<unsigned>(count));
        int status = Z_OK;
        const char* text = gzerror(gz, &status);
        if (n < 0 || status == Z_BUF_ERROR || status == Z_DATA_ERROR) {
            throw input_error(fmt::format("the compressed file is damaged or cut ({})", text != nullptr ? text : "unknown"),
                              place_in(name), "copy or compress it again");
        }
        return static_cast<std::size_t>(n);
    }
};

LineBlocks::LineBlocks(const TextInput& input, std::size_t block_size)
    : name_(input.name()), source_(std::make_unique<Source>(input)), block_size_(std::max<std::size_t>(block_size, 16)) {
    if (input.in_memory()) block_size_ = std::clamp<std::size_t>(input.content().size() + 1, 16, block_size_);
    buffer_.resize(block_size_ + padding + 1);
}

LineBlocks::~LineBlocks() = default;

std::size_t LineBlocks::size_on_disk() const { return source_->size; }
bool LineBlocks::compressed() const { return source_->gz != nullptr; }

/// Fills the buffer from filled_ on, until it is full or the input ends.
void LineBlocks::fill() {
    const std::size_t capacity = buffer_.size() - padding - 1;
    while (!at_end_ && filled_ < capacity) {
        const std::size_t n = source_->read_some(buffer_.data() + filled_, capacity - filled_);
        if (n == 0) at_end_ = true;
        if (cr_only_) std::replace(buffer_.data() + filled_, buffer_.data() + filled_ + n, '\r', '\n');
        filled_ += n;
    }
}

void LineBlocks::skip_byte_order_mark() {
    const auto* bytes = reinterpret_cast<const unsigned char*>(buffer_.data());
    if (filled_ >= 2 && ((bytes[0] == 0xff && bytes[1] == 0xfe) || (bytes[0] == 0xfe && bytes[1] == 0xff))) {
        throw input_error("is UTF-16 text", place_in(name_, 1), "save it as UTF-8 or plain text");
    }
    if (filled_ >= 3 && bytes[0] == 0xef && bytes[1] == 0xbb && bytes[2] == 0xbf) {
        std::memmove(buffer_.data(), buffer_.data() + 3, filled_ - 3);
        filled_ -= 3;
    }
    const char* stop = buffer_.data() + filled_;
    if (std::find(buffer_.data(), buffer_.data() + filled_, '\n') == stop &&
        std::find(buffer_.data(), buffer_.data() + filled_, '\r') != stop) {
        cr_only_ = true;
        std::replace(buffer_.data(), buffer_.data() + filled_, '\r', '\n');
    }
}

/// A zero byte indicates a binary file, or a log whose end was not written.
void LineBlocks::check_text() {
    const void* zero = std::memchr(buffer_.data(), 0, size_);
    if (zero == nullptr) return;
    const char* at = static_cast<const char*>(zero);
    const long line = first_line_ + static_cast<long>(std::count(begin(), at, '\n'));
    if (line <= 2)
        throw input_error("is a binary file, not text", place_in(name_, line), "choose the text log, or convert it first");
    throw input_error("zero bytes in a text file", place_in(name_, line),
                      fmt::format("the log was probably cut there: delete line {} and what follows", line));
}

bool LineBlocks::next() {
    if (size_ > 0) {
        first_line_ += static_cast<long>(std::count(begin(), end(), '\n'));
        std::memmove(buffer_.data(), buffer_.data() + size_, filled_ - size_);
        filled_ -= size_;
        size_ = 0;
    }
    if (ended_without_newline_) return false;
    fill();
    if (!started_) {
        started_ = true;
        skip_byte_order_mark();
    }
    for (;;) {
        const void* last = filled_ > 0 ? memrchr(buffer_.data(), '\n', filled_) : nullptr;
        if (last != nullptr) {
            size_ = static_cast<std::size_t>(static_cast<const char*>(last) - buffer_.data()) + 1;
            break;
        }
        if (at_end_) {
            if (filled_ == 0) return false;
            buffer_[filled_++] = '\n';
            size_ = filled_;
            ended_without_newline_ = true;
            break;
        }
        if (filled_ >= longest_line) {
            throw input_error(fmt::format("a line of more than {} MB", longest_line / 1024 / 1024), place_in(name_, first_line_),
                              "is it a text file?");
        }
        buffer_.resize(2 * (buffer_.size() - padding - 1) + padding + 1);
        fill();
    }
    check_text();
    return true;
}

std::string read_text(const TextInput& input, std::size_t limit) {
    LineBlocks blocks(input);
    std::string text;
    while (blocks.next()) {
        text.append(blocks.begin(), blocks.end());
        if (blocks.ended_without_newline()) text.pop_back();
        if (text.size() > limit)
            throw input_error(fmt::format("is larger than {} bytes", limit), place_in(input.name()), "is it the right file?");
    }
    return text;
}

}  // namespace schuler::io
