// What a child process may touch, decided before it starts and held by the kernel.
#pragma once

#include <filesystem>
#include <vector>

namespace schuler::serve {

struct Confinement {
    std::vector<std::filesystem::path> readable;  ///< beside the system's own folders and the program
    std::vector<std::filesystem::path> writable;
};

/// Whether this kernel can hold a process to such rules (Landlock).
[[nodiscard]] bool can_confine();

/// Prepared rules: making them allocates and opens files, taking them up does neither and may be done between fork and exec.
class Ruleset {
public:
    explicit Ruleset(const Confinement& confinement);
    ~Ruleset();
    Ruleset(const Ruleset&) = delete;
    Ruleset& operator=(const Ruleset&) = delete;

    /// Takes the rules up for the calling process; false where the kernel refuses. True where the kernel knows no such rules:
    /// names and settings have been checked before (serve/names.h), this is the second wall.
    [[nodiscard]] bool enter() const;

private:
    int fd_ = -1;
};

}  // namespace schuler::serve
