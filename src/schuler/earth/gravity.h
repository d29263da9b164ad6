// Gravity models as values: normal gravity in the local level.
#pragma once

#include "schuler/earth/ellipsoid.h"

#include <Eigen/Core>

#include <string_view>

namespace schuler::earth {

/// Each model has its own constants, independent of the ellipsoid used with it. The height range is limited by the
/// series: -1 km to 20 km for the bounds below. "North" describes the north component of the model (the southward
/// component caused by the flattened Earth above the ellipsoid, up to 1.6e-4 m/s^2 at 20 km); the east component is zero in all.
enum class GravityModel {
    Somigliana,  ///< WGS-84 Somigliana with second-order free air. North: zero at h = 0, analytic with height
    Grs80,       ///< the same formulas with the GRS-80 constants
    KfGins,      ///< latitude series and height polynomial of the KF-GINS program. North: zero, as in that program
    PaperA,      ///< paper A's series L1 with corrected coefficients (paper_series.h). North: paper A's gN, corrected
    PaperC,      ///< paper C: g_eo a^2 (1 + delta sin^2 lat)/(a + H)^2. North: zero, as in the paper
};

/// Names of settings files: somigliana, grs80, kf-gins, paper_a, paper_c.
/// @throws Error(Input) that lists the known names.
[[nodiscard]] GravityModel gravity_model_from_name(std::string_view name);
[[nodiscard]] std::string_view name_of(GravityModel model);

/// Gravity (gravitation plus centrifugal) in the local level, m/s^2. East is zero in every model.
struct GravityVector {
    double north;  ///< negative in the northern hemisphere above the ellipsoid
    double down;
};

/// Gravity at a latitude given by its sine and cosine, and an ellipsoidal height (m): the form used in hot paths.
/// Somigliana and GRS-80: down = g0 (1 - c1 h + c2 h^2), g0 = ge (1 + k s^2)/sqrt(1 - e^2 s^2), s = sin lat,
/// c1 = 2 (1 + f + m - 2 f s^2)/a, c2 = 3/a^2 (NIMA TR8350.2, 3rd ed., ch. 4, eqs. 4-1 and 4-3; within 1.5e-6 m/s^2 of the
/// closed form from 0 to 20 km). north follows from the down component because the field has a potential:
/// d((M + h) north)/dh = -d(down)/dlat, integrated from north = 0 on the ellipsoid (within 5e-8 m/s^2 of the closed form to 20 km).
[[nodiscard]] GravityVector gravity_vector(GravityModel model, double sin_lat, double cos_lat, double h);

/// The down component at a latitude (rad) and ellipsoidal height (m), m/s^2.
[[nodiscard]] double gravity_down(GravityModel model, double lat, double h);
/// Derivatives of the down component with respect to latitude (m/s^2/rad) and height (1/s^2), analytic.
struct GravityGradient {
    double by_lat;
    double by_height;
};
[[nodiscard]] GravityGradient gravity_gradient(GravityModel model, double lat, double h);

}  // namespace schuler::earth
