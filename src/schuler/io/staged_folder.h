// The files of a result: they appear together in their folder, or not at all.
#pragma once

#include <filesystem>
#include <string>

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
    /// Moves every file, that of the name `last` after all others: where it is, the result is whole, also after a kill or a power cut
    /// (files and folder are synchronized). Before that the older one is removed, and those files of the older result that this one does
    /// not have, unless somebody has changed them. Nothing is moved if a file would overwrite one that is not Schuler's own
    /// (io/own_files.h). `last` empty: the files are no result of their own.
    /// @throws Error(Input) that names the file, or says that the disk is full; Error(Computation) if the system reports another error
    void publish(const std::string& last = "summary.json");

private:
    std::filesystem::path target_, stage_;
    bool target_is_new_ = false;
};

}  // namespace schuler::io
