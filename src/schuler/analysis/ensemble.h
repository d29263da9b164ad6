// Many runs of one scenario: spread over the runs at each epoch and in total, and consistency with its bounds.
#pragma once

#include <Eigen/Core>

#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Values of one quantity: a row for each run, a column for each epoch, NaN if there is none.
using RunsByEpochs = Eigen::MatrixXd;

/// Root mean square and quantiles of some values; NaN are omitted.
struct Quantiles {
    double rms = std::numeric_limits<double>::quiet_NaN();
    double q05 = std::numeric_limits<double>::quiet_NaN();
    double median = std::numeric_limits<double>::quiet_NaN();
    double q95 = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] Quantiles quantiles_of(std::vector<double> values);

/// Over the runs, for each epoch.
[[nodiscard]] std::vector<Quantiles> quantiles_by_epoch(const RunsByEpochs& values);

/// NEES or NIS of blocks of `dof` states over independent runs.
struct EnsembleConsistency {
    double mean = std::numeric_limits<double>::quiet_NaN();      ///< over runs and epochs
    double expected = std::numeric_limits<double>::quiet_NaN();  ///< dof
    double low95 = std::numeric_limits<double>::quiet_NaN();     ///< two-sided 95 % bounds of the mean
    double high95 = std::numeric_limits<double>::quiet_NaN();
    double inside = std::numeric_limits<double>::quiet_NaN();  ///< share of epochs with the mean over the runs inside its bounds
    double worth = 0.0;                                        ///< number of independent epochs equivalent to a run

    [[nodiscard]] bool in_band() const { return mean >= low95 && mean <= high95; }
};

/// Bounds of the mean of n independent chi-square values of `dof` degrees of freedom [BarShalom2001:5.4.2]. n may be fractional.
struct Bounds {
    double low95, high95;
};
[[nodiscard]] Bounds mean_bounds(double dof, double n);

/// Successive epochs of a run are correlated: the equivalent number of independent ones per run follows from the scatter of the
/// run means (their variance is 2 dof / worth); at least one and at most the number of epochs.
[[nodiscard]] EnsembleConsistency ensemble_consistency(const RunsByEpochs& values, double dof);

}  // namespace schuler::analysis
