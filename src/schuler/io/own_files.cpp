#include "schuler/io/own_files.h"

#include "schuler/io/place.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

namespace schuler::io {
namespace {

namespace fs = std::filesystem;

/// Size and modification time, as in a line of the list.
struct Stamp {
    std::int64_t size = 0, changed_ns = 0;
    bool operator==(const Stamp&) const = default;
};

std::optional<Stamp> stamp_of(const fs::path& file) {
    struct stat s {};
    if (stat(file.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) return std::nullopt;
    return Stamp{s.st_size, s.st_mtim.tv_sec * std::int64_t{1'000'000'000} + s.st_mtim.tv_nsec};
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// One line per file, "SIZE TIME NAME"; the last line of a name is valid, so that several processes may append.
std::optional<Stamp> listed(const fs::path& file) {
    std::ifstream list(folder_of(file) / own_files_list);
    const std::string name = file.filename().string();
    std::optional<Stamp> found;
    Stamp stamp;
    for (std::string rest; list >> stamp.size >> stamp.changed_ns && list.get() == ' ' && std::getline(list, rest);)
        if (rest == name) found = stamp;
    return found;
}

}  // namespace

bool may_overwrite(const fs::path& file) {
    const std::optional<Stamp> now = stamp_of(file);
    return !now || now == listed(file);
}

void check_overwrite(const fs::path& file) {
    if (may_overwrite(file)) return;
    throw input_error("exists, and was not written by this program or has been changed since", place_in(file.string()),
                      "choose another place with -o, or --force to overwrite it");
}

void note_own_file(const fs::path& file) {
    const std::optional<Stamp> now = stamp_of(file);
    const std::string name = file.filename().string();
    if (!now || name.find('\n') != std::string::npos) return;
    const fs::path list = folder_of(file) / own_files_list;
    const int fd = open(list.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd < 0) return;
    const std::string line = fmt::format("{} {} {}\n", now->size, now->changed_ns, name);
    [[maybe_unused]] const ssize_t written = write(fd, line.data(), line.size());
    close(fd);
}

void allow_overwrite(const fs::path& path) {
    std::error_code ec;
    if (!fs::is_directory(path, ec)) return note_own_file(path);
    for (const fs::directory_entry& entry : fs::directory_iterator(path, ec))
        if (entry.is_regular_file(ec) && !may_overwrite(entry.path())) note_own_file(entry.path());
}

}  // namespace schuler::io
