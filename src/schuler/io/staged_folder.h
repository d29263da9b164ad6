// The files of a result: either all of them appear in their folder, or none.
#pragma once

#include <filesystem>
#include <vector>

namespace schuler::io {

/// A temporary folder beside the target in which files are created; publish() moves them there. Otherwise nothing remains.
class StagedFolder {
public:
    /// @throws Error(Input) if the folder cannot be created
    explicit StagedFolder(std::filesystem::path target);
    ~StagedFolder();
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;

    /// The temporary folder to write to.
    [[nodiscard]] const std::filesystem::path& path() const { return stage_; }
    /// Final path of a file of that name.
    [[nodiscard]] std::filesystem::path final_path(const std::filesystem::path& staged) const {
        return target_ / staged.filename();
    }
    /// Moves every file. Nothing is moved if one of them would overwrite a file that is not Schuler's own (io/own_files.h).
    /// @throws Error(Input) that names the file; Error(Computation) if the system reports an error
    void publish();

private:
    std::filesystem::path target_, stage_;
    bool target_is_new_ = false;
};

}  // namespace schuler::io
