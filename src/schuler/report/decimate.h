// Decimation of plots without visible change.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::report {

/// Ascending indices of the points to draw, about max_points of them. The points at which all channels (of equal length) are
/// finite are divided into equal buckets; of each bucket the points of each channel's minimum and maximum are kept, and of the
/// whole the first and the last point. With x and y as channels this is M4 (Jugel et al., "M4: a visualization-oriented time
/// series data aggregation", VLDB 2014), which leaves the picture of a line unchanged if a bucket is at most a pixel wide. With
/// at most max_points finite points, all of them are kept.
[[nodiscard]] std::vector<std::size_t> decimate(std::span<const std::span<const double>> channels, std::size_t max_points);

}  // namespace schuler::report
