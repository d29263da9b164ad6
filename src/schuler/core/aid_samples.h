// Instruments of a survey beside IMU and receiver: gauges of height or depth, a log of velocity, a compass. SI units.
#pragma once

#include "schuler/core/samples.h"

#include <vector>

namespace schuler {

/// An instant at which a user wants the solution: an exposure of a camera, a shot.
struct NamedInstant {
    Time time;
    std::string name;  ///< may be empty
    long line = 0;     ///< of its file
};

/// In order of time each; empty where there is no such instrument.
struct AidLog {
    std::vector<GaugeSample> gauges;
    std::vector<BodyVelocitySample> velocities;
    std::vector<HeadingSample> headings;
};

}  // namespace schuler
