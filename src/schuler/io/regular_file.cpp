#include "schuler/io/regular_file.h"

#include "schuler/io/place.h"

#include <fmt/format.h>

#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace schuler::io {
namespace {

enum class Problem { None, Missing, Unreadable, Directory, Special };

Problem problem_of(const std::filesystem::path& path, int& error_number) {
    struct stat about {};
    if (stat(path.c_str(), &about) != 0) {
        error_number = errno;
        return errno == ENOENT || errno == ENOTDIR ? Problem::Missing : Problem::Unreadable;
    }
    if (S_ISDIR(about.st_mode)) return Problem::Directory;
    if (!S_ISREG(about.st_mode)) return Problem::Special;
    struct statfs system {};
    const bool window = about.st_size == 0 && statfs(path.c_str(), &system) == 0 &&
                        (system.f_type == PROC_SUPER_MAGIC || system.f_type == SYSFS_MAGIC || system.f_type == DEBUGFS_MAGIC);
    return window ? Problem::Special : Problem::None;
}

}  // namespace

void check_regular_file(const std::filesystem::path& path) {
    int error_number = 0;
    const SourcePlace place = place_in(path.string());
    switch (problem_of(path, error_number)) {
        case Problem::None: return;
        case Problem::Missing:
            throw input_error("no such file", place, "check the path; relative paths start at the current folder");
        case Problem::Unreadable:
            throw input_error(fmt::format("cannot be opened: {}", std::generic_category().message(error_number)), place,
                              "check the permissions");
        case Problem::Directory: throw input_error("is a directory, not a file", place, "name the file inside it");
        case Problem::Special:
            throw input_error("is a pipe or a device, not a file on a disk", place, "copy what it delivers into a file first");
    }
}

bool is_regular_file(const std::filesystem::path& path) {
    int ignored = 0;
    return problem_of(path, ignored) == Problem::None;
}

}  // namespace schuler::io
