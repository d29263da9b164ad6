#include "schuler/filter/measurement/environment.h"

#include "schuler/math/rotation.h"

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

Measurement magnetic_azimuth(const Estimate& e, const Vector3d& field_b, double declination, double variance) {
    Measurement m;
    const Vector3d field_n = e.C_nb * field_b;
    const double h2 = field_n.head<2>().squaredNorm();
    if (h2 < 0.01 * field_n.squaredNorm()) return m;
    const bool with_bias = e.layout.mag_bias >= 0;
    const double bias = with_bias ? e.parameters(e.layout.mag_bias) : 0.0;
    const double azimuth = std::atan2(field_n.y(), field_n.x());
    estim::Row& row = m.add(math::wrap_pi(azimuth - declination + bias), variance);
    // The estimated field is rotated by -phi: d(field) = -phi x field = [field x] phi.
    const Eigen::RowVector3d by_field(-field_n.y() / h2, field_n.x() / h2, 0.0);
    attitude_of(row) = (by_field * math::skew(field_n)).transpose();
    if (with_bias) row.add(e.layout.mag_bias, 1.0);
    return m;
}

Measurement measurement_of(const Estimate& e, const BaroSample& s, const Settings& settings) {
    return baro_height(e, s.height, settings.baro.std * settings.baro.std);
}

Measurement measurement_of(const Estimate& e, const MagSample& s, const Settings& settings) {
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings.imu.mounting_rpy) * settings.imu.C_bs;
    return magnetic_azimuth(e, C_bs * s.field_b, settings.mag.used_declination(),
                            settings.mag.heading_std * settings.mag.heading_std);
}

}  // namespace schuler::filter
