// What a wrong pseudorange would have done to the tight filter by now, and what the innovations say of it: detection of faults
// too small for one epoch, repair, and protection levels.
#pragma once

#include "schuler/core/time.h"
#include "schuler/estim/staged.h"
#include "schuler/fusion/ranging_settings.h"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace schuler::fusion {

/// "This source's pseudoranges are wrong by a constant since then." Per metre of it the estimate is wrong by `response`, the
/// innovations by what `information` and `evidence` gather: a scalar of variance s whose mean is m per metre adds m^2/s and m
/// nu/s. The size of the fault is then estimated as evidence/information with the variance 1/information, independent of the
/// error of the estimate without the fault, for innovations of an optimal filter are independent of its later errors
/// [Willsky1976] [Friedland1969].
template <int M>
struct FaultHypothesis {
    int source = -1;  ///< index into RangingLog::sources
    Time since{};
    Eigen::Matrix<double, M, 1> response = Eigen::Matrix<double, M, 1>::Zero();
    double information = 0.0;  ///< 1/m^2
    double evidence = 0.0;  ///< 1/m
};

/// Limits from probabilities.
struct ProtectionLimits {
    double test = 0.0;  ///< of |evidence|/sqrt(information), by the false alarm
    double bias = 0.0;  ///< standard deviations of the estimated fault that are missed with the stated probability
    double horizontal = 0.0, vertical = 0.0;  ///< standard deviations of the error with a fault
    double horizontal_free = 0.0, vertical_free = 0.0;  ///< likewise without
    ProtectionLimits() = default;
    explicit ProtectionLimits(const ProtectionSettings& settings);
};

struct ProtectionLevels {
    double horizontal = 0.0, vertical = 0.0;  ///< m
};

/// The hypotheses of a filter of M states, N of them propagated by a gathered transition. Plain and copyable. Starts are kept at
/// ages that about double, `most_ages` for each source: the youngest is this epoch's, the oldest is the source's first.
template <int M, int N>
struct FaultWatch {
    using Vector = Eigen::Matrix<double, M, 1>;
    using Matrix = Eigen::Matrix<double, M, M>;
    static constexpr std::size_t most_ages = 10;

    bool on = false;
    std::vector<FaultHypothesis<M>> all;

    /// A fault of this source may begin now.
    void begin(int source, Time now);
    void forget(int source);
    /// The means of the errors move with the errors: first N by `gathered`, the others by `decay`.
    void propagate(const estim::GatheredTransition<N>& gathered, const Vector& decay);
    /// Before the update with a scalar: innovation (less what those before it explain) = row . error + noise of variance r.
    /// `source`: whose pseudorange it is, -1: of nobody that may be wrong.
    template <int Most>
    void follow(const Matrix& P, const estim::SparseRow<Most>& row, double innovation, double r, int used, int source);
    /// The hypothesis furthest beyond the limit; nothing where none is.
    [[nodiscard]] const FaultHypothesis<M>* found(double limit) const;
    /// Bounds of the error of the position (P: its covariance north, east, down; T takes errors of the filter to those) that hold
    /// with the probabilities of the limits: without a fault, and with one fault of any size that has raised no alarm. For a
    /// fault below the size (test + bias)/sqrt(information) the error is at most what that size does and the noise; a larger one
    /// is missed less often than stated.
    [[nodiscard]] ProtectionLevels levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                          const Eigen::Matrix<double, 3, 9>& T) const;
};

}  // namespace schuler::fusion
