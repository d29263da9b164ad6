// The flight on which paper D's system is judged: straight legs and turns to and fro, gentle climbs (math.md 5.4).
#pragma once

#include "schuler/earth/ellipsoid.h"
#include "schuler/sim/path.h"

namespace schuler::sim {

/// At a constant speed over the ground: a leg of a quarter period straight, a turn to the right, a straight leg, a turn to the left.
struct WeavingFlight {
    Geodetic start;
    double heading = 0.0;                     ///< rad, at first
    double speed = 230.0;                     ///< m/s
    double period = 240.0;                    ///< s
    double turn_rate = 0.017453292519943295;  ///< rad/s, reached and left smoothly
    double edge = 10.0;                       ///< s of each beginning and end of a turn
    double climb = 2.0;                       ///< m/s, amplitude of the vertical speed
    double climb_period = 200.0;              ///< s
    double duration = 780.0;                  ///< s that it must last
};

/// As a recording, a point a second: bank as in a coordinated turn, two degrees of incidence.
[[nodiscard]] RecordedPath weaving_path(const WeavingFlight& flight, const earth::Ellipsoid& ellipsoid);

}  // namespace schuler::sim
