// The kinds of paths behind make_path, and their common parts.
#pragma once

#include "schuler/sim/geodetic_jet.h"
#include "schuler/sim/path.h"

#include <memory>

namespace schuler::sim {

/// Metres along the meridian and the parallel of a point as latitude and longitude: linear, so that kinematics are exact anywhere;
/// true metres near the point.
struct LocalChart {
    Geodetic origin;
    double lat_per_m, lon_per_m;

    LocalChart(const earth::Ellipsoid& ellipsoid, const Geodetic& start);

    template <int N>
    [[nodiscard]] GeodeticJet<N> at(const Jet<N>& north, const Jet<N>& east, const Jet<N>& up) const {
        return {origin.lat + lat_per_m * north, origin.lon + lon_per_m * east, origin.h + up};
    }
};

/// The x axis along the velocity, which must not vanish; banked in proportion to the lateral acceleration.
[[nodiscard]] Kinematics moving_along(const earth::Ellipsoid& ellipsoid, const GeodeticJet<3>& position,
                                      double roll_per_lateral_accel);

[[nodiscard]] std::unique_ptr<const TruthPath> make_motion(const FigureEightPath& settings, const earth::Ellipsoid& ellipsoid);
[[nodiscard]] std::unique_ptr<const TruthPath> make_motion(const ShipPath& settings, const earth::Ellipsoid& ellipsoid);
[[nodiscard]] std::unique_ptr<const TruthPath> make_motion(const TablePath& settings, const earth::Ellipsoid& ellipsoid);
[[nodiscard]] std::unique_ptr<const TruthPath> make_motion(const RecordedPath& settings, const earth::Ellipsoid& ellipsoid);

}  // namespace schuler::sim
