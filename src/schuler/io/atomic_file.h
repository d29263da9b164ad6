// A file that appears under its name only when it is complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace schuler::io {

/// Name of a new, empty file beside `path`, created for this process. Throws Error(Input) where the folder does not exist
/// or cannot be written.
[[nodiscard]] std::filesystem::path create_beside(const std::filesystem::path& path);

/// Writes beside the wanted name, in the same folder, and renames on commit(). Without commit() nothing is left behind.
/// A target that exists and is no regular file (a pipe, /dev/stdout) is written directly.
class AtomicFile {
public:
    /// Throws Error(Input): no such folder, no permission, a directory of that name, a file that is not Schuler's own (io/own_files.h).
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Throws Error(Computation) where the disk is full or fails.
    void write(std::string_view bytes);
    /// Closes and gives the file its name. Throws as write() does.
    void commit();
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    std::filesystem::path temporary_;  ///< empty: written directly
    int fd_ = -1;
};

/// Writes a whole file at once.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace schuler::io
