// Packing of numbers and texts into bytes and unpacking: for checkpoints, and messages between processes of one machine type.
#pragma once

#include "schuler/core/error.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace schuler {

class Packer {
public:
    template <class T>
        requires std::is_arithmetic_v<T>
    void put(T x) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof(T));
        std::memcpy(bytes_.data() + at, &x, sizeof(T));
    }
    void put(std::string_view text) {
        put(static_cast<std::uint64_t>(text.size()));
        bytes_ += text;
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

/// Reads what a Packer wrote, in the same order. @throws Error(Input) if the data end too early.
class Unpacker {
public:
    explicit Unpacker(std::string_view bytes) : rest_(bytes) {}
    template <class T>
        requires std::is_arithmetic_v<T>
    [[nodiscard]] T get() {
        const std::string_view part = bytes(sizeof(T));
        T out;
        std::memcpy(&out, part.data(), sizeof(T));
        return out;
    }
    [[nodiscard]] std::string text() { return std::string(bytes(count(1))); }
    /// Reads a count of items of at least `each` bytes each. @throws Error(Input) if the bytes left cannot hold them.
    [[nodiscard]] std::size_t count(std::size_t each) {
        const auto n = get<std::uint64_t>();
        if (n > rest_.size() / each) throw too_short();
        return static_cast<std::size_t>(n);
    }
    [[nodiscard]] bool at_end() const { return rest_.empty(); }

private:
    [[nodiscard]] std::string_view bytes(std::size_t n) {
        if (n > rest_.size()) throw too_short();
        const std::string_view out = rest_.substr(0, n);
        rest_.remove_prefix(n);
        return out;
    }
    static Error too_short() { return input_error("is damaged: it ends too early"); }

    std::string_view rest_;
};

}  // namespace schuler
