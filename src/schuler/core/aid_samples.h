// Instruments of a survey beside IMU and receiver: gauges of height or depth, a log of velocity, a compass. SI units.
#pragma once

#include "schuler/core/samples.h"

#include <vector>

namespace schuler {

/// Heights by up to three gauges, m; NaN where one is not there.
struct GaugeSample {
    Time time;
    Eigen::Vector3d height = not_given3();
};

/// Velocity against the Earth at a log, body axes, m/s.
struct BodyVelocitySample {
    Time time;
    Eigen::Vector3d velocity_b;
};

/// An instant at which a user wants the solution: an exposure of a camera, a shot.
struct NamedInstant {
    Time time;
    std::string name;                ///< may be empty
    long line = 0;                   ///< of its file
};

/// In order of time each; empty where there is no such instrument.
struct AidLog {
    std::vector<GaugeSample> gauges;
    std::vector<BodyVelocitySample> velocities;
    std::vector<HeadingSample> headings;
};

}  // namespace schuler
