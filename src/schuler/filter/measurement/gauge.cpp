#include "schuler/filter/measurement/gauge.h"

#include "schuler/math/rotation.h"

#include <cmath>

namespace schuler::filter {

using Eigen::Vector3d;

Measurement gauge_heights(const Estimate& e, const Vector3d& heights, double variance,
                          const std::array<Vector3d, 3>& lever_arms_b) {
    Measurement m;
    for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(heights(i))) continue;
        const Vector3d l_n = e.C_nb * lever_arms_b[static_cast<std::size_t>(i)];
        const int level = e.layout.gauge_level < 0 ? -1 : e.layout.gauge_level + i;
        const double height = e.nav.position.h - l_n.z() + (level < 0 ? 0.0 : e.parameters(level));
        estim::Row& row = m.add(height - heights(i), variance);
        position_of(row).z() = -1.0;
        attitude_of(row) = -math::skew(l_n).row(2).transpose();
        if (level >= 0) row.add(level, 1.0);
    }
    return m;
}

Measurement measurement_of(const Estimate& e, const GaugeSample& s, const Settings& settings) {
    return gauge_heights(e, s.height, settings.gauges.std * settings.gauges.std, settings.gauges.lever_arms_b);
}

}  // namespace schuler::filter
