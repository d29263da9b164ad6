// Directions of satellites and stations as seen from the vehicle, and the use of their ranges.
#pragma once

#include "schuler/solution/bundle.h"

#include <vector>

namespace schuler::report {

enum class RangeUse { Used, Rejected, NotAsked };  ///< NotAsked: withheld, or the scheme does not use ranges

/// One source at one epoch of ranges.
struct SkyRow {
    Time time;       ///< of the epoch
    int source = 0;  ///< index into RangingLog::sources
    bool station = false;
    double azimuth = 0.0;    ///< rad, clockwise from north, 0 to 2 pi
    double elevation = 0.0;  ///< rad, above the plane normal to the ellipsoid normal
    RangeUse use = RangeUse::NotAsked;
    double residual = not_given;  ///< of the pseudorange: computed minus measured, before its own update, m
    double sigma = not_given;     ///< predicted one sigma of the residual, m
};

inline constexpr std::size_t most_sky_epochs = 300;

/// The epochs of ranges at the solution's positions, evenly decimated to most_sky_epochs. Empty if there is no log of ranges.
[[nodiscard]] std::vector<SkyRow> sky_rows(const solution::ResultBundle& bundle);

}  // namespace schuler::report
