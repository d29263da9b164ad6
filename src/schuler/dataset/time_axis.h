// The common time axis of the logs of a data set.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"

#include <optional>
#include <vector>

namespace schuler::dataset {

/// First and last time of the log that defines the data set's own axis: the IMU's, or the reference if there is none.
struct OwnAxis {
    double first, last;
};
[[nodiscard]] std::optional<OwnAxis> own_axis(const Recording& recording);

/// GPS time of zero on the data set's own axis, for dated files if the other logs are not dated. Zero if they are.
[[nodiscard]] Duration axis_zero(const TimeConfig& time, Time first_fix, const OwnAxis& axis);

[[nodiscard]] std::vector<GnssFix> shifted(std::vector<GnssFix> fixes, Duration by);

/// Dated fixes on the axis of the recording, shifted by `offset`; unchanged if no log has its own axis.
[[nodiscard]] std::vector<GnssFix> on_own_axis(std::vector<GnssFix> fixes, const TimeConfig& time, const Recording& recording,
                                               Duration offset);

/// If the seconds of the week restart in one log, logs that start after that instant are moved to the next week.
void settle_rollover(Recording& recording);

/// Corrects a fast clock of the IMU and of the logs that share it: seconds of the receiver's clock, from the IMU's first sample.
void settle_drift(Recording& recording, double drift);

}  // namespace schuler::dataset
