#include "schuler/io/staged_folder.h"

#include "schuler/io/own_files.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

namespace schuler::io {

namespace fs = std::filesystem;

namespace {

/// What was written is on the disk. A file system that cannot do so is not asked again, a full or broken disk is an error.
void synchronize(const fs::path& path, const fs::path& final_place) {
    const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    const int failure = fsync(fd) != 0 ? errno : 0;
    close(fd);
    if (failure == ENOSPC || failure == EDQUOT || failure == EIO || failure == EFBIG)
        throw input_error(fmt::format("cannot be written: {}", system_message(failure)), place_in(final_place.string()),
                          "make room on the disk");
}

}  // namespace

StagedFolder::StagedFolder(fs::path target) : target_(std::move(target)) {
    static std::atomic<unsigned> counter{0};
    std::error_code ec;
    target_is_new_ = !fs::exists(target_, ec);
    fs::create_directories(target_, ec);
    if (ec)
        throw input_error(fmt::format("the folder cannot be made: {}", ec.message()), place_in(target_.string()),
                          "give another one with -o");
    // Inside the folder: the same file system and the same permissions.
    stage_ = target_ / fmt::format(".{}-{}.part", getpid(), counter++);
    fs::create_directory(stage_, ec);
    if (ec)
        throw input_error(fmt::format("cannot be written: {}", ec.message()), place_in(target_.string()),
                          "choose another folder with -o");
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    if (!stage_.empty()) fs::remove_all(stage_, ignored);
    if (!stage_.empty() && target_is_new_) fs::remove(target_, ignored);  // only if it is empty
}

void StagedFolder::publish(const std::string& last) {
    std::vector<fs::path> files;
    std::set<std::string> names;
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(stage_, ec)) {
        if (entry.path().filename() == own_files_list) continue;
        files.push_back(entry.path());
        names.insert(entry.path().filename().string());
    }
    for (const fs::path& file : files) check_overwrite(final_path(file));
    for (const fs::path& file : files) synchronize(file, final_path(file));
    if (!last.empty()) {
        const std::set<std::string> before = files_of_result(target_, last);
        note_result(target_, last, names, false);
        const auto remove_own = [&](const std::string& name) {
            const fs::path file = target_ / name;  // no folder and no link that somebody has put in its place
            if (fs::symlink_status(file, ec).type() == fs::file_type::regular && may_overwrite(file)) fs::remove(file, ec);
        };
        remove_own(last);
        synchronize(target_, target_);
        for (const std::string& name : before)
            if (!names.contains(name)) remove_own(name);
        // renamed last, after all others are on the disk
        std::ranges::stable_partition(files, [&](const fs::path& file) { return file.filename() != last; });
    }
    for (const fs::path& file : files) {
        if (!last.empty() && file.filename() == last) synchronize(target_, target_);
        note_own_file(final_path(file), file);
        fs::rename(file, final_path(file), ec);
        if (ec == std::errc::cross_device_link) {  // if moving is not permitted
            fs::copy_file(file, final_path(file), fs::copy_options::overwrite_existing, ec);
            note_own_file(final_path(file));
        }
        if (ec)
            throw computation_error(fmt::format("{}: cannot be moved to its place: {}", final_path(file).string(), ec.message()),
                                    "choose another folder with -o");
    }
    if (!last.empty()) note_result(target_, last, names, true);
    synchronize(target_, target_);
    fs::remove_all(std::exchange(stage_, {}), ec);
}

}  // namespace schuler::io
