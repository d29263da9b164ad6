#include "schuler/ins/align.h"

#include "schuler/core/fail.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::ins {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

void require_direction(const Vector3d& v, const char* name) {
    if (v.allFinite() && v.squaredNorm() > 0.0) return;
    fail(input_error(fmt::format("the {} is zero or not a number, so it has no direction", name), {},
                     "check the units and the columns of the accelerometers and gyros"));
}

/// Components in the level frame with the body's heading.
Vector3d levelled(const Vector3d& v_b, double roll, double pitch) { return math::dcm_from_rpy(Vector3d(roll, pitch, 0.0)) * v_b; }

/// Conversion of the errors determined by the two vectors, phi_N = da_E/g, phi_E = -da_N/g, phi_D = dw_E/(w_ie cos lat) - phi_N
/// tan lat, with sigmas tilt = accel_std/g and azimuth = gyro_std/(w_ie cos lat), to the angles.
Vector3d predicted_std(const Vector3d& rpy, double tilt, double azimuth, double tan_lat) {
    Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
    P(0, 0) = P(1, 1) = tilt * tilt;
    P(0, 2) = P(2, 0) = -tilt * tilt * tan_lat;
    P(2, 2) = azimuth * azimuth + tilt * tilt * tan_lat * tan_lat;
    const Eigen::Matrix3d J = math::rpy_error_from_phi(rpy);
    const Eigen::Matrix3d P_rpy = J * P * J.transpose();
    return P_rpy.diagonal().cwiseSqrt();
}

}  // namespace

Levelling level(const Vector3d& f, double accel_std) {
    require_direction(f, "mean specific force");
    const double roll = std::atan2(-f.y(), -f.z());
    const double across = std::hypot(f.y(), f.z());
    const double pitch = std::atan2(f.x(), across);
    const double std_pitch = accel_std / f.norm();
    return {roll, pitch, across > 0.0 ? accel_std / across : std::numbers::pi, std_pitch};
}

Gyrocompass gyrocompass(const earth::Earth& earth, const Geodetic& position, const Vector3d& f, const Vector3d& w,
                        double accel_std, double gyro_std) {
    require_direction(w, "mean angular rate");
    if (!(std::abs(position.lat) < 89.9 * units::deg)) {
        fail(input_error(fmt::format("no gyrocompassing at latitude {:.3f} deg", position.lat / units::deg), {},
                         "give the heading, or align in motion"));
    }
    const Levelling l = level(f, accel_std);
    const earth::EarthTerms t = earth::terms_at(earth, position, Vector3d::Zero());
    const Vector3d w_level = levelled(w, l.roll, l.pitch);

    Gyrocompass out;
    out.rpy = {l.roll, l.pitch, math::wrap_2pi(std::atan2(-w_level.y(), w_level.x()))};
    out.q_nb = math::quaternion_from_rpy(out.rpy);
    out.std_rpy = predicted_std(out.rpy, accel_std / f.norm(), gyro_std / t.w_ie_n.x(), t.tan_lat);
    out.rate_misfit = w.norm() - earth.ellipsoid.w_ie;
    out.vertical_misfit = w_level.z() - t.w_ie_n.z();
    return out;
}

double heading_from_magnetometer(const Vector3d& field_b, double roll, double pitch, double declination) {
    const Vector3d m = levelled(field_b, roll, pitch);
    return math::wrap_2pi(std::atan2(-m.y(), m.x()) + declination);
}

Quaterniond attitude_from_specific_force(const Vector3d& f_b, const Vector3d& f_n, double heading) {
    require_direction(f_b, "specific force in body axes");
    require_direction(f_n, "specific force in local level");
    const Quaterniond any = Quaterniond::FromTwoVectors(f_b, f_n);
    // All rotations that map f_b to f_n are `any` rotated about f_n by an angle; the x axis then moves on a cone, and its
    // component perpendicular to the stated heading, along + c cos + s sin of that angle, must vanish.
    const Vector3d axis = f_n.normalized();
    const Vector3d x = any * Vector3d::UnitX();
    const Vector3d ahead(std::cos(heading), std::sin(heading), 0.0), across(-ahead.y(), ahead.x(), 0.0);
    const double along = across.dot(axis) * axis.dot(x);
    const double c = across.dot(x) - along;
    const double s = across.dot(axis.cross(x));
    const double amplitude = std::hypot(c, s);
    if (!(amplitude > 0.0)) return any;
    const double spread = std::acos(std::clamp(-along / amplitude, -1.0, 1.0));
    const double centre = std::atan2(s, c);

    Quaterniond best = any;
    double best_merit = -10.0;
    for (const double angle : std::array{centre + spread, centre - spread}) {
        const Quaterniond q = math::quaternion_from_rotation_vector(angle * axis) * any;
        const bool forward = ahead.dot(q * Vector3d::UnitX()) > 0.0;
        const double merit = (q * Vector3d::UnitZ()).z() + (forward ? 4.0 : 0.0);
        if (merit > best_merit) {
            best_merit = merit;
            best = q;
        }
    }
    return best.normalized();
}

}  // namespace schuler::ins
