#include "schuler/analysis/reference_point.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <iterator>

namespace schuler::analysis {
namespace {

using Eigen::Vector3d;

constexpr double longest_step = 2.0;  // s: turns of vehicles last a few seconds

Eigen::Quaterniond body_to_earth(const ReferenceSample& s) {
    return Eigen::Quaterniond(earth::C_en(s.position.lat, s.position.lon)) * math::quaternion_from_rpy(s.rpy);
}

/// Mean rate of the body relative to the Earth from one sample to the next, body axes; not given for those that are too far apart.
Vector3d mean_rate(const ReferenceSample& from, const ReferenceSample& to) {
    const double dt = (to.time - from.time).seconds();
    if (!(dt > 0.0 && dt <= longest_step)) return not_given3();
    return math::rotation_vector_from_quaternion(body_to_earth(from).conjugate() * body_to_earth(to)) / dt;
}

/// At the middle of three samples, to second order also where they are not equally spaced.
Vector3d rate_at(const ReferenceSample& before, const ReferenceSample& here, const ReferenceSample& after) {
    const double d0 = (here.time - before.time).seconds(), d1 = (after.time - here.time).seconds();
    return (d1 * mean_rate(before, here) + d0 * mean_rate(here, after)) / (d0 + d1);
}

}  // namespace

std::vector<ReferenceSample> reference_at(const earth::Earth& earth, std::span<const ReferenceSample> reference,
                                          const Vector3d& lever_arm_b) {
    std::vector<ReferenceSample> own;
    std::ranges::copy_if(reference, std::back_inserter(own), [](const ReferenceSample& s) { return s.rpy.allFinite(); });
    if (lever_arm_b.isZero(0.0)) return own;
    std::vector<ReferenceSample> out = own;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Eigen::Matrix3d C_nb = math::dcm_from_rpy(own[i].rpy);
        out[i].position = earth::moved_by_ned(earth, own[i].position, C_nb * lever_arm_b);
        const bool inside = i > 0 && i + 1 < own.size();
        const Vector3d rate = inside ? rate_at(own[i - 1], own[i], own[i + 1]) : not_given3();
        out[i].velocity_n += C_nb * rate.cross(lever_arm_b);
    }
    return out;
}

}  // namespace schuler::analysis
