#include "schuler/solution/course.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/settings/config/config.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>

namespace schuler::solution {

void use_course(LoadedDataset& data) {
    const settings::Config& c = data.config;
    fusion::HeadingSettings& heading = data.config.filter.heading;
    if (c.filter.vehicle != fusion::VehicleKind::Ship || !(c.leeway > 0.0) || !data.recording.heading.empty()) return;
    constexpr double slowest = 1.0;                // m/s: below, wind and current push a ship in any direction
    constexpr double helm = 4.0 * units::deg;      // by which the bow swings about the course within a chord
    constexpr double longest = 1.5;                // chords
    const std::vector<GnssFix>& fixes = data.recording.gnss;
    std::size_t first = 0;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
        const GnssFix &from = fixes[first], &to = fixes[i];
        const auto usable = [](const GnssFix& f) {
            return f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon);
        };
        const double span = (to.time - from.time).seconds();
        if (!usable(from)) first = i;
        if (!usable(from) || !usable(to) || span < fusion::course_chord) continue;
        first = i;
        if (span > longest * fusion::course_chord) continue;
        const Eigen::Vector2d moved = earth::ned_difference(c.filter.earth, to.position, from.position).head<2>();
        if (moved.norm() < slowest * span) continue;
        const double stated = to.std_position.head<2>().norm(), given = c.filter.gnss.default_std_position.head<2>().norm();
        const double noise = (std::isfinite(stated) && stated > 0.0 ? stated : given) / moved.norm();
        const Duration age = Duration::from_seconds(c.filter.gnss.latency);
        data.recording.heading.push_back({from.time + Duration::from_seconds(0.5 * span) - age,
                                          std::atan2(moved.y(), moved.x()), std::hypot(helm, noise)});
    }
    if (data.recording.heading.empty()) return;
    heading.by_course = true;
    heading.offset_std = c.leeway;
}

}  // namespace schuler::solution
