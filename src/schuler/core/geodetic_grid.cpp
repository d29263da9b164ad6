#include "schuler/core/geodetic_grid.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace schuler {

namespace {

/// The interval of an ascending axis that contains x, and the weight of its upper end.
std::pair<std::size_t, double> place_on(const std::vector<double>& axis, double x) {
    const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, x);
    const auto i = static_cast<std::size_t>(above - axis.begin()) - 1;
    return {i, std::clamp((x - axis[i]) / (axis[i + 1] - axis[i]), 0.0, 1.0)};
}

bool rises(const std::vector<double>& axis) {
    return axis.size() >= 2 && std::ranges::adjacent_find(axis, std::greater_equal<>()) == axis.end();
}

}  // namespace

GeodeticGrid::GeodeticGrid(std::vector<double> lat, std::vector<double> lon, std::vector<Eigen::Vector3d> values)
    : lat_(std::move(lat)), lon_(std::move(lon)), values_(std::move(values)) {
    if (!rises(lat_) || !rises(lon_) || values_.size() != lat_.size() * lon_.size())
        throw input_error("is not a grid of latitude and longitude", {},
                          "give at least two rising latitudes and longitudes and a value for each pair");
}

Eigen::Vector3d GeodeticGrid::at(double lat, double lon) const {
    const auto [i, up] = place_on(lat_, lat);
    const auto [j, right] = place_on(lon_, lon);
    const std::size_t n = lon_.size(), k = i * n + j;
    return (1.0 - up) * ((1.0 - right) * values_[k] + right * values_[k + 1]) +
           up * ((1.0 - right) * values_[k + n] + right * values_[k + n + 1]);
}

bool GeodeticGrid::covers(double lat, double lon) const {
    return lat >= lat_.front() && lat <= lat_.back() && lon >= lon_.front() && lon <= lon_.back();
}

}  // namespace schuler
