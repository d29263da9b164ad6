// Information of the measurements about the errors at the start of a filter: a smoother of one fixed point, beside the filter.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::estim {

/// Covariance of the initial errors given all measurements so far, and what each group of measurements takes from it (a fixed-point
/// smoother: Gelb, Applied Optimal Estimation, 5.3; the covariance of initial and current errors is propagated by the filter's
/// transitions and gains).
class InitialErrors {
public:
    /// `start`: initial covariance; measurements come in `groups` groups.
    InitialErrors(const StateMatrix& start, std::size_t groups);

    void step(const Transition& phi);
    /// An update with the filter's optimal gain.
    void scalar(const RowUpdate& update, std::size_t group);
    /// A state starts again: its current error has nothing of the initial ones.
    void renewed(int state) { current_.row(state).setZero(); }

    [[nodiscard]] const Eigen::MatrixXd& start() const { return start_; }
    /// Of the initial errors given the measurements.
    [[nodiscard]] Eigen::MatrixXd covariance() const;
    /// What the measurements of a group have taken from it: start() is covariance() plus the sum over all groups.
    [[nodiscard]] const Eigen::MatrixXd& gained(std::size_t group) const { return gained_[group]; }

private:
    Eigen::MatrixXd start_;
    Eigen::MatrixXd current_;  ///< covariance of the current errors (rows) with the initial ones
    std::vector<Eigen::MatrixXd> gained_;
    Eigen::VectorXd seen_;
};

}  // namespace schuler::estim
