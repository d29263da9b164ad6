#include "schuler/fusion/aid/environment.h"

#include "schuler/math/rotation.h"

#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;

LocalMeasurement baro_height(const Estimate& e, double measured, double variance) {
    const bool with_bias = e.layout.baro_bias >= 0;
    LocalMeasurement m;
    const double bias = with_bias ? e.parameters(e.layout.baro_bias) : 0.0;
    const int i = add_component(m, e.nav.position.h + bias - measured, variance);
    m.rows(Layout::position + 2, i) = -1.0;
    if (with_bias) m.rows(e.layout.baro_bias, i) = 1.0;
    return m;
}

LocalMeasurement magnetic_azimuth(const Estimate& e, const Vector3d& field_b, double declination, double variance) {
    LocalMeasurement m;
    const Vector3d field_n = e.C_nb * field_b;
    const double h2 = field_n.head<2>().squaredNorm();
    if (h2 < 0.01 * field_n.squaredNorm()) return m;
    const bool with_bias = e.layout.mag_bias >= 0;
    const double bias = with_bias ? e.parameters(e.layout.mag_bias) : 0.0;
    const double azimuth = std::atan2(field_n.y(), field_n.x());
    const int i = add_component(m, math::wrap_pi(azimuth - declination + bias), variance);
    // The estimated field is turned by -phi: d(field) = -phi x field = [field x] phi.
    const Eigen::RowVector3d by_field(-field_n.y() / h2, field_n.x() / h2, 0.0);
    m.rows.col(i).segment<3>(Layout::attitude) = (by_field * math::skew(field_n)).transpose();
    if (with_bias) m.rows(e.layout.mag_bias, i) = 1.0;
    return m;
}

}  // namespace schuler::fusion
