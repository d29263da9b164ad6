// Survey instruments other than IMU and receiver: height and depth gauges, velocity log, compass. SI units.
#pragma once

#include "schuler/core/samples.h"

#include <vector>

namespace schuler {

/// An instant at which the user requests the solution, such as a camera exposure.
struct NamedInstant {
    Time time;
    std::string name;  ///< may be empty
    long line = 0;     ///< line in its file
};

/// Each list is in time order; it is empty if there is no such instrument.
struct InstrumentLogs {
    std::vector<GaugeSample> gauges;
    std::vector<BodyVelocitySample> velocities;
    std::vector<HeadingSample> headings;
};

}  // namespace schuler
