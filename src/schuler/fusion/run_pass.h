// One complete pass of a filter along prepared data: forward, and backward if asked for.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/fusion/run_filter.h"

namespace schuler::fusion {

/// Told after each epoch of ranges: the epoch, the antenna's place, the covariance of the position north, east, down, m^2.
using AfterRanges = std::function<void(const RangeEpoch&, const Geodetic&, const Eigen::Matrix3d&)>;

/// Options of one pass.
struct PassOptions {
    bool outputs = true;  ///< collect rows and sensor errors
    bool smooth = false;
    std::size_t last_increment = SIZE_MAX;
    Progress progress;
    RowSink rows;  ///< takes the forward rows instead of the result
    std::function<void(const ReceiverAiding& aiding, Time until)>
        receiver;  ///< makes the recording's ranges while the filter runs
    AfterRanges after_ranges;
    Rivalry rivalry = Rivalry::Contest;
};

/// Runs it. @throws Error(Input): a coupling by ranges, and there are none.
[[nodiscard]] Result run_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options);

/// Smoothed state at the start of a pass (for start-up): what the data up to `last_increment` say about it.
struct StartEstimate {
    NavState nav;
    Eigen::Vector3d std_rpy;
    Eigen::Vector3d gyro_bias, accel_bias;
    double log_likelihood = 0.0;  ///< of the accepted GNSS innovations of the forward pass
};
[[nodiscard]] StartEstimate smooth_start(const RunData& data, const Settings& settings, const Start& start,
                                         std::size_t last_increment);

}  // namespace schuler::fusion
