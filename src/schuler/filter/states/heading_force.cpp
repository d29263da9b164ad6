#include "schuler/filter/states/heading_force.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double bound = 2.0;  ///< one sigma of the horizontal velocity
/// m/s: fixes keep the velocity better than that; where it has been opened, the accelerations that tell it anew must not be withheld.
constexpr double most = 0.5;
/// rad, sigmas of the heading: below the first the products of two errors have no weight in hours, from the second on they have.
constexpr double known = 0.035, unknown = 0.1;

}  // namespace

double heading_unknown(double variance) {
    return std::clamp((variance - known * known) / (unknown * unknown - known * known), 0.0, 1.0);
}

void Withheld::correct(const Vector3d& horizontal) {
    change = withheld_part(change + horizontal, limit);
    covered = change.norm();
    noise = 0.0;
}

HeadingForce heading_force(const Vector3d& change, const Withheld& before, const Vector3d& down, const Matrix3d& velocity,
                           double heading_variance) {
    HeadingForce out;
    out.down = down;
    const double velocity_variance =
        std::max(0.0, velocity.trace() - down.dot(velocity * down) - before.noise);  // the noise must not raise its own bound
    Withheld& w = out.withheld;
    w.limit = std::min(most, bound * std::sqrt(velocity_variance)) * heading_unknown(heading_variance);
    // A limit that has become smaller brings up nothing of the past: that would not be an acceleration of now.
    w.change = withheld_part(horizontal_part(before.change, down), w.limit);
    w.covered = std::min(before.covered, w.limit);
    w.noise = before.noise;
    const Vector3d sum = w.change + horizontal_part(change, down);
    w.change = withheld_part(sum, w.limit);
    out.effective = sum - w.change;
    if (const double size = w.change.norm(); size > w.covered) {
        const Vector3d across = down.cross(w.change) / size;
        const double more = std::min(1.0, heading_variance) * (size * size - w.covered * w.covered);
        out.velocity_noise = more * across * across.transpose();
        w.noise += more;
        w.covered = size;
    }
    return out;
}

}  // namespace schuler::filter
