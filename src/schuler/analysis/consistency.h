// Consistency of the errors with the filter's stated covariance: normalised errors and innovations against chi-square bounds.
#pragma once

#include "schuler/analysis/errors.h"

#include <Eigen/Core>

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Normalised estimation error squared (NEES) of a block of `dof` states over a run, as in summary.json.
struct NeesStatistics {
    double mean = std::numeric_limits<double>::quiet_NaN();
    double expected = std::numeric_limits<double>::quiet_NaN();  ///< dof
    double low95 = std::numeric_limits<double>::quiet_NaN();     ///< two-sided 95 % bounds of the mean
    double high95 = std::numeric_limits<double>::quiet_NaN();
    double effective_samples = 0.0;  ///< number of independent samples equivalent to the correlated ones of the run
};

/// e' P^-1 e; NaN if P is not positive definite.
[[nodiscard]] double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance);

/// Statistics of a series of NEES values in time order (NaN are omitted). Successive values are correlated, so the bounds are
/// those of effective_samples independent ones: the number of values divided by 1 + 2 sum of autocorrelations, summed over
/// positive neighbouring pairs (Geyer 1992, section 3.3); at least one. Bar-Shalom, Li and Kirubarajan 2001, section 5.4.
[[nodiscard]] NeesStatistics nees_statistics(std::span<const double> values, double dof);

/// NEES of position, velocity and attitude from stated sigmas alone; epochs without a finite error and sigma are omitted. The
/// expectation is 3 for any correlation between the axes. The bounds are those of effective_samples independent epochs with
/// independent axes: the variance of the mean follows from the correlations of the standardised errors in time, with their
/// integrated correlation time from an automatic window [Sokal1997:3], and between the axes. For fully correlated axes, an epoch
/// counts as one third.
struct ConsistencySummary {
    NeesStatistics position, velocity, attitude;
};
[[nodiscard]] ConsistencySummary consistency(std::span<const ErrorRow> rows, Time settled);

/// An innovation of `dof` <= 3 components as processed by the filter.
struct InnovationSample {
    double nis = 0.0;  ///< normalised innovation squared
    int dof = 0;
    bool accepted = true;
    Eigen::Vector3d standardised = Eigen::Vector3d::Zero();  ///< components divided by their predicted sigma
};

/// The `nis` of one kind of measurement in summary.json. mean, dof and lag1 are those of the accepted ones.
struct NisStatistics {
    double mean = std::numeric_limits<double>::quiet_NaN();
    double dof = std::numeric_limits<double>::quiet_NaN();  ///< mean number of components
    std::size_t accepted = 0, rejected = 0;
    double lag1 = std::numeric_limits<double>::quiet_NaN();  ///< correlation of successive values, about the mean of each axis
};
[[nodiscard]] NisStatistics nis_statistics(std::span<const InnovationSample> samples);

}  // namespace schuler::analysis
