#include "schuler/analysis/consistency.h"

#include "schuler/math/chi_square.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace schuler::analysis {

namespace {

double mean_of(std::span<const double> values) {
    double sum = 0.0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

/// Number of independent values equivalent to a correlated series.
double effective_number(std::span<const double> all) {
    // Correlation times are seconds and more: decimating a long series preserves the result and bounds the work.
    constexpr std::size_t enough = 20000;
    const std::size_t stride = (all.size() + enough - 1) / enough;
    std::vector<double> v;
    for (std::size_t i = 0; i < all.size(); i += stride) v.push_back(all[i]);
    const double mean = mean_of(v);
    for (double& x : v) x -= mean;
    const auto covariance = [&v](std::size_t lag) {
        double sum = 0.0;
        for (std::size_t i = 0; i + lag < v.size(); ++i) sum += v[i] * v[i + lag];
        return sum;
    };
    const double variance = covariance(0);
    if (!(variance > 0.0)) return 1.0;
    double inflation = -1.0;  // sum over lags of both signs = 2 * sum of pairs - 1
    for (std::size_t lag = 0; lag + 1 < v.size(); lag += 2) {
        const double pair = (covariance(lag) + covariance(lag + 1)) / variance;
        if (pair <= 0.0) break;
        inflation += 2.0 * pair;
    }
    const auto n = static_cast<double>(v.size());
    return std::clamp(n / std::max(inflation, 1e-3), 1.0, n);
}

/// Sums of x(i) x(i + lag). Some successive lags are summed at once, because the terms of one have to wait for each other; each is added
/// in the order of i, so that its sum does not depend on the others.
class LaggedSums {
public:
    explicit LaggedSums(std::span<const double> x) : x_(x) {}
    [[nodiscard]] double of(std::size_t lag) {
        if (lag < first_ || lag >= first_ + together || sums_.empty()) {
            first_ = lag;
            fill();
        }
        return sums_[lag - first_];
    }

private:
    static constexpr std::size_t together = 16;
    void fill() {
        sums_.assign(together, 0.0);
        std::array<double, together> sum{};
        const std::size_t n = x_.size(), most = first_ + together - 1, whole = n > most ? n - most : 0;
        const double *x = x_.data(), *later = x + first_;
        for (std::size_t i = 0; i < whole; ++i)
            for (std::size_t j = 0; j < together; ++j) sum[j] += x[i] * later[i + j];
        for (std::size_t j = 0; j < together; ++j) {
            for (std::size_t i = whole; i + first_ + j < n; ++i) sum[j] += x[i] * later[i + j];
            sums_[j] = sum[j];
        }
    }
    std::span<const double> x_;
    std::size_t first_ = 0;
    std::vector<double> sums_;
};

/// Sum over lags of both signs of the squared autocorrelation of a zero-mean series, each lag weighted by its fraction of pairs;
/// the window is the first that is `width` times as long as the sum over it [Sokal1997:3].
double squared_correlation_time(std::span<const double> x) {
    constexpr double width = 5.0;
    const auto n = static_cast<double>(x.size());
    LaggedSums sums(x);
    const auto covariance = [&](std::size_t lag) { return sums.of(lag) / (n - static_cast<double>(lag)); };
    const double variance = covariance(0);
    double weighted = n;
    for (std::size_t lag = 1; lag < x.size() && static_cast<double>(lag) < width * weighted / n; ++lag) {
        const double rho = covariance(lag) / variance;
        weighted += 2.0 * (n - static_cast<double>(lag)) * rho * rho;
    }
    return weighted / n;
}

/// Number of independent epochs equivalent to the epochs of a block for the mean of their NEES. For normal errors the covariance
/// of two NEES is twice the sum of the squared correlations of their components. Correlations are taken about zero, as stated by
/// a filter: about the mean of the run, nearly constant errors would appear independent.
double effective_epochs(const std::vector<Eigen::Vector3d>& all) {
    constexpr std::size_t enough = 5000;  // a longer series is decimated: correlation times are seconds and more
    const std::size_t stride = (all.size() + enough - 1) / enough;
    std::array<std::vector<double>, 3> axes;
    Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < all.size(); i += stride) {
        for (Eigen::Index a = 0; a < 3; ++a) axes[static_cast<std::size_t>(a)].push_back(all[i][a]);
        C += all[i] * all[i].transpose();
    }
    const auto n = static_cast<double>(axes[0].size());
    Eigen::Vector3d time = Eigen::Vector3d::Zero();
    double live = 0.0, sum = 0.0;
    for (Eigen::Index a = 0; a < 3; ++a) {
        if (!(C(a, a) > 0.0)) continue;
        ++live;
        time[a] = squared_correlation_time(axes[static_cast<std::size_t>(a)]);
        sum += time[a];
        for (Eigen::Index b = 0; b < a; ++b)
            if (C(b, b) > 0.0) sum += 2.0 * C(a, b) * C(a, b) / (C(a, a) * C(b, b)) * std::sqrt(time[a] * time[b]);
    }
    return live > 0.0 ? std::clamp(live * n / sum, 1.0 / 3.0, n) : 1.0;
}

void set_bounds(NeesStatistics& s) {
    const double whole = s.expected * s.effective_samples;
    s.low95 = math::chi_square_quantile(0.025, whole) / s.effective_samples;
    s.high95 = math::chi_square_quantile(0.975, whole) / s.effective_samples;
}

NeesStatistics block(std::span<const ErrorRow> rows, Time settled, const Eigen::Vector3d ErrorRow::*error,
                     const Eigen::Vector3d ErrorRow::*sigma) {
    std::vector<Eigen::Vector3d> standardised;
    NeesStatistics out;
    out.expected = 3.0;
    double sum = 0.0;
    for (const ErrorRow& row : rows) {
        const Eigen::Vector3d z = (row.*error).cwiseQuotient(row.*sigma);
        if (row.time < settled || !z.allFinite()) continue;
        standardised.push_back(z);
        sum += z.squaredNorm();
    }
    if (standardised.empty()) return out;
    out.mean = sum / static_cast<double>(standardised.size());
    out.effective_samples = effective_epochs(standardised);
    set_bounds(out);
    return out;
}

}  // namespace

double nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
    const Eigen::LLT<Eigen::Matrix3d> factor(covariance);
    if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
    return factor.matrixL().solve(error).squaredNorm();
}

NeesStatistics nees_statistics(std::span<const double> values, double dof) {
    std::vector<double> numbers;
    for (const double v : values) {
        if (std::isfinite(v)) numbers.push_back(v);
    }
    NeesStatistics out;
    out.expected = dof;
    if (numbers.empty()) return out;
    out.mean = mean_of(numbers);
    out.effective_samples = effective_number(numbers);
    set_bounds(out);
    return out;
}

ConsistencySummary consistency(std::span<const ErrorRow> rows, Time settled) {
    return {block(rows, settled, &ErrorRow::position, &ErrorRow::std_position),
            block(rows, settled, &ErrorRow::velocity, &ErrorRow::std_velocity),
            block(rows, settled, &ErrorRow::rpy, &ErrorRow::std_rpy)};
}

NisStatistics nis_statistics(std::span<const InnovationSample> samples) {
    NisStatistics out;
    std::vector<InnovationSample> kept;
    for (const InnovationSample& s : samples) {
        if (s.accepted) kept.push_back(s);
    }
    out.accepted = kept.size();
    out.rejected = samples.size() - kept.size();
    if (kept.empty()) return out;
    const auto n = static_cast<double>(kept.size());
    double nis = 0.0, dof = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const InnovationSample& s : kept) {
        nis += s.nis;
        dof += s.dof;
        mean += s.standardised / n;
    }
    out.mean = nis / n;
    out.dof = dof / n;
    double neighbours = 0.0, square = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const Eigen::Vector3d here = kept[i].standardised - mean;
        for (Eigen::Index axis = 0; axis < kept[i].dof; ++axis) {
            square += here[axis] * here[axis];
            const bool pair = i + 1 < kept.size() && axis < kept[i + 1].dof;
            if (pair) neighbours += here[axis] * (kept[i + 1].standardised[axis] - mean[axis]);
        }
    }
    if (square > 0.0) out.lag1 = neighbours / square;
    return out;
}

}  // namespace schuler::analysis
