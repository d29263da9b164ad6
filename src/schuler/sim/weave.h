// The flight used for the evaluation of paper D's system: alternating straight legs and turns, gentle climbs (math.md 5.4).
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/sim/path.h"

namespace schuler::sim {

/// At constant ground speed, each for a quarter period: a straight leg, a right turn, a straight leg, a left turn.
struct WeavingFlight {
    Geodetic start;
    double heading = 0.0;                     ///< rad, initial
    double speed = 230.0;                     ///< m/s
    double period = 240.0;                    ///< s
    double turn_rate = 0.017453292519943295;  ///< rad/s, reached and left smoothly
    double edge = 10.0;                       ///< s of each start and end of a turn
    double climb = 2.0;                       ///< m/s, amplitude of the vertical speed
    double climb_period = 200.0;              ///< s
    double duration = 780.0;                  ///< s, minimum duration
};

/// As a recording with one point per second: bank of a coordinated turn, two degrees of incidence.
[[nodiscard]] RecordedPath weaving_path(const WeavingFlight& flight, const earth::Ellipsoid& ellipsoid);

}  // namespace schuler::sim
