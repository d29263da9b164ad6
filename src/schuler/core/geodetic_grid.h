// Values on a grid of latitude and longitude.
#pragma once

#include "schuler/core/position.h"

#include <Eigen/Core>

#include <vector>

namespace schuler {

/// Bilinear interpolation between the points, constant extrapolation of the edge outside. The owner defines the three components.
class GeodeticGrid {
public:
    /// lat, lon: ascending, at least two each, rad. values: all longitudes of the first latitude, then of the next.
    /// @throws Error(Input) if these conditions are not met.
    GeodeticGrid(std::vector<double> lat, std::vector<double> lon, std::vector<Eigen::Vector3d> values);

    [[nodiscard]] Eigen::Vector3d at(double lat, double lon) const;
    /// True if the position is within the grid.
    [[nodiscard]] bool covers(double lat, double lon) const;

private:
    std::vector<double> lat_, lon_;
    std::vector<Eigen::Vector3d> values_;
};

}  // namespace schuler
