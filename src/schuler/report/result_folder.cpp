#include "schuler/report/result_folder.h"

#include "schuler/report/outputs.h"

namespace schuler::report {

ResultFolder::ResultFolder(Outcome& out, const std::filesystem::path& folder) : out_(out), stage_(folder) { out.folder = folder; }

std::filesystem::path ResultFolder::add(const std::string& name) {
    std::filesystem::path staged = stage_.path() / name;
    out_.files.push_back(stage_.final_path(staged));
    return staged;
}

void ResultFolder::write(const std::string& name, const std::string& text) { write_text(add(name), text); }

void ResultFolder::add_written(const std::vector<std::filesystem::path>& staged) {
    for (const std::filesystem::path& file : staged) out_.files.push_back(stage_.final_path(file));
}

}  // namespace schuler::report
