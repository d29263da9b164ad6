// What the errors of ranges and of the receiver's clock cause in a filter that models them as they are.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

namespace schuler::study {

/// Covariance of all errors of the filter from these sources alone: their initial errors, their processes, and the white noise of the
/// ranges; everything else is exact.
class RangeErrors {
public:
    using Filter = filter::InertialFilter<filter::GeographicFrame>;

    /// @pre the layout has a clock
    RangeErrors(const filter::Layout& layout, const Filter& filter);
    /// `phi`: transition of the filter over the last `span` seconds.
    void step(const filter::InertialModel& model, const Filter& filter, const estim::Transition& phi, double span);
    /// A state starts again with this variance.
    void renewed(int state, double variance);
    /// `of_range`: its noise is that of a range.
    void correct(const estim::RowUpdate& update, bool of_range);

    [[nodiscard]] Eigen::Matrix<double, 9, 1> variances() const { return S_.diagonal().head<9>(); }

private:
    int first_;  ///< of the states that describe ranges: these and all that follow
    filter::StateMatrix S_;
};

}  // namespace schuler::study
