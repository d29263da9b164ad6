// Named ellipsoids and datums, and the seven-parameter transformations between datums and WGS-84.
#pragma once

#include "schuler/core/position.h"
#include "schuler/earth/earth.h"
#include "schuler/earth/ellipsoid.h"

#include <Eigen/Core>

#include <string_view>

namespace schuler::earth {

/// Ellipsoid of a settings file: wgs84, pz90, pz90.11, sk42, international1924, paper_c.
/// @throws Error(Input) that lists the known names.
[[nodiscard]] Ellipsoid ellipsoid_from_name(std::string_view name);

/// Earth model of a settings file: an ellipsoid by name and a gravity model by name (gravity_model_from_name).
/// @throws Error(Input) that lists the known names.
[[nodiscard]] Earth earth_from_names(std::string_view ellipsoid, std::string_view gravity);

/// Seven-parameter (Helmert) transformation, COORDINATE FRAME convention (EPSG method 1032; the rotation turns the axes, not the
/// position vector; the position-vector convention of EPSG 1033 has the opposite signs), linear in the angles as GOST writes it:
/// target = translation + (1 + scale) [1 wz -wy; -wz 1 wx; wy -wx 1] source.
struct Helmert {
    Eigen::Vector3d translation;  ///< m
    Eigen::Vector3d rotation;     ///< wx, wy, wz, rad
    double scale;                 ///< dimensionless
};
[[nodiscard]] Ecef transformed(const Helmert& helmert, const Ecef& source);
/// Exact inverse (a 3 x 3 solution, not a change of sign of the parameters): to rounding, 2 nm.
[[nodiscard]] Ecef transformed_back(const Helmert& helmert, const Ecef& target);

/// Geodetic datums. Current WGS-84 realisations (G1674 and later) and PZ-90.11 differ by less than 2 cm; the parameters
/// of the standard, used here, refer to G1150.
enum class Datum {
    Wgs84,    ///< WGS-84 (G1150)
    Pz90,     ///< PZ-90 of 1990
    Pz90_11,  ///< PZ-90.11
    Sk42,     ///< SK-42 (Pulkovo 1942), Krasovsky ellipsoid; accuracy a few metres
    Ed50,     ///< European Datum 1950, mean, International 1924 ellipsoid; accuracy several metres
};

/// Datums of settings files: wgs84, pz90, pz90.11, sk42, ed50.
/// @throws Error(Input) that lists the known names.
[[nodiscard]] Datum datum_from_name(std::string_view name);
[[nodiscard]] std::string_view name_of(Datum datum);
[[nodiscard]] const Ellipsoid& ellipsoid_of(Datum datum);

// Parameters: GOST 32453-2017 (successor of GOST R 51794-2008), appendices; EPSG codes if registered.

/// PZ-90 to PZ-90.11 (EPSG 7704).
[[nodiscard]] const Helmert& pz90_to_pz90_11();
/// SK-42 to PZ-90.11 (GOST 32453-2017).
[[nodiscard]] const Helmert& sk42_to_pz90_11();
/// WGS-84 (G1150) to PZ-90.11 ("Parametry Zemli 1990 (PZ-90.11)", reference document, 2014; EPSG 7961 followed by 7703).
[[nodiscard]] const Helmert& wgs84_to_pz90_11();
/// ED50 to WGS-84, mean of Western Europe, three parameters (NIMA TR8350.2, appendix B; EPSG 1133).
[[nodiscard]] const Helmert& ed50_to_wgs84();

/// Converts an Earth-fixed position from one datum to another, m.
[[nodiscard]] Ecef datum_changed(Datum from, Datum to, const Ecef& position);
/// Likewise for geodetic coordinates, each on its datum's ellipsoid.
[[nodiscard]] Geodetic datum_changed(Datum from, Datum to, const Geodetic& position);

}  // namespace schuler::earth
