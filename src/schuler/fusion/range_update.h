// One epoch of ranges in the tight filter: rows, the test of each range against the inertial prediction, exclusion, update.
#pragma once

#include "schuler/fusion/aid/range.h"
#include "schuler/fusion/tight_filter.h"

#include <array>
#include <cstddef>
#include <span>

namespace schuler::fusion {

/// Limits of the tests, from one probability for a good measurement to be rejected.
struct RangeTest {
    double single = 0.0;                          ///< of a squared normalised innovation
    std::array<double, 65> whole{};               ///< of their sum, by number
    double watch = 0.0;                           ///< of the fault watch, 0: none is kept
    double recovery_time = 10.0;                  ///< s after which a source that goes on disagreeing has its slow error opened

    RangeTest() = default;
    /// probability 0: everything is accepted.
    RangeTest(double probability, double recovery_time_);
};

/// One scalar of an epoch.
struct RangeScalar {
    static constexpr int most_entries = 16;

    int source = 0;                               ///< index into RangingLog::sources
    bool station = false, is_rate = false, use = true;
    int slot = -1;                                ///< state of the source's slow error
    double innovation = 0.0;                      ///< computed minus measured, m or m/s
    double variance = 1.0;                        ///< of its white noise
    double distance = 0.0;                        ///< m
    double sequential = 0.0;                      ///< normalised innovation after those before it in the epoch; white when all is well
    double s = 1.0;                               ///< variance of that innovation
    estim::SparseRow<most_entries> row;           ///< in the filter's own errors
};

/// Rooms for one epoch, kept between epochs so that nothing is allocated.
struct RangeEpochWork {
    static constexpr std::size_t most = 64;       ///< scalars of an epoch; further sources are left out
    std::array<RangeScalar, most> scalars;
    std::size_t count = 0;
    int excluded = 0;                             ///< scalars
    bool clock_jump = false;
    int alarm = -1;                               ///< source that the fault watch found wrong at this epoch
    int disagreeing = 0;                          ///< epochs in a row in which most ranges were excluded
    Time disagreeing_since{};

    [[nodiscard]] std::span<RangeScalar> all() { return {scalars.data(), count}; }
    [[nodiscard]] std::span<const RangeScalar> all() const { return {scalars.data(), count}; }
};

/// Index of a satellite system's offset among TightLayout::intersystem, -1 for GPS and those that share its clock.
[[nodiscard]] int intersystem_of(const RangeSource& source);

/// Fills the scalars of an epoch for an estimate: that of `filter` corrected by `dx`. Rows refer to errors of the filter as it
/// stands, so that innovation = row . error + noise to first order about the corrected estimate (an iterated update).
template <class Frame>
void make_scalars(const TightModel& model, TightFilter<Frame>& filter, const RangingLog& log, std::span<const RangeSample> samples,
                  const TightVector& dx, RangeEpochWork& work);

/// Updates the filter with an epoch at its own time (after bring_up). All scalars are used one by one; where the sum of squares
/// or one of them exceeds its limit, the epoch is taken back and each scalar is tested against all the others and the inertial
/// prediction (w_i = (S^-1 z)_i / sqrt((S^-1)_ii), normal without faults), the worst is left out, and so on until the rest agree:
/// single and multiple faults. A jump of the receiver's clock, which all ranges share, is followed. Where a fault watch is kept,
/// a source that it finds wrong raises an alarm: the estimate is freed of what the fault did, and the source's slow error takes
/// it over. Returns the number of scalars used.
template <class Frame>
int update_with_ranges(const TightModel& model, const RangeTest& test, TightFilter<Frame>& filter, const RangingLog& log,
                       std::span<const RangeSample> samples, RangeEpochWork& work);

}  // namespace schuler::fusion
