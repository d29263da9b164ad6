// A survey as it is flown or sailed: parallel lines to and fro, tie lines across them, turns that keep a bank angle.
#pragma once

#include "schuler/sim/path.h"

namespace schuler::sim {

/// Lines first, one after the other to the right of the first one, then the tie lines across all of them from the nearer end on.
struct SurveyPattern {
    Geodetic start;        ///< where the run-in of the first line begins
    double heading = 0.0;  ///< of the first line, rad
    double speed = 60.0;   ///< m/s
    int lines = 6;
    double length = 40e3;              ///< of a line, m
    double spacing = 4e3;              ///< between lines, m
    int ties = 2;                      ///< evenly over the length
    double overrun = 1000.0;           ///< straight before and behind every line, m
    double bank = 0.2617993877991494;  ///< largest in turns, rad
    double standstill = 0.0;           ///< s at rest at first; 0: on its way
    double duration = 0.0;             ///< s: after the last line straight on for as long as this lasts
};

/// Turns are half circles of two corners where the lines are far enough apart, otherwise wider than the spacing.
/// @throws Error(Input) naming the key that is unusable.
[[nodiscard]] RoutePath survey_route(const SurveyPattern& pattern);

}  // namespace schuler::sim
