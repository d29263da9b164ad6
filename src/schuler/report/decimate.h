// Fewer points for the same picture.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::report {

/// Ascending indices of the points to draw, about max_points of them. The points at which all channels (of one length) are finite
/// are cut into equal buckets, of which the places of each channel's smallest and largest value stay, and the first and the last
/// point of all. With x and y as channels this is M4 (Jugel et al., "M4: a visualization-oriented time series data
/// aggregation", VLDB 2014), which leaves the picture of a line as it is where a bucket is at most a pixel wide.
/// Where there are no more finite points than max_points, all of them stay.
[[nodiscard]] std::vector<std::size_t> decimate(std::span<const std::span<const double>> channels, std::size_t max_points);

}  // namespace schuler::report
