// The files of a folder that are looked at.
#pragma once

#include "schuler/inspect/detail/study.h"

#include <filesystem>
#include <vector>

namespace schuler::inspect::detail {

/// Regular files by name, without hidden ones and without links to others of them; what is left out is reported.
/// @throws Error(Input) if the folder cannot be listed
[[nodiscard]] std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, Study& study);

struct FilesBelow {
    std::vector<std::filesystem::path> files;
    std::vector<std::filesystem::path> folders;  ///< further down, which are not looked through
};

/// Files one folder deeper, except in result folders of runs; a folder that contains only one folder is replaced by that.
[[nodiscard]] FilesBelow files_below(const std::filesystem::path& folder, Study& study);

void tell_folders_further_down(const std::filesystem::path& top, const std::vector<std::filesystem::path>& folders, Level level,
                               Study& study);

}  // namespace schuler::inspect::detail
