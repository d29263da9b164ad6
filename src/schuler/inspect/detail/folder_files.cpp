#include "schuler/inspect/detail/folder_files.h"

#include "schuler/core/error.h"
#include "schuler/io/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <system_error>

namespace schuler::inspect::detail {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 200;

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with("."); }

std::vector<fs::path> folders_in(const fs::path& folder) {
    std::vector<fs::path> folders;
    std::error_code ec;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
        std::error_code odd;
        if (it->is_directory(odd) && !is_hidden(it->path())) folders.push_back(it->path());
    }
    std::ranges::sort(folders);
    return folders;
}

bool has_files(const fs::path& folder) {
    std::error_code ec;
    for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
        std::error_code odd;
        if (it->is_regular_file(odd) && !is_hidden(it->path())) return true;
    }
    return false;
}

/// A link to a file that is in the list too is the same log again.
void leave_out_links(std::vector<fs::path>& paths, Study& study) {
    std::error_code ec;
    std::set<fs::path> seen;
    for (const fs::path& path : paths)
        if (!fs::is_symlink(path, ec)) seen.insert(fs::canonical(path, ec));
    std::erase_if(paths, [&](const fs::path& path) {
        if (!fs::is_symlink(path, ec)) return false;
        const fs::path target = fs::canonical(path, ec);
        if (seen.insert(target).second) return false;
        study.problem(
            Level::Info,
            fmt::format("{} is a link to {}, which is there too: left out", path.filename().string(), target.filename().string()),
            "");
        return true;
    });
}

}  // namespace

std::vector<fs::path> files_in(const fs::path& folder, Study& study) {
    std::vector<fs::path> paths;
    std::error_code failure;
    for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
        std::error_code odd;
        if (is_hidden(it->path())) continue;
        if (it->is_regular_file(odd)) {
            paths.push_back(it->path());
        } else if (it->is_symlink(odd) && !it->exists(odd)) {
            study.problem(Level::Warning,
                          fmt::format("{} is a link to {}, which does not exist", it->path().filename().string(),
                                      fs::read_symlink(it->path(), odd).string()),
                          "copy the file itself into the folder");
        }
    }
    if (failure) {
        throw input_error(fmt::format("the folder cannot be listed ({})", failure.message()), {folder.string(), 0, 0, {}},
                          "check its permissions");
    }
    std::ranges::sort(paths);
    leave_out_links(paths, study);
    if (paths.size() > most_files) {
        study.problem(Level::Warning, fmt::format("{} files; only the first {} by name were looked at", paths.size(), most_files),
                      "give the folder of one recording");
        paths.resize(most_files);
    }
    return paths;
}

FilesBelow files_below(const fs::path& folder, Study& study) {
    FilesBelow found;
    std::vector<fs::path> folders;
    std::error_code ec;
    fs::path top = folder;
    for (int depth = 0; depth < 2; ++depth) {
        folders = folders_in(top);
        if (folders.size() != 1 || has_files(folders.front())) break;
        top = folders.front();
    }
    for (const fs::path& one : folders) {
        if (fs::exists(one / "config.toml", ec) || fs::exists(one / "run.h5", ec)) continue;
        if (io::format_of(one) != nullptr) {
            found.files.push_back(one);
            continue;
        }
        const std::vector<fs::path> inside = files_in(one, study), further = folders_in(one);
        found.files.insert(found.files.end(), inside.begin(), inside.end());
        found.folders.insert(found.folders.end(), further.begin(), further.end());
    }
    if (found.files.size() > most_files) found.files.resize(most_files);
    return found;
}

void tell_folders_further_down(const fs::path& top, const std::vector<fs::path>& folders, Level level, Study& study) {
    if (folders.empty()) return;
    constexpr std::size_t most = 5;
    std::string names;
    for (std::size_t i = 0; i < std::min(most, folders.size()); ++i)
        names += (i > 0 ? ", " : "") + folders[i].lexically_relative(top).generic_string();
    if (folders.size() > most) names += fmt::format(" and {} more", folders.size() - most);
    study.problem(level, fmt::format("folders further down are not looked through: {}", names),
                  "give the folder of the recording itself");
}

}  // namespace schuler::inspect::detail
