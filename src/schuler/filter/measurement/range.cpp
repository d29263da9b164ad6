#include "schuler/filter/measurement/range.h"

#include "schuler/filter/states/heading_force.h"
#include "schuler/gnss/satellite.h"
#include "schuler/ins/error_model.h"
#include "schuler/math/rotation.h"

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using gnss::speed_of_light;

AntennaEstimate antenna_of(const earth::Earth& earth, const NavState& nav, const Matrix3d& C_nb, const Vector3d& w_ib_b,
                           const Vector3d& lever_arm_b, double uncertain_rate, double heading_unknown) {
    const earth::EarthTerms t = earth::terms_at(earth, nav.position, nav.v_eb_n);
    AntennaEstimate a;
    a.C_en = earth::C_en(nav.position.lat, nav.position.lon);
    a.l_n = C_nb * lever_arm_b;
    a.turning = C_nb * w_ib_b.cross(lever_arm_b);
    a.for_heading = for_heading(a.turning, Vector3d::UnitZ(), heading_unknown * uncertain_rate * lever_arm_b.norm());
    a.w_ie_n = t.w_ie_n;
    a.v_n = nav.v_eb_n + a.turning - t.w_ie_n.cross(a.l_n);
    a.r_e = earth::ecef_from_geodetic(earth.ellipsoid, nav.position).r + a.C_en * a.l_n;
    a.v_e = a.C_en * a.v_n;
    a.place = earth::moved_by_ned(earth, nav.position, a.l_n);
    a.by_displacement = ins::level_rotation_by_displacement(t);
    a.gyro_lever = C_nb * math::skew(lever_arm_b);
    a.C_nb = C_nb;
    a.lever_turn = C_nb * math::skew(for_lever_arm(w_ib_b, uncertain_rate));
    a.w_ie = earth.ellipsoid.w_ie;
    return a;
}

RangeRows range_rows(const AntennaEstimate& a, const Ecef& transmitter, const Vector3d& velocity) {
    const Vector3d w(0.0, 0.0, a.w_ie);
    // the transmitter in the axes at reception: two iterations of light time
    double sine = 0.0, cosine = 1.0;
    const auto turned = [&](const Vector3d& x) {
        return Vector3d(cosine * x.x() + sine * x.y(), cosine * x.y() - sine * x.x(), x.z());
    };
    Vector3d r_j = transmitter.r;
    double range = (a.r_e - r_j).norm();
    for (int i = 0; i < 2; ++i) {
        const double angle = a.w_ie * range / speed_of_light;  // 1e-5: further terms of the series are below rounding
        sine = angle * (1.0 - angle * angle / 6.0);
        cosine = 1.0 - 0.5 * angle * angle;
        r_j = turned(transmitter.r);
        range = (a.r_e - r_j).norm();
    }
    const Vector3d u_e = (a.r_e - r_j) / range;
    const Vector3d vi_j = turned(velocity + w.cross(transmitter.r));  // relative to inertial space
    const double slower = 1.0 - u_e.dot(vi_j) / speed_of_light;
    RangeRows m;
    m.range = range;
    m.own_rate = u_e.dot(a.v_e);
    m.rate = u_e.dot(a.v_e + w.cross(a.r_e) - vi_j) / slower;
    const Matrix3d C_ne = a.C_en.transpose();
    const Vector3d u = C_ne * u_e;
    m.u_n = u;
    m.range_by_position = u;
    m.range_by_attitude = u.cross(a.l_n);
    // rotation of u: by the velocity across the line of sight, both relative to inertial space
    const Vector3d v_rel = C_ne * (a.v_e + w.cross(a.r_e) - vi_j);
    const Vector3d across = (v_rel - u * u.dot(v_rel)) / range;
    // the velocity rotates with C_en, and w x r_a changes with position
    const Vector3d by_place = C_ne * (u_e.cross(w));
    m.rate_by_position = (across + a.by_displacement.transpose() * a.v_n.cross(u) + by_place) / slower;
    m.rate_by_velocity = u / slower;
    m.rate_by_attitude =
        (u.cross(a.turning) - u.cross(a.w_ie_n).cross(a.l_n) + across.cross(a.l_n) + by_place.cross(a.l_n)) / slower;
    m.rate_by_attitude.z() += u.cross(a.for_heading - a.turning).z() / slower;
    m.rate_by_gyro_bias = a.gyro_lever.transpose() * u / slower;
    m.range_by_lever_arm = a.C_nb.transpose() * u;
    m.rate_by_lever_arm = (a.lever_turn.transpose() * u + a.C_nb.transpose() * (across + by_place - u.cross(a.w_ie_n))) / slower;
    return m;
}

}  // namespace schuler::filter
