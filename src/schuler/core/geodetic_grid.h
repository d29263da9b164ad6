// Values at the points of a grid of latitude and longitude.
#pragma once

#include "schuler/core/position.h"

#include <Eigen/Core>

#include <vector>

namespace schuler {

/// Read between the points by the bilinear rule; outside, the edge goes on. What the three numbers are, its owner says.
class GeodeticGrid {
public:
    /// lat, lon: rising, at least two each, rad. values: of the first latitude all longitudes, then the next.
    /// @throws Error(Input) where that is not so.
    GeodeticGrid(std::vector<double> lat, std::vector<double> lon, std::vector<Eigen::Vector3d> values);

    [[nodiscard]] Eigen::Vector3d at(double lat, double lon) const;
    /// The place is not beyond the edge.
    [[nodiscard]] bool covers(double lat, double lon) const;

private:
    std::vector<double> lat_, lon_;
    std::vector<Eigen::Vector3d> values_;
};

}  // namespace schuler
