// Arcs of carrier phases: where the count of whole cycles goes on, and where it began anew.
#pragma once

#include "schuler/ppk/settings.h"
#include "schuler/ppk/tracking.h"

#include <cstddef>

namespace schuler::ppk {

/// Why arcs began anew, beyond satellites that rose.
struct ArcCounts {
    std::size_t told = 0;           ///< the receiver said so
    std::size_t geometry_free = 0;  ///< two carriers of a satellite disagreed
    std::size_t unexplained = 0;    ///< no motion of the receiver explains the phase's step
    std::size_t gaps = 0;
    [[nodiscard]] std::size_t found() const { return geometry_free + unexplained; }
};

/// Numbers the arcs of every phase, from 1. An arc ends where the receiver says so, where it resolves its half cycles, after a gap, where
/// the difference of two carriers jumps (the geometry-free combination), and where a phase grew by what no displacement of the receiver and
/// step of its clock explain; with too few satellites for that, by what its Doppler does not explain. `at_rest`: there is no displacement.
/// Steps of the receiver's clock, also in the codes alone, are no slips.
ArcCounts number_arcs(std::vector<TrackedEpoch>& epochs, bool at_rest, const ArcSettings& settings);

}  // namespace schuler::ppk
