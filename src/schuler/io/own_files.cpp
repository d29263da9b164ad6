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

/// One line per file, "SIZE TIME NAME". Several processes may append, and one that is killed between the line of a file and the file
/// itself leaves the line: each of a name is as good as the last.
template <class Use>
void for_each_line(const fs::path& folder, Use use) {
    std::ifstream list(folder / own_files_list);
    Stamp stamp;
    for (std::string rest; list >> stamp.size >> stamp.changed_ns && list.get() == ' ' && std::getline(list, rest);)
        use(stamp, rest);
}

bool is_listed(const fs::path& file, const Stamp& now) {
    const std::string name = file.filename().string();
    bool found = false;
    for_each_line(folder_of(file),
                  [&](const Stamp& stamp, const std::string& rest) { found = found || (rest == name && stamp == now); });
    return found;
}

void append(const fs::path& folder, const std::string& lines) {
    const fs::path list = folder / own_files_list;
    const int fd = open(list.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (fd < 0) return;
    [[maybe_unused]] const ssize_t written = write(fd, lines.data(), lines.size());
    close(fd);
}

/// Lines of results have no size: "-1 KIND LAST/NAME". No file has such a name.
constexpr std::int64_t of_result = -1;
enum : std::int64_t { begins_anew, holds_file };

}  // namespace

bool may_overwrite(const fs::path& file) {
    const std::optional<Stamp> now = stamp_of(file);
    return !now || is_listed(file, *now);
}

void check_overwrite(const fs::path& file) {
    if (may_overwrite(file)) return;
    throw input_error("exists, and was not written by this program or has been changed since", place_in(file.string()),
                      "choose another place with -o, or --force to overwrite it");
}

void note_own_file(const fs::path& file) { note_own_file(file, file); }

void note_own_file(const fs::path& final_place, const fs::path& file) {
    const std::optional<Stamp> now = stamp_of(file);
    const std::string name = final_place.filename().string();
    if (!now || name.find('\n') != std::string::npos) return;
    append(folder_of(final_place), fmt::format("{} {} {}\n", now->size, now->changed_ns, name));
}

std::set<std::string> files_of_result(const fs::path& folder, const std::string& last) {
    std::set<std::string> names;
    for_each_line(folder, [&](const Stamp& stamp, const std::string& rest) {
        if (stamp.size != of_result || !rest.starts_with(last + "/")) return;
        if (stamp.changed_ns == begins_anew) names.clear();
        else names.insert(rest.substr(last.size() + 1));
    });
    return names;
}

void note_result(const fs::path& folder, const std::string& last, const std::set<std::string>& names, bool only) {
    std::string lines = only ? fmt::format("{} {} {}/\n", of_result, std::int64_t{begins_anew}, last) : "";
    for (const std::string& name : names)
        if (name.find('\n') == std::string::npos)
            lines += fmt::format("{} {} {}/{}\n", of_result, std::int64_t{holds_file}, last, name);
    append(folder, lines);
}

void allow_overwrite(const fs::path& path) {
    std::error_code ec;
    if (!fs::is_directory(path, ec)) return note_own_file(path);
    for (const fs::directory_entry& entry : fs::directory_iterator(path, ec))
        if (entry.is_regular_file(ec) && !may_overwrite(entry.path())) note_own_file(entry.path());
}

}  // namespace schuler::io
