#include "schuler/filter/measurement/environment.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Vector3d;

Measurement baro_height(const Estimate& e, double measured, double variance) {
    const bool with_bias = e.layout.baro_bias >= 0;
    Measurement m;
    const double bias = with_bias ? e.parameters(e.layout.baro_bias) : 0.0;
    estim::Row& row = m.add(e.nav.position.h + bias - measured, variance);
    position_of(row).z() = -1.0;
    if (with_bias) row.add(e.layout.baro_bias, 1.0);
    return m;
}

namespace {

/// Derivative of a field's azimuth with respect to its components; the vertical one has no part.
Eigen::RowVector3d azimuth_gradient(const Vector3d& field_n) {
    return Eigen::RowVector3d(-field_n.y(), field_n.x(), 0.0) / field_n.head<2>().squaredNorm();
}

/// Sum of the Earth's horizontal field, which is the unit, and of the body's.
Vector3d with_iron(double azimuth, const Vector3d& iron_n) {
    return Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0) + iron_n;
}

}  // namespace

Eigen::RowVector3d deviation_by_iron(const Eigen::Matrix3d& C_nb, double azimuth, const Vector3d& iron_n) {
    return azimuth_gradient(with_iron(azimuth, iron_n)) * C_nb;
}

Measurement magnetic_azimuth(const Estimate& e, const Vector3d& field_b, double declination, double variance) {
    Measurement m;
    const Layout& L = e.layout;
    const Vector3d field_n = e.C_nb * field_b;
    if (field_n.head<2>().squaredNorm() < 0.01 * field_n.squaredNorm()) return m;
    double expected = declination;
    for (const int offset : {L.mag_bias, L.mag_disturbance})
        if (offset >= 0) expected -= e.parameters(offset);
    const Vector3d iron_n = L.hard_iron >= 0 ? Vector3d(e.C_nb * e.parameters.segment<3>(L.hard_iron)) : Vector3d::Zero();
    const Vector3d total_n = with_iron(expected, iron_n);
    if (total_n.head<2>().squaredNorm() < 0.01) return m;  // the sum is too small to define a direction
    const double azimuth = std::atan2(field_n.y(), field_n.x());
    estim::Row& row = m.add(math::wrap_pi(azimuth - std::atan2(total_n.y(), total_n.x())), variance);
    // The measured field and the estimated hard iron are rotated by -phi: d(field) = -phi x field = [field x] phi.
    const Eigen::RowVector3d by_total = azimuth_gradient(total_n);
    attitude_of(row) = (azimuth_gradient(field_n) * math::skew(field_n) - by_total * math::skew(iron_n)).transpose();
    const double by_offset = by_total.dot(Eigen::RowVector3d(-std::sin(expected), std::cos(expected), 0.0));
    for (const int offset : {L.mag_bias, L.mag_disturbance})
        if (offset >= 0) row.add(offset, by_offset);
    if (L.hard_iron >= 0) {
        const Eigen::RowVector3d by_iron = by_total * e.C_nb;
        for (int i = 0; i < 3; ++i) row.add(L.hard_iron + i, -by_iron(i));
    }
    return m;
}

Measurement without_tilt(const Estimate& e, Measurement m) {
    for (int i = 0; i < m.dof; ++i) {
        auto level = m.rows[static_cast<std::size_t>(i)].head.segment<2>(Layout::attitude);
        m.variance(i) += level.dot(e.tilt_covariance * level);
        level.setZero();
    }
    return m;
}

Measurement measurement_of(const Estimate& e, const BaroSample& s, const Settings& settings) {
    return baro_height(e, s.height, settings.baro.std * settings.baro.std);
}

Measurement measurement_of(const Estimate& e, const MagSample& s, const Settings& settings) {
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings.imu.mounting_rpy) * settings.imu.C_bs;
    const Measurement azimuth = magnetic_azimuth(e, C_bs * s.field_b, settings.mag.used_declination(),
                                                 settings.mag.heading_std * settings.mag.heading_std);
    constexpr double calibrated = 2.0 * units::deg;  // the field is known well enough to show a tilt
    return std::max(settings.mag.deviation_std, settings.mag.used_disturbance()) > calibrated ? without_tilt(e, azimuth)
                                                                                              : azimuth;
}

}  // namespace schuler::filter
