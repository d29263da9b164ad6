// The files of a result: all of them appear in their folder, or none.
#pragma once

#include <filesystem>
#include <vector>

namespace schuler::io {

/// A folder beside the wanted one in which files are made; publish() moves them to their place. Without it nothing is left behind.
class StagedFolder {
public:
    /// @throws Error(Input) where the folder cannot be made
    explicit StagedFolder(std::filesystem::path target);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    /// Where to write meanwhile.
    [[nodiscard]] const std::filesystem::path& path() const { return stage_; }
    /// Where a file of that name will be.
    [[nodiscard]] std::filesystem::path final_path(const std::filesystem::path& staged) const {
        return target_ / staged.filename();
    }
    /// Moves every file. Nothing is moved where one of them would overwrite a file that is not Schuler's own (io/own_files.h).
    /// @throws Error(Input) naming that file; Error(Computation) where the system refuses
    void publish();

private:
    std::filesystem::path target_, stage_;
    bool target_is_new_ = false;
};

}  // namespace schuler::io
