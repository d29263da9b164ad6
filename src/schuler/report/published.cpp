#include "schuler/report/published.h"

#include "schuler/core/units.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/scenario/published.h"

#include <fmt/format.h>

#include <array>

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
    struct Block {
        const char* name;
        const char* unit;
        double per_unit;
        std::array<const char*, 3> axes;
    };
    static constexpr std::array<const char*, 3> enu{"east", "north", "up"}, about_enu{"about east", "about north", "about up"},
        body{"x", "y", "z"};
    static constexpr std::array<Block, settings::published_blocks> blocks{{{"position", "m", 1.0, enu},
                                                                           {"velocity", "m/s", 1.0, enu},
                                                                           {"attitude", "rad", 1.0, about_enu},
                                                                           {"gyro bias", "rad/s", 1.0, body},
                                                                           {"accelerometer bias", "ug", units::ug, body}}};
    ResultTable table = table_for_people({}, {"root mean square", heading, published.source});
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (int i = 0; i < 3; ++i)
            table.rows.push_back(
                {fmt::format("{} {}, {}", blocks[b].name, blocks[b].axes[static_cast<std::size_t>(i)], blocks[b].unit),
                 ours[b](i) / blocks[b].per_unit, published.rms[b](i) / blocks[b].per_unit});
    return table_text(table);
}

}  // namespace schuler::report
