#include "schuler/report/published.h"

#include "schuler/core/units.h"
#include "schuler/settings/scenario/published.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::report {

settings::BlockRms rms_of(const std::vector<solution::StateErrors>& states, Time settled) {
    settings::BlockRms out;
    for (std::size_t b = 0; b < settings::published_blocks; ++b) {
        Eigen::Vector3d square = Eigen::Vector3d::Zero();
        double n = 0.0;
        for (const solution::StateErrors& s : states) {
            if (s.time < settled || !s.error[b].allFinite()) continue;
            square += s.error[b].cwiseAbs2();
            n += 1.0;
        }
        out[b] = (square / n).cwiseSqrt();
    }
    return out;
}

std::string published_table(const settings::Published& published, const settings::BlockRms& ours, const std::string& heading) {
    if (published.source.empty()) return {};
    struct Row {
        const char* name;
        double unit;
        const char* axes;
    };
    static constexpr std::array<Row, settings::published_blocks> rows{{{"position, m", 1.0, "east, north, up"},
                                                                       {"velocity, m/s", 1.0, "east, north, up"},
                                                                       {"attitude, rad", 1.0, "about east, north, up"},
                                                                       {"gyro bias, rad/s", 1.0, "x, y, z"},
                                                                       {"accelerometer bias, ug", units::ug, "x, y, z"}}};
    std::string out = fmt::format("{:<26}{:<36}{:<36}\n", "root mean square", heading, published.source);
    const auto cells = [](const Eigen::Vector3d& v, double unit) {
        std::string text;
        for (const double x : v)
            text += std::isfinite(x) ? fmt::format("{:<11}", fmt::format("{:.4g}", x / unit)) : "-          ";
        return text;
    };
    for (std::size_t b = 0; b < settings::published_blocks; ++b)
        out += fmt::format("  {:<24}{:<36}{:<36}{}\n", rows[b].name, cells(ours[b], rows[b].unit),
                           cells(published.rms[b], rows[b].unit), rows[b].axes);
    return out;
}

}  // namespace schuler::report
