// Effect of a wrong pseudorange on the tightly coupled filter, and the evidence for it in the innovations: detection of faults
// too small for a single epoch, repair, and protection levels.
#pragma once

#include "schuler/core/time.h"
#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"
#include "schuler/filter/ranging_settings.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace schuler::filter {

/// The hypothesis that this source's pseudoranges have had a constant error since a given time, or one that grows by a constant
/// rate, with the range rates wrong by that rate. Per unit of the fault (m or m/s), the estimate is wrong by `response`. The
/// innovations are accumulated in `information` and `evidence`: a scalar nu of variance s whose mean is m per unit adds m^2/s
/// and m nu/s. The fault is then estimated as evidence/information with variance 1/information, independent of the fault-free
/// error of the estimate, because innovations of an optimal filter are independent of its later errors [Willsky1976]
/// [Friedland1969].
struct FaultHypothesis {
    int source = -1;  ///< index into RangingLog::sources
    bool growing = false;
    Time since{};
    estim::StateVector response;  ///< empty: none
    double information = 0.0;     ///< 1/m^2
    double evidence = 0.0;        ///< 1/m
};

/// The filter without any measurement of this source since a given time, as its difference from the filter in use (solution
/// separation [BrownMcBurney1988]). Both have the same motion and process noise, so the difference of the covariances propagates
/// by the transition alone, and for an optimal filter it is the covariance of the difference of the estimates. This estimate is
/// free of the fault, whatever its shape or rate of growth.
struct WithoutSource {
    int source = -1;  ///< index into RangingLog::sources
    Time since{};
    estim::StateVector offset;  ///< its estimate minus the filter's
    estim::StateMatrix excess;  ///< its covariance minus the filter's
    /// Square of the largest normalised statistic against the source: separations of position and velocity, its range against
    /// this estimate and the prior of its slow error, and the fault hypotheses.
    double score = 0.0;
    double weight = 0.0;  ///< probability of being faulty, from the scores of all sources
};

/// A source found faulty, excluded until its mean innovations over a window agree again. With few other sources in view these
/// means carry little information, and the source is then used on probation.
struct LeftOutSource {
    int source = -1;
    Time since{};                    ///< start of the window
    int ranges = 0, rates = 0;       ///< number in the window
    double range = 0.0, rate = 0.0;  ///< sums of innovations, m and m/s

    static constexpr int probation = -1;  ///< value of `ranges` on probation
    [[nodiscard]] bool on_probation() const { return ranges == probation; }
};

/// Limits derived from probabilities.
struct ProtectionLimits {
    double test = 0.0;                        ///< of |evidence|/sqrt(information), from the false-alarm probability
    double bias = 0.0;                        ///< standard deviations of the estimated fault missed with the stated probability
    double horizontal = 0.0, vertical = 0.0;  ///< standard deviations of the error with a fault
    double horizontal_free = 0.0, vertical_free = 0.0;  ///< likewise without a fault
    ProtectionLimits() = default;
    explicit ProtectionLimits(const ProtectionSettings& settings);
};

struct ProtectionLevels {
    double horizontal = 0.0, vertical = 0.0;  ///< m
};

/// One scalar of an update as input of the fault watch: innovation = row . error + noise, before the update.
struct WatchedScalar {
    const estim::Row* row = nullptr;
    double innovation = 0.0, variance = 1.0;
    int source = -1;       ///< source of the pseudorange or rate, -1: assumed fault-free
    bool is_rate = false;  ///< a range rate
};

/// The fault hypotheses of a filter. Plain and copyable. Start times are kept at ages that roughly double, `most_ages` for each
/// source: the youngest is this epoch's, the oldest is the source's first.
struct FaultWatch {
    static constexpr std::size_t most_ages = 10;
    static constexpr std::size_t most_sources = 30;  ///< more sources: no watch

    /// Prior odds that a source is faulty.
    static constexpr double prior_odds = 1e-3;
    /// The same for a source on probation.
    static constexpr double probation_odds = 0.3;
    /// Required difference of scores between the best and the next suspect: odds of 100 to 1.
    static constexpr double decided = 9.2;

    bool on = false;
    std::vector<FaultHypothesis> all;      ///< constant
    std::vector<FaultHypothesis> growing;  ///< likewise
    std::vector<WithoutSource> without;
    std::vector<LeftOutSource> left_out;

    /// Reserves memory for this number of sources, so that nothing is allocated later.
    void reserve(std::size_t sources);
    /// Starts the hypothesis of a fault of this source at this time; `states`: size of the filter.
    void begin(int source, Time now, Eigen::Index states);
    void forget(int source);
    /// Discards all hypotheses and restarts.
    void clear();
    [[nodiscard]] bool leaves_out(int source) const;
    /// Propagates the expected errors by the transition.
    void propagate(const estim::Transition& phi, int used);
    /// A state is reassigned.
    void renew(int state);
    /// Three states become combinations of others.
    void clone(int first, const std::array<estim::Row, 3>& rows, int used);
    /// Processes the scalars of an update in sequence; P: of the filter before it.
    void follow(const estim::StateMatrix& P, std::span<const WatchedScalar> scalars, Time now, int used);
    /// Scores and weights of all suspects, after an epoch of ranges.
    void weigh();
    /// Before the update with a scalar: `innovation` less the corrections of the preceding scalars.
    void follow_one(const estim::StateMatrix& P, const WatchedScalar& scalar, double innovation, Time now, int used);
    /// The source beyond the limit if no other competes with it; otherwise null.
    [[nodiscard]] const WithoutSource* found(double limit) const;
    /// Second moment about the estimate of the possible effect of the suspected sources, weighted by their probabilities, for the
    /// leading nine errors.
    [[nodiscard]] Eigen::Matrix<double, 9, 9> undecided() const;
    /// Bounds of the position error (P: its covariance north, east, down; T maps filter errors to those) that hold with the
    /// probabilities of the limits: without a fault, and with one fault of any size that has not raised an alarm. For a fault
    /// below (test + bias)/sqrt(information) the error is at most the effect of that size plus the noise; a larger one is missed
    /// less often than stated.
    [[nodiscard]] ProtectionLevels levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                          const Eigen::Matrix<double, 3, 9>& T) const;
};

}  // namespace schuler::filter
