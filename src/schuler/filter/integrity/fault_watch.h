// What a wrong pseudorange would have done to the tight filter by now, and what the innovations say of it: detection of faults
// too small for one epoch, repair, and protection levels.
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

/// "This source's pseudoranges are wrong by a constant since then", or growing: wrong by a metre more with every second, and its rates by
/// a metre a second. Per metre (metre a second) of it the estimate is wrong by `response`, the
/// innovations by what `information` and `evidence` gather: a scalar of variance s whose mean is m per metre adds m^2/s and m
/// nu/s. The size of the fault is then estimated as evidence/information with the variance 1/information, independent of the
/// error of the estimate without the fault, for innovations of an optimal filter are independent of its later errors
/// [Willsky1976] [Friedland1969].
struct FaultHypothesis {
    int source = -1;  ///< index into RangingLog::sources
    bool growing = false;
    Time since{};
    estim::StateVector response;  ///< empty: none
    double information = 0.0;     ///< 1/m^2
    double evidence = 0.0;        ///< 1/m
};

/// "Nothing that this source says since then is to be believed": the filter that never used it, as its difference from the filter that did
/// (solution separation [BrownMcBurney1988]). Both have the same motion and process noise, so that the difference of the covariances moves by the
/// transition alone, and where the filter is optimal it is the covariance of the difference of the estimates. Whatever the shape of the
/// fault, and however slowly it came, this estimate is free of it.
struct WithoutSource {
    int source = -1;  ///< index into RangingLog::sources
    Time since{};
    estim::StateVector offset;  ///< its estimate minus the filter's
    estim::StateMatrix excess;  ///< its covariance minus the filter's
    /// Square of the normal deviate that speaks loudest against the source: separations of position and velocity, its range against
    /// this estimate and the prior of its slow error, and the hypotheses of its faults.
    double score = 0.0;
    double weight = 0.0;  ///< probability of being wrong, from the scores of all
};

/// A source that was found wrong and is not used until its means over a window agree again; where few others are in view these means say
/// little, so that it is used on probation then.
struct LeftOutSource {
    int source = -1;
    Time since{};                    ///< of the window
    int ranges = 0, rates = 0;       ///< in it
    double range = 0.0, rate = 0.0;  ///< sums of innovations, m and m/s

    static constexpr int probation = -1;  ///< as `ranges`
    [[nodiscard]] bool on_probation() const { return ranges == probation; }
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

/// One scalar of an update as the watch sees it: innovation = row . error + noise, before the update.
struct WatchedScalar {
    const estim::Row* row = nullptr;
    double innovation = 0.0, variance = 1.0;
    int source = -1;       ///< whose pseudorange or rate it is, -1: of nobody that may be wrong
    bool is_rate = false;  ///< of a range
};

/// The hypotheses of a filter. Plain and copyable. Starts are kept at
/// ages that about double, `most_ages` for each source: the youngest is this epoch's, the oldest is the source's first.
struct FaultWatch {
    static constexpr std::size_t most_ages = 10;
    static constexpr std::size_t most_sources = 30;  ///< filters without one

    /// Odds of a source to be wrong before anything is seen.
    static constexpr double prior_odds = 1e-3;
    /// Likewise of one that is used again after it was wrong.
    static constexpr double probation_odds = 0.3;
    /// Of the best suspect against the next, as a difference of scores: 100 to 1.
    static constexpr double decided = 9.2;

    bool on = false;
    std::vector<FaultHypothesis> all;      ///< constant
    std::vector<FaultHypothesis> growing;  ///< likewise
    std::vector<WithoutSource> without;
    std::vector<LeftOutSource> left_out;

    /// Room for so many sources, so that nothing is allocated later.
    void reserve(std::size_t sources);
    /// A fault of this source may begin now; `states`: size of the filter.
    void begin(int source, Time now, Eigen::Index states);
    void forget(int source);
    /// Nothing is suspected any more: everything restarts.
    void clear();
    [[nodiscard]] bool leaves_out(int source) const;
    /// The means of the errors move with the errors.
    void propagate(const estim::Transition& phi, int used);
    /// A state has another meaning.
    void renew(int state);
    /// Three states become combinations of others.
    void clone(int first, const std::array<estim::Row, 3>& rows, int used);
    /// The scalars of an update, which are used one after the other; P: of the filter before it.
    void follow(const estim::StateMatrix& P, std::span<const WatchedScalar> scalars, Time now, int used);
    /// Scores and weights of all that are suspected, after an epoch of ranges.
    void weigh();
    /// Before the update with a scalar: `innovation` less what those before it explain.
    void follow_one(const estim::StateMatrix& P, const WatchedScalar& scalar, double innovation, Time now, int used);
    /// The source that is beyond the limit and that no other competes with; nothing where there is none.
    [[nodiscard]] const WithoutSource* found(double limit) const;
    /// Second moment, about the estimate, of what the sources that may be wrong may have done to it, by their probabilities: of the leading
    /// nine errors.
    [[nodiscard]] Eigen::Matrix<double, 9, 9> undecided() const;
    /// Bounds of the error of the position (P: its covariance north, east, down; T takes errors of the filter to those) that hold
    /// with the probabilities of the limits: without a fault, and with one fault of any size that has raised no alarm. For a
    /// fault below the size (test + bias)/sqrt(information) the error is at most what that size does and the noise; a larger one
    /// is missed less often than stated.
    [[nodiscard]] ProtectionLevels levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                          const Eigen::Matrix<double, 3, 9>& T) const;
};

}  // namespace schuler::filter
