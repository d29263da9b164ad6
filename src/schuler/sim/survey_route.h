// A survey route: parallel lines in alternating directions, tie lines across them, turns of limited bank angle.
#pragma once

#include "schuler/sim/path.h"

namespace schuler::sim {

/// Lines first, each to the right of the previous one, then the tie lines across all of them starting from the nearer end.
struct SurveyPattern {
    Geodetic start;        ///< start of the run-in of the first line
    double heading = 0.0;  ///< of the first line, rad
    double speed = 60.0;   ///< m/s
    int lines = 6;
    double length = 40e3;              ///< of a line, m
    double spacing = 4e3;              ///< between lines, m
    int ties = 2;                      ///< evenly spaced over the length
    double overrun = 1000.0;           ///< straight segment before and after every line, m
    double bank = 0.2617993877991494;  ///< maximum in turns, rad
    double standstill = 0.0;           ///< s at rest at the start; 0: initially in motion
    double duration = 0.0;             ///< s: after the last line, straight on for the rest of this time
};

/// Turns are semicircles of two corners if the lines are far enough apart, otherwise wider than the spacing.
/// @throws Error(Input) that names the invalid key.
[[nodiscard]] RoutePath survey_route(const SurveyPattern& pattern);

}  // namespace schuler::sim
