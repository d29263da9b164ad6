// Instruments of a survey beside IMU and receiver: gauges of height or depth, a log of velocity, a compass. SI units.
#pragma once

#include "schuler/core/samples.h"

#include <vector>

namespace schuler {

/// In order of time each; empty where there is no such instrument.
struct AidLog {
    std::vector<GaugeSample> gauges;
    std::vector<BodyVelocitySample> velocities;
    std::vector<HeadingSample> headings;
};

}  // namespace schuler
