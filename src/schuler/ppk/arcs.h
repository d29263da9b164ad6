// Arcs of carrier phases: intervals of continuous cycle counting.
#pragma once

#include "schuler/ppk/settings.h"
#include "schuler/ppk/tracking.h"

#include <cstddef>

namespace schuler::ppk {

/// Reasons for new arcs, other than rising satellites.
struct ArcCounts {
    std::size_t told = 0;           ///< flagged by the receiver
    std::size_t geometry_free = 0;  ///< two carriers of a satellite disagree
    std::size_t unexplained = 0;    ///< the step of the phase is not explained by any motion of the receiver
    std::size_t gaps = 0;
    [[nodiscard]] std::size_t found() const { return geometry_free + unexplained; }
};

/// Numbers the arcs of every phase, from 1. An arc ends where the receiver flags it, where it resolves its half cycles, after a
/// gap, where the difference of two carriers jumps (the geometry-free combination), and where the change of a phase is not
/// explained by a displacement of the receiver, a step of its clock and the modelled atmosphere; with too few satellites for that,
/// by its Doppler.
/// `at_rest`: there is no displacement. Steps of the receiver's clock, also in the codes alone, are not slips.
ArcCounts number_arcs(std::vector<TrackedEpoch>& epochs, bool at_rest, const ArcSettings& settings, const AirModel& air);

}  // namespace schuler::ppk
