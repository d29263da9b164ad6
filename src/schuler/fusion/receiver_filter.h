// The receiver's own filter of the intermediate coupling: position, velocity and clock of the antenna from ranges alone.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/filter/update/range_update.h"
#include "schuler/fusion/settings.h"

#include <optional>

namespace schuler::fusion {

/// The antenna moves with white acceleration (RangingFilterSettings::receiver_acceleration) about constant velocity over the
/// Earth; no inertial measurement and no barometer is used, not even to begin with: it starts where a single-point solution from
/// four satellites puts it. Clock, slow errors, tests and exclusions are the tight filter's, whose error states serve with
/// attitude and sensor errors known. After ten seconds with fewer than four ranges it ends,
/// and restarts with four.
class ReceiverFilter {
public:
    ReceiverFilter(const Settings& settings, const RangingLog& log);
    ReceiverFilter(const ReceiverFilter&) = delete;  // its parts refer to each other
    ReceiverFilter& operator=(const ReceiverFilter&) = delete;

    /// Uses an epoch's ranges (those that are not withheld). True where there is an estimate.
    bool process(const RangeEpoch& epoch, std::span<const RangeSample> samples);
    /// The estimate at the last epoch: of the antenna, attitude NaN.
    [[nodiscard]] SolutionRow row() const;
    /// Its covariance of the position, north, east, down, m^2.
    [[nodiscard]] Eigen::Matrix3d position_covariance() const;
    /// The last epoch's ranges determine a position by themselves.
    [[nodiscard]] bool determined() const { return determined_; }
    /// Most of the last epochs' ranges contradict this filter itself.
    [[nodiscard]] bool doubtful() const { return tracking_.work.disagreeing > 0; }

private:
    bool start(const RangeEpoch& epoch, std::span<const RangeSample> samples);
    void coast_to(Time time);
    void propagate_covariance();

    const RangingLog& log_;
    Settings settings_;
    InertialModel model_;
    RangeTest test_;
    RangeUpdate<GeographicFrame> update_;
    std::optional<InertialFilter<GeographicFrame>> filter_;
    RangeTracking tracking_;
    bool determined_ = false;
    Time last_determined_{};
};

}  // namespace schuler::fusion
