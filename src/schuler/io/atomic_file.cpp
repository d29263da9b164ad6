#include "schuler/io/atomic_file.h"

#include "schuler/io/own_files.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

namespace schuler::io {
namespace {

Error cannot_write(const std::filesystem::path& path, int error_number) {
    const std::string hint =
        error_number == ENOENT ? "make the folder first, or choose another with -o" : "choose another place with -o";
    return input_error(fmt::format("cannot be written: {}", system_message(error_number)), place_in(path.string()), hint);
}

/// Nothing is wrong with the computation: the same command goes through where there is room.
Error full(const std::filesystem::path& path, int error_number) {
    return input_error(fmt::format("cannot be written: {}", system_message(error_number)), place_in(path.string()),
                       "make room on the disk");
}

}  // namespace

std::filesystem::path create_beside(const std::filesystem::path& path) {
    static std::atomic<unsigned> counter{0};
    for (int attempt = 0; attempt < 1000; ++attempt) {
        const std::string name = fmt::format(".{}.{}-{}.part", path.filename().string(), getpid(), counter++);
        std::filesystem::path beside = path.parent_path() / name;
        const int fd = open(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (fd >= 0) {
            close(fd);
            return beside;
        }
        if (errno != EEXIST) throw cannot_write(path, errno);
    }
    throw cannot_write(path, EEXIST);
}

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
    struct stat status {};
    const bool exists = stat(path_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) throw cannot_write(path_, EISDIR);
    check_overwrite(path_);
    if (exists && !S_ISREG(status.st_mode)) {
        fd_ = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        temporary_ = create_beside(path_);
        fd_ = open(temporary_.c_str(), O_WRONLY | O_CLOEXEC);
    }
    if (fd_ < 0) {
        const int reason = errno;
        if (!temporary_.empty()) unlink(temporary_.c_str());
        throw cannot_write(path_, reason);
    }
}

AtomicFile::~AtomicFile() {
    if (fd_ >= 0) close(fd_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
        if (n < 0) {
            if (errno == EINTR) continue;
            throw full(path_, errno);
        }
        bytes.remove_prefix(static_cast<std::size_t>(n));
    }
}

void AtomicFile::commit() {
    const int closed = fd_ >= 0 ? close(fd_) : 0;
    fd_ = -1;
    if (closed != 0) throw full(path_, errno);
    if (temporary_.empty()) return;
    if (rename(temporary_.c_str(), path_.c_str()) != 0) {
        throw input_error(fmt::format("cannot be renamed to its name: {}", system_message(errno)), place_in(path_.string()),
                          "choose another place with -o");
    }
    temporary_.clear();
    note_own_file(path_);
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace schuler::io
