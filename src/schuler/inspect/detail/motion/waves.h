// Recognition of a ship: it rolls and pitches with the waves and keeps its height.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"

namespace schuler::inspect::detail {

struct Waves {
    double tilt = 0.0;   ///< rms of roll and pitch at periods of 3 to 20 s in the quietest third of the log, rad
    double share = 0.0;  ///< of these periods in the variance of roll and pitch at all periods up to two minutes
    double felt =
        0.0;  ///< share of the horizontal specific force at these periods that is gravity in the tilted axes: an aircraft
              ///< accelerates as it tilts and senses none
    double height = 0.0;  ///< m, range of one-minute means of the height, without the outer twentieths
    bool found = false;   ///< all of these are as expected of a ship
};

/// Over the time span common to both logs; nothing is found in less than two minutes or with an IMU below 5 Hz.
[[nodiscard]] Waves waves_of(const ImuSeries& imu, const GnssSeries& gnss);

}  // namespace schuler::inspect::detail
