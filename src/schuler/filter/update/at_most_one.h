// An optional value whose memory is kept, for objects that come and go in a run without allocation.
#pragma once

#include <memory>
#include <utility>

namespace schuler::filter {

/// Copies are deep and allocate only if there is a value. T may be incomplete until it is used.
template <class T>
class AtMostOne {
public:
    AtMostOne() = default;
    AtMostOne(const AtMostOne& other) { *this = other; }
    AtMostOne(AtMostOne&& other) noexcept : room_(std::move(other.room_)), used_(std::exchange(other.used_, false)) {}
    AtMostOne& operator=(const AtMostOne& other) {
        if (this == &other) return *this;
        if (other.used_) room() = *other.room_;
        used_ = other.used_;
        return *this;
    }
    AtMostOne& operator=(AtMostOne&& other) noexcept {
        room_ = std::move(other.room_);
        used_ = std::exchange(other.used_, false);
        return *this;
    }
    ~AtMostOne() = default;

    [[nodiscard]] bool empty() const { return !used_; }
    [[nodiscard]] T& front() { return *room_; }
    [[nodiscard]] const T& front() const { return *room_; }
    void clear() { used_ = false; }

    /// Memory for a value, allocated if necessary; the value becomes valid with `use`.
    [[nodiscard]] T& room() {
        if (!room_) room_ = std::make_unique<T>();
        return *room_;
    }
    void use() { used_ = true; }

private:
    std::unique_ptr<T> room_;
    bool used_ = false;
};

}  // namespace schuler::filter
