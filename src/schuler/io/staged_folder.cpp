#include "schuler/io/staged_folder.h"

#include "schuler/io/own_files.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <unistd.h>

#include <atomic>
#include <system_error>
#include <utility>

namespace schuler::io {

namespace fs = std::filesystem;

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

void StagedFolder::publish() {
    std::vector<fs::path> files;
    std::error_code ec;
    for (const fs::directory_entry& entry : fs::directory_iterator(stage_, ec))
        if (entry.path().filename() != own_files_list) files.push_back(entry.path());
    for (const fs::path& file : files) check_overwrite(final_path(file));
    for (const fs::path& file : files) {
        fs::rename(file, final_path(file), ec);
        if (ec == std::errc::cross_device_link)
            fs::copy_file(file, final_path(file), fs::copy_options::overwrite_existing, ec);  // if moving is not permitted
        if (ec)
            throw computation_error(fmt::format("{}: cannot be moved to its place: {}", final_path(file).string(), ec.message()),
                                    "choose another folder with -o");
        note_own_file(final_path(file));
    }
    fs::remove_all(std::exchange(stage_, {}), ec);
}

}  // namespace schuler::io
