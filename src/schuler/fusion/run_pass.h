// One complete pass of a filter along prepared data: forward, and backward if requested.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/fusion/run_filter.h"

namespace schuler::fusion {

/// Called after each epoch of ranges: the epoch, the antenna position, its covariance north, east, down, m^2.
using AfterRanges = std::function<void(const RangeEpoch&, const Geodetic&, const Eigen::Matrix3d&)>;

/// Options of one pass.
struct PassOptions {
    bool outputs = true;  ///< collect rows and sensor errors
    bool smooth = false;
    std::size_t last_increment = SIZE_MAX;
    Progress progress;
    RowSink rows;  ///< receives the forward rows instead of the result
    std::function<void(const ReceiverAiding& aiding, Time until)>
        receiver;  ///< generates the recording's ranges while the filter runs
    AfterRanges after_ranges;
    Rivalry rivalry = Rivalry::Contest;
};

/// Runs the pass. @throws Error(Input): a coupling by ranges without any ranges.
[[nodiscard]] Result run_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options);

/// Smoothed state at the start of a pass (for start-up) from the data up to `last_increment`.
struct StartEstimate {
    NavState nav;
    Eigen::Vector3d std_rpy;
    Eigen::Vector3d gyro_bias, accel_bias;
    double log_likelihood = 0.0;  ///< of the accepted GNSS innovations of the forward pass
};
[[nodiscard]] StartEstimate smooth_start(const RunData& data, const Settings& settings, const Start& start,
                                         std::size_t last_increment);

}  // namespace schuler::fusion
