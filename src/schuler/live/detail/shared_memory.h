// The writer of shared_state.h. Private to the room.
#pragma once

#include "schuler/core/nav_state.h"

#include <memory>
#include <string>

struct schuler_shared_state;

namespace schuler::live::detail {

class SharedMemory {
public:
    SharedMemory() = default;
    ~SharedMemory();
    SharedMemory(SharedMemory&& other) noexcept;
    SharedMemory& operator=(SharedMemory&&) = delete;

    /// Creates the object, or takes over one that a run of this kind has left. Empty on success, else the reason.
    [[nodiscard]] std::string open(const std::string& name);
    [[nodiscard]] bool is_open() const { return state_ != nullptr; }
    void store(const SolutionRow& row);

private:
    std::string name_;
    int lock_ = -1;
    schuler_shared_state* state_ = nullptr;
};

}  // namespace schuler::live::detail
