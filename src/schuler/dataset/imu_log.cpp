#include "schuler/dataset/imu_log.h"

#include "schuler/core/error.h"
#include "schuler/dataset/paths.h"
#include "schuler/inspect/inspect.h"

namespace schuler::dataset {

namespace fs = std::filesystem;

void blame_the_imu_log(const fs::path& folder, const Description& description) {
    if (folder.empty() || description.imu.file.empty() || !description.imu.scale.empty()) return;
    const fs::path file = resolved(folder, description.imu.file, "imu.file");
    for (const inspect::FileReport& report : inspect::inspect(file.parent_path()).files) {   // with the fixes to compare with
        if (report.path != file.filename()) continue;
        for (const inspect::Problem& problem : report.problems)
            if (problem.level == inspect::Level::Error) throw input_error(problem.text, {file.string(), 0, 0, {}}, problem.mend);
    }
}

}  // namespace schuler::dataset
