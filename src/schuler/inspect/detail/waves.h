// Whether a body floats: it rolls and pitches with the waves, and stays at the level of the sea.
#pragma once

#include "schuler/inspect/detail/motion.h"

namespace schuler::inspect::detail {

struct Waves {
    double tilt = 0.0;   ///< root mean square of roll and pitch at periods of 3 to 20 s in the quietest third of the log, rad
    double share = 0.0;  ///< of these periods in the variance of roll and pitch, of all up to two minutes
    double felt =
        0.0;  ///< share of the horizontal specific force at these periods that gravity explains by the tilt: what flies or rides
              ///< accelerates as it tilts, and feels none of it, or another
    double height = 0.0;  ///< m, range of the means of the height over a minute, without the outer twentieths
    bool found = false;   ///< all of them are as they are afloat
};

/// Of the whole time that both logs have in common; nothing is found in less than two minutes or below 5 Hz.
[[nodiscard]] Waves waves_of(const ImuSeries& imu, const GnssSeries& gnss);

}  // namespace schuler::inspect::detail
