#include "schuler/dataset/imu_log.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/dataset/paths.h"
#include "schuler/inspect/inspect.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::dataset {

namespace fs = std::filesystem;

void diagnose_imu_log(const fs::path& folder, const Description& description) {
    if (folder.empty() || description.imu.file.empty() || !description.imu.scale.empty()) return;
    const fs::path file = resolved(folder, description.imu.file, "imu.file");
    for (const inspect::FileReport& report : inspect::inspect(file.parent_path()).files) {  // including the fixes for comparison
        if (report.path != file.filename()) continue;
        for (const inspect::Problem& problem : report.problems)
            if (problem.level == inspect::Level::Error) throw input_error(problem.text, {file.string(), 0, 0, {}}, problem.hint);
    }
}

void check_gravity_shows(const std::vector<ImuSample>& imu, ImuKind kind, const fs::path& folder,
                         const Description& description) {
    if (imu.size() < 100) return;
    std::vector<double> norms, steps;
    const std::size_t stride = std::max<std::size_t>(1, imu.size() / 5000);
    for (std::size_t i = stride; i < imu.size(); i += stride) {
        const double step = (imu[i].time - imu[i - 1].time).seconds(), dt = kind == ImuKind::Rates ? 1.0 : step;
        if (!(step > 0.0) || !imu[i].accel.allFinite()) continue;
        norms.push_back(imu[i].accel.norm() / dt);
        steps.push_back(step);
    }
    const double size = math::median(std::move(norms));
    if (std::isnan(size) || (size > 0.6 * units::g0 && size < 1.7 * units::g0)) return;
    diagnose_imu_log(folder, description);
    const double step = math::median(std::move(steps)), as_other = kind == ImuKind::Rates ? size / step : size * step;
    constexpr double near = 0.1;
    if (std::abs(as_other / units::g0 - 1.0) < near) {
        const bool increments = kind == ImuKind::Rates;
        throw input_error(
            fmt::format("the accelerometers show {:.4g} m/s2 (median norm), gravity {} the sampling interval of {:.4g} s", size,
                        increments ? "times" : "over", step),
            {description.imu.file, 0, 0, "imu.kind"},
            increments ? "the log holds increments: imu.kind = \"increments\"" : "the log holds rates: imu.kind = \"rates\"");
    }
    throw input_error(fmt::format("the accelerometers show {:.4g} m/s2 (median norm), not gravity", size),
                      {description.imu.file, 0, 0, "imu.scale"},
                      "check the unit of these columns and [imu] scale; data without gravity cannot be used");
}

}  // namespace schuler::dataset
