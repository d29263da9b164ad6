#include "schuler/analysis/ensemble.h"

#include "schuler/math/chi_square.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>

namespace schuler::analysis {

namespace {

struct Mean {
    double sum = 0.0, n = 0.0;
    void add(double x) {
        if (!std::isfinite(x)) return;
        sum += x;
        n += 1.0;
    }
    [[nodiscard]] double value() const { return sum / n; }
};

}  // namespace

Quantiles quantiles_of(std::vector<double> values) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    Quantiles out;
    if (values.empty()) return out;
    double square = 0.0;
    for (const double x : values) square += x * x;
    std::ranges::sort(values);
    out.rms = std::sqrt(square / static_cast<double>(values.size()));
    out.q05 = math::quantile_of_sorted(values, 0.05);
    out.median = math::quantile_of_sorted(values, 0.5);
    out.q95 = math::quantile_of_sorted(values, 0.95);
    return out;
}

std::vector<Quantiles> quantiles_by_epoch(const RunsByEpochs& values) {
    std::vector<Quantiles> out;
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
        out.push_back(quantiles_of({values.col(k).begin(), values.col(k).end()}));
    }
    return out;
}

Bounds mean_bounds(double dof, double n) {
    return {math::chi_square_quantile(0.025, dof * n) / n, math::chi_square_quantile(0.975, dof * n) / n};
}

EnsembleConsistency ensemble_consistency(const RunsByEpochs& values, double dof) {
    EnsembleConsistency out;
    out.expected = dof;
    std::vector<double> runs;  // their means
    Mean all, epochs;
    for (Eigen::Index r = 0; r < values.rows(); ++r) {
        Mean run;
        for (Eigen::Index k = 0; k < values.cols(); ++k) run.add(values(r, k));
        if (!(run.n > 0.0)) continue;
        runs.push_back(run.value());
        all.add(run.value());
        epochs.add(run.n);
    }
    if (runs.empty()) return out;
    out.mean = all.value();
    out.worth = 1.0;
    if (runs.size() > 2) {
        double scatter = 0.0;
        for (const double m : runs) scatter += (m - out.mean) * (m - out.mean) / static_cast<double>(runs.size() - 1);
        out.worth = std::clamp(2.0 * dof / scatter, 1.0, std::max(1.0, epochs.value()));
    }
    const Bounds whole = mean_bounds(dof, out.worth * all.n);
    out.low95 = whole.low95;
    out.high95 = whole.high95;

    Mean inside;
    for (Eigen::Index k = 0; k < values.cols(); ++k) {
        Mean epoch;
        for (Eigen::Index r = 0; r < values.rows(); ++r) epoch.add(values(r, k));
        if (!(epoch.n > 0.0)) continue;
        const Bounds b = mean_bounds(dof, epoch.n);
        inside.add(epoch.value() >= b.low95 && epoch.value() <= b.high95 ? 1.0 : 0.0);
    }
    out.inside = inside.value();
    return out;
}

}  // namespace schuler::analysis
