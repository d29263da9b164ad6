// The axis of time that the logs of a data set share.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/dataset/description.h"

#include <optional>
#include <vector>

namespace schuler::dataset {

/// First and last time of the log that defines the data set's own axis: the IMU's, or the reference where there is none.
struct OwnAxis {
    double first, last;
};
[[nodiscard]] std::optional<OwnAxis> own_axis(const Recording& recording);

/// GPS time of zero on the data set's own axis, for files that carry dates where the other logs do not. Zero where they do.
[[nodiscard]] Duration axis_zero(const TimeConfig& time, Time first_fix, const OwnAxis& axis);

[[nodiscard]] std::vector<GnssFix> shifted(std::vector<GnssFix> fixes, Duration by);

/// Dated fixes on the axis of the recording, and moved by `offset`; as they are where no log has an axis of its own.
[[nodiscard]] std::vector<GnssFix> on_own_axis(std::vector<GnssFix> fixes, const TimeConfig& time, const Recording& recording,
                                               Duration offset);

/// Where seconds of the week restart in one log, those that begin after that instant follow it into the next week.
void settle_rollover(Recording& recording);

/// The clock of the IMU and of what was logged with it ran fast: their seconds by the receiver's clock, from the IMU's first.
void settle_drift(Recording& recording, double drift);

}  // namespace schuler::dataset
