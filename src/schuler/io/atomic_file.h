// A file that appears under its name only when complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace schuler::io {

/// Name of a new, empty file beside `path`, created for this process. Throws Error(Input) if the folder does not exist or cannot
/// be written.
[[nodiscard]] std::filesystem::path create_beside(const std::filesystem::path& path);

/// Writes to a temporary name in the same folder, and renames on commit(). Without commit() no file remains.
/// A target that exists and is not a regular file (a pipe, /dev/stdout) is written directly.
class AtomicFile {
public:
    /// Throws Error(Input): no such folder, no permission, a directory of that name, a file that is not Schuler's own (io/own_files.h).
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Throws Error(Input) if the disk is full or fails.
    void write(std::string_view bytes);
    /// Closes the file and renames it. Throws as write() does.
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
