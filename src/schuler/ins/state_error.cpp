#include "schuler/ins/state_error.h"

#include "schuler/math/rotation.h"

#include <cmath>
#include <numbers>

namespace schuler::ins {

using Eigen::Quaterniond;
using Eigen::Vector3d;

NavState corrected(const earth::Earth& earth, const NavState& estimate, const Vector9& dx) {
    NavState s = estimate;
    s.position = earth::moved_by_ned(earth, estimate.position, -dx.head<3>());
    s.v_eb_n -= dx.segment<3>(3);
    s.q_nb = (math::quaternion_from_rotation_vector(dx.tail<3>()) * estimate.q_nb).normalized();
    return s;
}

NavState perturbed(const earth::Earth& earth, const NavState& truth, const Vector9& dx) {
    NavState s = truth;
    // The radii are those of the unknown estimate: a fixed-point iteration that converges by a factor |dr| tan(lat)/R per pass.
    Geodetic p = earth::moved_by_ned(earth, truth.position, dx.head<3>());
    for (int pass = 0; pass < 20; ++pass) {
        const Geodetic back = earth::moved_by_ned(earth, p, -dx.head<3>());
        const double dlat = truth.position.lat - back.lat;
        const double dlon = math::wrap_pi(truth.position.lon - back.lon);
        const double dh = truth.position.h - back.h;
        p = {p.lat + dlat, p.lon + dlon, p.h + dh};
        if (std::abs(dlat) < 1e-16 && std::abs(dlon) < 1e-15 && std::abs(dh) < 1e-9) break;
    }
    if (std::abs(p.lon) > std::numbers::pi) p.lon = math::wrap_pi(p.lon);
    s.position = p;
    s.v_eb_n += dx.segment<3>(3);
    s.q_nb = (math::quaternion_from_rotation_vector(-dx.tail<3>()) * truth.q_nb).normalized();
    return s;
}

NavStateEcef corrected(const NavStateEcef& estimate, const Vector9& dx) {
    NavStateEcef s = estimate;
    s.position.r -= dx.head<3>();
    s.v_eb_e -= dx.segment<3>(3);
    s.q_eb = (math::quaternion_from_rotation_vector(dx.tail<3>()) * estimate.q_eb).normalized();
    return s;
}

NavStateEcef perturbed(const NavStateEcef& truth, const Vector9& dx) {
    NavStateEcef s = truth;
    s.position.r += dx.head<3>();
    s.v_eb_e += dx.segment<3>(3);
    s.q_eb = (math::quaternion_from_rotation_vector(-dx.tail<3>()) * truth.q_eb).normalized();
    return s;
}

}  // namespace schuler::ins
