// What a wrong pseudorange would have done to the tight filter by now, and what the innovations say of it: detection of faults
// too small for one epoch, repair, and protection levels.
#pragma once

#include "schuler/core/time.h"
#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"
#include "schuler/filter/ranging_settings.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::filter {

/// "This source's pseudoranges are wrong by a constant since then." Per metre of it the estimate is wrong by `response`, the
/// innovations by what `information` and `evidence` gather: a scalar of variance s whose mean is m per metre adds m^2/s and m
/// nu/s. The size of the fault is then estimated as evidence/information with the variance 1/information, independent of the
/// error of the estimate without the fault, for innovations of an optimal filter are independent of its later errors
/// [Willsky1976] [Friedland1969].
struct FaultHypothesis {
    int source = -1;  ///< index into RangingLog::sources
    Time since{};
    estim::StateVector response;  ///< empty: none
    double information = 0.0;     ///< 1/m^2
    double evidence = 0.0;        ///< 1/m
};

/// Limits from probabilities.
struct ProtectionLimits {
    double test = 0.0;  ///< of |evidence|/sqrt(information), by the false alarm
    double bias = 0.0;  ///< standard deviations of the estimated fault that are missed with the stated probability
    double horizontal = 0.0, vertical = 0.0;            ///< standard deviations of the error with a fault
    double horizontal_free = 0.0, vertical_free = 0.0;  ///< likewise without
    ProtectionLimits() = default;
    explicit ProtectionLimits(const ProtectionSettings& settings);
};

struct ProtectionLevels {
    double horizontal = 0.0, vertical = 0.0;  ///< m
};

/// The hypotheses of a filter. Plain and copyable. Starts are kept at
/// ages that about double, `most_ages` for each source: the youngest is this epoch's, the oldest is the source's first.
struct FaultWatch {
    static constexpr std::size_t most_ages = 10;

    bool on = false;
    std::vector<FaultHypothesis> all;

    /// A fault of this source may begin now; `states`: size of the filter.
    void begin(int source, Time now, Eigen::Index states);
    void forget(int source);
    /// The means of the errors move with the errors.
    void propagate(const estim::Transition& phi);
    /// Before the update with a scalar: innovation (less what those before it explain) = row . error + noise of variance r.
    /// `source`: whose pseudorange it is, -1: of nobody that may be wrong.
    void follow(const estim::StateMatrix& P, const estim::Row& row, double innovation, double r, int used, int source);
    /// The hypothesis furthest beyond the limit; nothing where none is.
    [[nodiscard]] const FaultHypothesis* found(double limit) const;
    /// Bounds of the error of the position (P: its covariance north, east, down; T takes errors of the filter to those) that hold
    /// with the probabilities of the limits: without a fault, and with one fault of any size that has raised no alarm. For a
    /// fault below the size (test + bias)/sqrt(information) the error is at most what that size does and the noise; a larger one
    /// is missed less often than stated.
    [[nodiscard]] ProtectionLevels levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                          const Eigen::Matrix<double, 3, 9>& T) const;
};

}  // namespace schuler::filter
