// Levels an inertial unit at rest from its mean specific force, and mechanizes a second of standing still.
#include <schuler/core/units.h>
#include <schuler/earth/earth.h>
#include <schuler/ins/align.h>
#include <schuler/ins/increments.h>
#include <schuler/ins/step.h>
#include <schuler/math/rotation.h>

#include <cstdio>

int main() {
    using namespace schuler;
    const earth::Earth earth;
    const Geodetic place{55.0 * units::deg, 37.0 * units::deg, 150.0};
    const earth::EarthTerms terms = earth::terms_at(earth, place, Eigen::Vector3d::Zero());
    const Eigen::Quaterniond q_nb = math::quaternion_from_rpy({2.0 * units::deg, -1.0 * units::deg, 0.0});
    const Eigen::Vector3d f_b = q_nb.conjugate() * -terms.g_n, w_ib_b = q_nb.conjugate() * terms.w_ie_n;

    const ins::Levelling level = ins::level(f_b, 1e-3);
    const NavState start{Time{}, place, Eigen::Vector3d::Zero(), q_nb};
    const ins::CompensatedIncrement second = ins::compensate({}, {Time::from_seconds(1.0), 1.0, w_ib_b, f_b});
    const NavState after = ins::step_n(earth, start, second);
    std::printf("roll %.3f pitch %.3f deg; after 1 s at rest: %.1e m/s\n", level.roll / units::deg, level.pitch / units::deg,
                after.v_eb_n.norm());
}
