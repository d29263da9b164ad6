#include "serve/confine.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t reading = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t writing = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                                  LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                                  LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                                  LANDLOCK_ACCESS_FS_MAKE_SYM;
/// Moving files between folders; kernels with the first version do not have this right and reject the move.
constexpr std::uint64_t moving = std::uint64_t{1} << 13;  // LANDLOCK_ACCESS_FS_REFER
constexpr std::uint64_t of_files = LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE;

void allow(int rules, const fs::path& path, std::uint64_t access) {
    const int fd = open(path.c_str(), O_PATH | O_CLOEXEC);
    if (fd < 0) return;
    struct stat about {};
    if (fstat(fd, &about) == 0) {
        landlock_path_beneath_attr rule{};
        rule.allowed_access = S_ISDIR(about.st_mode) ? access : access & of_files;
        rule.parent_fd = fd;
        syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    }
    close(fd);
}

long version_of_kernel() { return syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION); }

}  // namespace

bool can_confine() { return version_of_kernel() >= 1; }

Ruleset::Ruleset(const Confinement& confinement) {
    if (!can_confine()) return;
    landlock_ruleset_attr attributes{};
    const std::uint64_t changing = version_of_kernel() >= 2 ? writing | moving : writing;
    attributes.handled_access_fs = reading | changing;
    fd_ = static_cast<int>(syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0));
    if (fd_ < 0) return;
    for (const char* folder :
         {"/usr", "/bin", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/proc", "/sys/devices/system"})
        allow(fd_, folder, reading);
    allow(fd_, "/dev", reading | LANDLOCK_ACCESS_FS_WRITE_FILE);
    for (const fs::path& path : confinement.readable) allow(fd_, path, reading);
    for (const fs::path& path : confinement.writable) allow(fd_, path, reading | changing);
}

Ruleset::~Ruleset() {
    if (fd_ >= 0) close(fd_);
}

bool Ruleset::enter() const {
    if (fd_ < 0) return true;
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && syscall(SYS_landlock_restrict_self, fd_, 0) == 0;
}

}  // namespace schuler::serve
