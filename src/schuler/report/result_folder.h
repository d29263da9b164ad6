// The files of a study's result, which appear together (io/staged_folder.h).
#pragma once

#include "schuler/io/staged_folder.h"
#include "schuler/report/outcome.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::report {

class ResultFolder {
public:
    /// `out`: its folder is set, and each file is added to its files under the final name. @throws Error(Input)
    ResultFolder(Outcome& out, const std::filesystem::path& folder);

    /// A file that is written otherwise: where to write it.
    [[nodiscard]] std::filesystem::path add(const std::string& name);
    void write(const std::string& name, const std::string& text);
    [[nodiscard]] const std::filesystem::path& path() const { return stage_.path(); }
    /// Adds what was written to path() by somebody else.
    void add_written(const std::vector<std::filesystem::path>& staged);
    /// All of them, that of the name `last` after the others.
    void publish(const std::string& last = "summary.json") { stage_.publish(last); }

private:
    Outcome& out_;
    io::StagedFolder stage_;
};

}  // namespace schuler::report
