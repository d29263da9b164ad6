// Access rights of a child process, defined before it starts and enforced by the kernel.
#pragma once

#include <filesystem>
#include <vector>

namespace schuler::serve {

struct Confinement {
    std::vector<std::filesystem::path> readable;  ///< in addition to the system's own folders and the program
    std::vector<std::filesystem::path> writable;
};

/// True if this kernel can enforce such rules (Landlock).
[[nodiscard]] bool can_confine();

/// Prepared rules: their creation allocates and opens files; applying them does neither and may be done between fork and exec.
class Ruleset {
public:
    explicit Ruleset(const Confinement& confinement);
    ~Ruleset();
    Ruleset(const Ruleset&) = delete;
    Ruleset& operator=(const Ruleset&) = delete;

    /// Applies the rules to the calling process; false if the kernel rejects them. True if the kernel does not support such
    /// rules: names and settings have already been checked (serve/names.h), this is the second barrier.
    [[nodiscard]] bool enter() const;

private:
    int fd_ = -1;
};

}  // namespace schuler::serve
