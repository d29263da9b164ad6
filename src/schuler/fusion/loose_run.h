// One complete pass of a filter of given frame and size: forward, and backward if asked for.
#pragma once

#include "schuler/fusion/forward_pass.h"
#include "schuler/fusion/run_filter.h"

namespace schuler::fusion {

/// Where and how uncertain a run starts.
struct Start {
    NavState nav;
    Eigen::Vector3d std_position, std_velocity;   ///< NED
    Eigen::Vector3d std_rpy;                      ///< rad, mapped to the attitude error by its Jacobian
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
    Eigen::Vector3d std_gyro_bias, std_accel_bias;
    /// 1 where a component (north, east, down) comes from a fix and so has the receiver's slow error in it, 0 where it does not.
    Eigen::Vector3d position_of_fix = Eigen::Vector3d::Zero(), velocity_of_fix = Eigen::Vector3d::Zero();
    double std_mounting = 0.03;                   ///< rad
    std::size_t increment = 0;                    ///< first increment to consume
    ImuIncrement previous{{}, 0.0, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

/// Options of one pass.
struct PassOptions {
    bool outputs = true;          ///< collect rows and sensor errors
    bool smooth = false;
    std::size_t last_increment = SIZE_MAX;
    Progress progress;
    RowSink rows;                 ///< takes the forward rows instead of the result
    std::function<void(const Guide& guide, Time until)> receiver;   ///< tight: makes the recording's ranges while the filter runs
};

/// Runs it. The size of the filter is the smallest instantiated one that holds the layout.
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
