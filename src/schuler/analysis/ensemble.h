// Many runs of one scenario: spread over the runs at each epoch and over all, and consistency with its bounds.
#pragma once

#include <Eigen/Core>

#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Values of one quantity: a row for each run, a column for each epoch, NaN where there is none.
using RunsByEpochs = Eigen::MatrixXd;

/// Root mean square and quantiles of some values; NaN are left out.
struct Quantiles {
    double rms = std::numeric_limits<double>::quiet_NaN();
    double q05 = std::numeric_limits<double>::quiet_NaN();
    double median = std::numeric_limits<double>::quiet_NaN();
    double q95 = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] Quantiles quantiles_of(std::vector<double> values);

/// Over the runs, at each epoch.
[[nodiscard]] std::vector<Quantiles> quantiles_by_epoch(const RunsByEpochs& values);

/// NEES or NIS of blocks of `dof` states over runs that are independent of each other.
struct EnsembleConsistency {
    double mean = std::numeric_limits<double>::quiet_NaN();      ///< over runs and epochs
    double expected = std::numeric_limits<double>::quiet_NaN();  ///< dof
    double low95 = std::numeric_limits<double>::quiet_NaN();     ///< two-sided 95 % bounds of the mean
    double high95 = std::numeric_limits<double>::quiet_NaN();
    double inside = std::numeric_limits<double>::quiet_NaN();  ///< share of epochs whose mean over the runs is in its own bounds
    double worth = 0.0;                                        ///< independent epochs that a run is worth

    [[nodiscard]] bool in_band() const { return mean >= low95 && mean <= high95; }
};

/// Bounds of the mean of n independent chi-square values of `dof` degrees of freedom [BarShalom2001:5.4.2]. n need not be whole.
struct Bounds {
    double low95, high95;
};
[[nodiscard]] Bounds mean_bounds(double dof, double n);

/// Neighbouring epochs of a run are correlated: how many independent ones a run is worth follows from how the runs' own means
/// scatter (2 dof / worth is their variance), at least one and at most their number.
[[nodiscard]] EnsembleConsistency ensemble_consistency(const RunsByEpochs& values, double dof);

}  // namespace schuler::analysis
