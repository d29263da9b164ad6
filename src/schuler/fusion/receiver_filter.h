// The receiver's own filter of the intermediate coupling: position, velocity and clock of the antenna from ranges alone.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/filter/update/range_update.h"
#include "schuler/fusion/settings.h"

#include <optional>

namespace schuler::fusion {

/// The antenna moves with white acceleration (RangingFilterSettings::receiver_acceleration) about constant velocity relative
/// to the Earth; no inertial measurement or barometer is used, not even for initialisation: it starts at a single-point
/// solution from four satellites. Clock, slow errors, tests and exclusions are those of the tight filter, whose error states
/// are used with attitude and sensor errors known. After ten seconds with fewer than four ranges it stops, and restarts with
/// four.
class ReceiverFilter {
public:
    ReceiverFilter(const Settings& settings, const RangingLog& log);
    ReceiverFilter(const ReceiverFilter&) = delete;  // its parts refer to each other
    ReceiverFilter& operator=(const ReceiverFilter&) = delete;

    /// Processes an epoch's ranges (those not withheld). True if there is an estimate.
    bool process(const RangeEpoch& epoch, std::span<const RangeSample> samples);
    /// The estimate at the last epoch: at the antenna, attitude NaN.
    [[nodiscard]] SolutionRow row() const;
    /// Covariance of its position, north, east, down, m^2.
    [[nodiscard]] Eigen::Matrix3d position_covariance() const;
    /// True if the last epoch's ranges alone determine a position.
    [[nodiscard]] bool determined() const { return determined_; }
    /// True if most ranges of the last epochs contradict this filter itself.
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
