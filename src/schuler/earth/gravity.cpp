#include "schuler/earth/gravity.h"

#include "schuler/core/fail.h"
#include "schuler/earth/paper_series.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace schuler::earth {
namespace {

/// Defining constants of a Somigliana normal gravity with second-order free air.
struct Somigliana {
    double a, f;
    double g_e;  ///< normal gravity at the equator, m/s^2
    double k;    ///< Somigliana's constant b g_p/(a g_e) - 1
    double m;    ///< w^2 a^2 b/GM
};
constexpr Somigliana somigliana_wgs84{6378137.0, 1.0 / 298.257223563, 9.7803253359, 0.00193185265241, 0.00344978650684};
// H. Moritz, "Geodetic Reference System 1980", Bulletin Geodesique 54, 1980.
constexpr Somigliana somigliana_grs80{6378137.0, 1.0 / 298.257222101, 9.7803267715, 0.001931851353, 0.00344978600308};

/// Surface gravity, its derivative with respect to latitude, and the free-air polynomial 1 - c1 h + c2 h^2.
struct SomiglianaTerms {
    double g0, g0_by_lat, c1, c1_by_lat, c2, meridian;
};

inline SomiglianaTerms terms_of(const Somigliana& n, double s, double c) {
    const double e2 = n.f * (2.0 - n.f);
    const double s2 = s * s;
    const double w2 = 1.0 - e2 * s2;
    const double inverse_w2 = 1.0 / w2;
    const double inverse_w = std::sqrt(inverse_w2);
    const double numerator = 1.0 + n.k * s2;
    SomiglianaTerms t;
    t.g0 = n.g_e * numerator * inverse_w;
    t.g0_by_lat = n.g_e * s * c * inverse_w * (2.0 * n.k + e2 * numerator * inverse_w2);
    t.c1 = 2.0 / n.a * (1.0 + n.f + n.m - 2.0 * n.f * s2);
    t.c1_by_lat = -8.0 * n.f / n.a * s * c;
    t.c2 = 3.0 / (n.a * n.a);
    t.meridian = n.a * (1.0 - e2) * inverse_w2 * inverse_w;
    return t;
}

inline GravityVector somigliana(const Somigliana& n, double s, double c, double h) {
    const SomiglianaTerms t = terms_of(n, s, c);
    const double by_lat_integral =
        t.g0_by_lat * h * (1.0 + h * (-0.5 * t.c1 + h * t.c2 / 3.0)) - 0.5 * t.g0 * t.c1_by_lat * h * h;
    return {-by_lat_integral / (t.meridian + h), t.g0 * (1.0 + h * (-t.c1 + h * t.c2))};
}

GravityGradient somigliana_gradient(const Somigliana& n, double s, double c, double h) {
    const SomiglianaTerms t = terms_of(n, s, c);
    return {t.g0_by_lat * (1.0 + h * (-t.c1 + h * t.c2)) - t.g0 * t.c1_by_lat * h, t.g0 * (-t.c1 + 2.0 * h * t.c2)};
}

// KF-GINS: g0(s2) - (h1 - h2 s2) h + h3 h^2, s2 = sin^2 lat.
constexpr double kf_g_e = 9.7803267715;
constexpr double kf_1 = 0.0052790414, kf_2 = 0.0000232718, kf_3 = 1.262e-7, kf_4 = 7e-10;
constexpr double kf_h1 = 3.0877e-6, kf_h2 = 4.3e-9, kf_h3 = 0.72e-12;

inline double kf_gins_down(double s2, double h) {
    return kf_g_e * (1.0 + s2 * (kf_1 + s2 * (kf_2 + s2 * (kf_3 + s2 * kf_4)))) - (kf_h1 - kf_h2 * s2) * h + kf_h3 * h * h;
}

// Paper C, math.md section 1: constants of the paper.
constexpr double paper_c_g = 9.78049, paper_c_delta = 5.317e-3, paper_c_a = 6378245.0;

inline double paper_c_down(double s2, double h) {
    const double ratio = paper_c_a / (paper_c_a + h);
    return paper_c_g * (1.0 + paper_c_delta * s2) * ratio * ratio;
}

constexpr PaperAGravity paper_a;

using Name = std::pair<std::string_view, GravityModel>;
constexpr std::array<Name, 5> names{Name{"somigliana", GravityModel::Somigliana}, Name{"grs80", GravityModel::Grs80},
                                    Name{"kf-gins", GravityModel::KfGins}, Name{"paper_a", GravityModel::PaperA},
                                    Name{"paper_c", GravityModel::PaperC}};

}  // namespace

GravityModel gravity_model_from_name(std::string_view name) {
    std::string known;
    for (const Name& n : names) {
        if (n.first == name) return n.second;
        known += fmt::format("{}{}", known.empty() ? "" : ", ", n.first);
    }
    SourcePlace place;
    place.key = "gravity";
    fail(input_error(fmt::format("unknown gravity model \"{}\"", name), place, "use one of " + known));
}

std::string_view name_of(GravityModel model) {
    for (const Name& n : names)
        if (n.second == model) return n.first;
    fail(computation_error("gravity model without a name"));
}

GravityVector gravity_vector(GravityModel model, double sin_lat, double cos_lat, double h) {
    const double s2 = sin_lat * sin_lat;
    switch (model) {
        case GravityModel::Somigliana: break;
        case GravityModel::Grs80: return somigliana(somigliana_grs80, sin_lat, cos_lat, h);
        case GravityModel::KfGins: return {0.0, kf_gins_down(s2, h)};
        case GravityModel::PaperA:
            return {paper_a_gravity_north(paper_a, sin_lat, cos_lat, h), paper_a_gravity_l1(paper_a, s2, h).down};
        case GravityModel::PaperC: return {0.0, paper_c_down(s2, h)};
    }
    return somigliana(somigliana_wgs84, sin_lat, cos_lat, h);
}

double gravity_down(GravityModel model, double lat, double h) {
    return gravity_vector(model, std::sin(lat), std::cos(lat), h).down;
}

GravityGradient gravity_gradient(GravityModel model, double lat, double h) {
    const double s = std::sin(lat), c = std::cos(lat);
    const double s2 = s * s;
    const double s2_by_lat = 2.0 * s * c;
    switch (model) {
        case GravityModel::Somigliana: break;
        case GravityModel::Grs80: return somigliana_gradient(somigliana_grs80, s, c, h);
        case GravityModel::KfGins:
            return {(kf_g_e * (kf_1 + s2 * (2.0 * kf_2 + s2 * (3.0 * kf_3 + s2 * 4.0 * kf_4))) + kf_h2 * h) * s2_by_lat,
                    -kf_h1 + kf_h2 * s2 + 2.0 * kf_h3 * h};
        case GravityModel::PaperA: {
            const SeriesGravity g = paper_a_gravity_l1(paper_a, s2, h);
            return {g.by_s2 * s2_by_lat, g.by_height};
        }
        case GravityModel::PaperC: {
            const double ratio = paper_c_a / (paper_c_a + h);
            return {paper_c_g * paper_c_delta * ratio * ratio * s2_by_lat, -2.0 * paper_c_down(s2, h) / (paper_c_a + h)};
        }
    }
    return somigliana_gradient(somigliana_wgs84, s, c, h);
}

}  // namespace schuler::earth
