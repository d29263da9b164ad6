#include "schuler/solution/course.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace schuler::solution {
namespace {

constexpr double slowest = 1.0;                 // m/s: below it wind and current move a ship in any direction
constexpr double current = 0.5;                 // m/s, one sigma of the water's motion across the course
constexpr double helm = 4.0 * units::deg;       // one sigma of the bow's swing about the course within a chord
constexpr double contrary = 30.0 * units::deg;  // between a chord and the velocity at its end: one of them is wrong

bool is_usable(const GnssFix& f) {
    return f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon);
}

/// Whether the velocity of a fix, if it has one, points along a course.
bool agrees(const GnssFix& fix, double course) {
    const Eigen::Vector2d v = fix.velocity_n.head<2>();
    if (!v.allFinite() || v.norm() < slowest) return true;
    return std::abs(math::wrap_pi(std::atan2(v.y(), v.x()) - course)) < contrary;
}

}  // namespace

void use_course(LoadedDataset& data) {
    const settings::Config& c = data.config;
    fusion::HeadingSettings& heading = data.config.filter.heading;
    if (c.filter.vehicle != fusion::VehicleKind::Ship || !(c.leeway > 0.0) || !heading.use || !data.recording.heading.empty())
        return;
    const std::vector<GnssFix>& fixes = data.recording.gnss;
    std::vector<HeadingSample> courses;
    std::vector<double> speeds;
    std::size_t first = 0;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
        const GnssFix &from = fixes[first], &to = fixes[i];
        const double span = (to.time - from.time).seconds();
        if (!is_usable(from)) first = i;
        if (!is_usable(from) || !is_usable(to) || span < fusion::course_chord) continue;
        first = i;
        if (span > fusion::longest_chord) continue;
        const Eigen::Vector2d moved = earth::ned_difference(c.filter.earth, to.position, from.position).head<2>();
        const double course = std::atan2(moved.y(), moved.x());
        if (moved.norm() < slowest * span || !agrees(to, course)) continue;
        const double stated = to.std_position.head<2>().norm(), given = c.filter.gnss.default_std_position.head<2>().norm();
        const double noise = (std::isfinite(stated) && stated > 0.0 ? stated : given) / moved.norm();
        const Duration age = Duration::from_seconds(c.filter.gnss.latency);
        courses.push_back({from.time + Duration::from_seconds(0.5 * span) - age, course, std::hypot(helm, noise)});
        speeds.push_back(moved.norm() / span);
    }
    if (courses.empty()) return;
    data.recording.heading = std::move(courses);
    heading.by_course = true;
    heading.offset_std = std::hypot(c.leeway, std::atan(current / math::median(std::move(speeds))));
}

}  // namespace schuler::solution
