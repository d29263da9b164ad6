// Paper A's series in flattening and height: curvatures 1/(R + H) and normal gravity, with misprints corrected.
#pragma once

namespace schuler::earth {

/// a/(R + H) for both principal radii of curvature, dimensionless.
struct CurvatureSeries {
    double meridian;
    double prime_vertical;
};

/// Paper A, (1.3.1), first order in e^2 and H/a; s2 = sin^2 lat, y = H/a. The meridian needs +e^2 (printed -e^2, math.md E2.22).
/// Relative error for 0 to 20 km at all latitudes: meridian 4.6e-5, prime vertical 2.6e-5.
[[nodiscard]] inline CurvatureSeries paper_a_curvature_first_order(double e2, double s2, double y) {
    return {1.0 + e2 - y - 1.5 * e2 * s2, 1.0 - y - 0.5 * e2 * s2};
}

/// Paper A, second order, corrected (math.md 2.6, E2.22, E2.23). Relative error for 0 to 20 km at all latitudes: meridian 3.1e-7,
/// prime vertical 1.5e-7.
[[nodiscard]] inline CurvatureSeries paper_a_curvature_second_order(double e2, double s2, double y) {
    return {
        1.0 + e2 - y - 1.5 * e2 * s2 - 2.0 * e2 * y + 3.0 * e2 * y * s2 + y * y + e2 * e2 * (1.0 - 1.5 * s2 + 0.375 * s2 * s2),
        1.0 - y - 0.5 * e2 * s2 + y * y + e2 * y * s2 - e2 * e2 * s2 * s2 / 8.0};
}

/// Constants of paper A's gravity series. The paper's e^2 is 6.73e-3; 1/297 gives 0.00672267 (math.md E2.28).
struct PaperAGravity {
    double g_e = 9.78049;  ///< m/s^2 at the equator
    double a = 6378388.0;  ///< m
    double e2 = 6.73e-3;
    double q = 0.00346775;  ///< ratio of centrifugal acceleration to gravity at the equator
};
/// The same with the e^2 of its ellipsoid, International 1924: within 1.45e-6 m/s^2 of the 1930 normal gravity at h = 0.
inline constexpr PaperAGravity paper_a_gravity_international{9.78049, 6378388.0, 0.00672267, 0.00346775};

/// Down component (m/s^2) of a series and its derivatives with respect to s2 = sin^2 lat (m/s^2) and height (1/s^2).
struct SeriesGravity {
    double down;
    double by_s2;
    double by_height;
};

/// Series L1 with corrected coefficients (math.md 2.7, E2.24). Within 4.2e-5 m/s^2 of the 1930 normal gravity with free air for
/// 0 to 20 km (mostly its e^2).
[[nodiscard]] inline SeriesGravity paper_a_gravity_l1(const PaperAGravity& p, double s2, double h) {
    const double y = h / p.a;
    const double by_s = 0.5 * (5.0 * p.q - p.e2) - p.e2 * p.e2 / 8.0 - 17.0 / 28.0 * p.q * p.e2;
    const double by_sy = 3.0 * p.e2 - 5.0 * p.q;
    const double by_S2 = p.e2 * (0.5 * p.e2 - 5.0 * p.q) / 16.0;
    const double S2 = 4.0 * s2 * (1.0 - s2);  // sin^2 of twice the latitude
    const double linear = 2.0 + p.e2 + 2.0 * p.q;
    return {p.g_e * (1.0 - linear * y + 3.0 * y * y + (by_s + by_sy * y) * s2 + by_S2 * S2),
            p.g_e * (by_s + by_sy * y + by_S2 * (4.0 - 8.0 * s2)), p.g_e / p.a * (-linear + 6.0 * y + by_sy * s2)};
}

/// Series L3 with e^2 in place of the printed e (math.md 2.7, E2.27), down, m/s^2: within 2.1e-4 in the same range.
[[nodiscard]] inline double paper_a_gravity_l3(const PaperAGravity& p, double s2, double h) {
    return p.g_e * (1.0 + 5.2884e-3 * s2) * (1.0 - 2.0 * h / p.a * (1.0 - p.e2 * s2));
}

/// North component .5 g (H/a)(e^2 - 5 q) sin 2 lat, corrected (math.md 2.7, E2.26), m/s^2: within 6e-7 to 20 km.
[[nodiscard]] inline double paper_a_gravity_north(const PaperAGravity& p, double sin_lat, double cos_lat, double h) {
    return p.g_e * h / p.a * (p.e2 - 5.0 * p.q) * sin_lat * cos_lat;
}

}  // namespace schuler::earth
