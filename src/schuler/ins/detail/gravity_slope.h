// Change of a model's gravity vector with latitude and height, required by both error models.
#pragma once

#include "schuler/earth/earth.h"

namespace schuler::ins::detail {

struct GravitySlope {
    double down_by_lat;      ///< m/s^2/rad
    double down_by_height;   ///< 1/s^2, about -3.08e-6
    double north_by_height;  ///< 1/s^2
};

/// Height dependence of the north component, from the existence of a potential: d((M + h) north)/dh = -d(down)/dlat, if the
/// model has a north component at all.
[[nodiscard]] inline GravitySlope gravity_slope(earth::GravityModel model, double lat, double h, const earth::EarthTerms& t) {
    const earth::GravityGradient g = earth::gravity_gradient(model, lat, h);
    const bool has_north = model != earth::GravityModel::KfGins && model != earth::GravityModel::PaperC;
    return {g.by_lat, g.by_height, has_north ? -(g.by_lat + t.g_n.x()) / t.rm : 0.0};
}

}  // namespace schuler::ins::detail
