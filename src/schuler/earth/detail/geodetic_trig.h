// Geodetic coordinates of an Earth-fixed position as sines and cosines, shared by conversion, gravity and frames.
#pragma once

#include "schuler/earth/ellipsoid.h"

#include <cmath>

namespace schuler::earth::detail {

struct GeodeticTrig {
    double sin_lat, cos_lat;
    double sin_lon, cos_lon;
    double h;  ///< m
};

/// Bowring's iteration on the reduced latitude u (B. R. Bowring, "The accuracy of geodetic latitude and height equations",
/// Survey Review 28, 1985): tan lat = (z + e'^2 b sin^3 u)/(p - e^2 a cos^3 u), here with two passes from his 1985 start value,
/// in pairs of sine and cosine so that no angle is evaluated and the poles are regular points. The height
/// p cos lat + z sin lat - a sqrt(1 - e^2 sin^2 lat) is of second order in the latitude error.
[[nodiscard]] inline GeodeticTrig geodetic_trig_from_ecef(const Ellipsoid& ellipsoid, const Eigen::Vector3d& r) {
    const double e2 = ellipsoid.e2();
    const double b = ellipsoid.b();
    const double ep2_b = e2 / (1.0 - e2) * b;
    const double p2 = r.x() * r.x() + r.y() * r.y();
    const double p = std::sqrt(p2);
    const double z = r.z();
    double su = z * b * (1.0 + ep2_b / std::sqrt(p2 + z * z));
    double cu = p * ellipsoid.a;
    double num = z;
    double den = p;
    for (int pass = 0; pass < 2; ++pass) {
        const double scale = 1.0 / std::sqrt(su * su + cu * cu);
        su *= scale;
        cu *= scale;
        num = z + ep2_b * su * su * su;
        den = p - e2 * ellipsoid.a * cu * cu * cu;
        su = (1.0 - ellipsoid.f) * num;
        cu = den;
    }
    const double norm = std::sqrt(num * num + den * den);
    const double sin_lat = num / norm;
    const double cos_lat = den / norm;
    // The difference p cos lat + z sin lat - a sqrt(...) cancels; summing from the surface point keeps the error near an ulp.
    const double w = std::sqrt(1.0 - e2 * sin_lat * sin_lat);
    const double n = ellipsoid.a / w;
    const double h = (p - n * cos_lat) * cos_lat + (z - n * (1.0 - e2) * sin_lat) * sin_lat;
    const bool on_axis = p == 0.0;
    return {sin_lat, cos_lat, on_axis ? 0.0 : r.y() / p, on_axis ? 1.0 : r.x() / p, h};
}

[[nodiscard]] inline Eigen::Matrix3d C_en_from_trig(double sin_lat, double cos_lat, double sin_lon, double cos_lon) {
    Eigen::Matrix3d C;
    // clang-format off
    C << -sin_lat * cos_lon, -sin_lon, -cos_lat * cos_lon,
         -sin_lat * sin_lon, cos_lon, -cos_lat * sin_lon,
         cos_lat, 0.0, -sin_lat;
    // clang-format on
    return C;
}

}  // namespace schuler::earth::detail
