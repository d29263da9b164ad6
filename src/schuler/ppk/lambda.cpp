#include "schuler/ppk/lambda.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::ppk {
namespace {

/// Q = L' diag(d) L starting with the last row [DeJongeTiberius1996:3.3]. False if Q is not positive definite.
bool factor(Eigen::MatrixXd q, Eigen::MatrixXd& L, Eigen::VectorXd& d) {
    const Eigen::Index n = q.rows();
    L = Eigen::MatrixXd::Identity(n, n);
    d.resize(n);
    for (Eigen::Index i = n - 1; i >= 0; --i) {
        d[i] = q(i, i);
        if (!(d[i] > 0.0) || !std::isfinite(d[i])) return false;
        L.row(i).head(i) = q.row(i).head(i) / d[i];
        for (Eigen::Index j = 0; j < i; ++j) q.row(j).head(j + 1) -= d[i] * L(i, j) * L.row(i).head(j + 1);
    }
    return true;
}

/// Subtracts the integer part of L(i, j), so that at most one half remains.
void subtract_whole(Decorrelation& out, Eigen::Index i, Eigen::Index j) {
    const double whole = std::round(out.L(i, j));
    if (whole == 0.0) return;
    const Eigen::Index below = out.size() - i;
    out.L.col(j).tail(below) -= whole * out.L.col(i).tail(below);
    out.Z.col(j) -= whole * out.Z.col(i);
}

/// Exchanges ambiguities j and j + 1; `variance` is the new one of j + 1.
void exchange(Decorrelation& out, Eigen::Index j, double variance) {
    Eigen::MatrixXd& L = out.L;
    Eigen::VectorXd& d = out.d;
    const double l = L(j + 1, j), eta = d[j] / variance, lambda = d[j + 1] * l / variance;
    d[j] = eta * d[j + 1];
    d[j + 1] = variance;
    for (Eigen::Index k = 0; k < j; ++k) {
        const double upper = L(j, k), lower = L(j + 1, k);
        L(j, k) = lower - l * upper;
        L(j + 1, k) = eta * upper + lambda * lower;
    }
    L(j + 1, j) = lambda;
    const Eigen::Index below = out.size() - j - 2;
    L.col(j).tail(below).swap(L.col(j + 1).tail(below));
    out.Z.col(j).swap(out.Z.col(j + 1));
}

/// Integers in order of distance from a real number: nearest first, then alternating sides.
struct Zigzag {
    double z = 0, step = 0;
    void start(double real) {
        z = std::round(real);
        step = real < z ? -1.0 : 1.0;
    }
    void next() {
        z += step;
        step = -step - (step > 0.0 ? 1.0 : -1.0);
    }
};

}  // namespace

Eigen::VectorXd Decorrelation::back(const Eigen::VectorXd& z) const {
    const Eigen::VectorXd a = Z.transpose().partialPivLu().solve(z);
    return a;
}

std::optional<Decorrelation> decorrelate(const Eigen::MatrixXd& covariance) {
    Decorrelation out;
    if (!factor(covariance, out.L, out.d)) return std::nullopt;
    const Eigen::Index n = out.size();
    out.Z = Eigen::MatrixXd::Identity(n, n);
    // from the bottom up: columns below j are already reduced
    Eigen::Index j = n - 2, reduced = n - 2;
    while (j >= 0) {
        if (j <= reduced)
            for (Eigen::Index i = j + 1; i < n; ++i) subtract_whole(out, i, j);
        const double l = out.L(j + 1, j), variance = out.d[j] + l * l * out.d[j + 1];
        constexpr double worth = 1.0 - 1e-9;  // a smaller gain is rounding, and might not terminate
        if (variance < worth * out.d[j + 1]) {
            exchange(out, j, variance);
            reduced = j;
            j = n - 2;
        } else {
            --j;
        }
    }
    return out;
}

double success_rate(const Decorrelation& decorrelation, Eigen::Index count) {
    double product = 1.0;
    for (Eigen::Index k = decorrelation.size() - count; k < decorrelation.size(); ++k)
        product *= std::erf(0.5 / std::sqrt(2.0 * decorrelation.d[k]));  // 2 Phi(1 / (2 sigma)) - 1
    return product;
}

Eigen::Index count_with_success(const Decorrelation& decorrelation, double least) {
    double product = 1.0;
    for (Eigen::Index k = decorrelation.size() - 1; k >= 0; --k) {
        product *= std::erf(0.5 / std::sqrt(2.0 * decorrelation.d[k]));
        if (product < least) return decorrelation.size() - 1 - k;
    }
    return decorrelation.size();
}

std::vector<IntegerCandidate> nearest_integers(const Decorrelation& decorrelation, const Eigen::VectorXd& z, Eigen::Index count,
                                               std::size_t wanted, std::size_t most_nodes) {
    const Eigen::Index n = count, first = decorrelation.size() - count;
    std::vector<IntegerCandidate> best;
    if (n == 0 || wanted == 0) return best;
    const auto L = decorrelation.L.bottomRightCorner(n, n);
    const auto d = decorrelation.d.tail(n);
    const auto real = z.tail(z.size() - first);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(n, n);  // row k: shift of the real values by the integers above k
    Eigen::VectorXd conditioned(n), distance = Eigen::VectorXd::Zero(n + 1), integers(n);
    std::vector<Zigzag> at(static_cast<std::size_t>(n));
    const auto zigzag = [&](Eigen::Index k) -> Zigzag& { return at[static_cast<std::size_t>(k)]; };
    const auto enter = [&](Eigen::Index k) {
        conditioned[k] = real[k] + (k + 1 < n ? sums(k, k) : 0.0);
        zigzag(k).start(conditioned[k]);
    };
    double limit = std::numeric_limits<double>::infinity();
    Eigen::Index k = n - 1;
    enter(k);
    for (std::size_t nodes = 0;; ++nodes) {
        if (nodes > most_nodes) return {};
        const double miss = conditioned[k] - zigzag(k).z, here = distance[k + 1] + miss * miss / d[k];
        if (here < limit) {
            if (k > 0) {
                distance[k] = here;
                sums.row(k - 1).head(k) = sums.row(k).head(k) + (zigzag(k).z - conditioned[k]) * L.row(k).head(k);
                enter(--k);
                continue;
            }
            for (Eigen::Index i = 0; i < n; ++i) integers[i] = zigzag(i).z;
            const auto place = std::ranges::upper_bound(best, here, {}, &IntegerCandidate::distance);
            best.insert(place, {integers, here});
            if (best.size() > wanted) best.pop_back();
            if (best.size() == wanted) limit = best.back().distance;
            zigzag(0).next();
        } else {
            if (k == n - 1) return best;
            zigzag(++k).next();
        }
    }
}

}  // namespace schuler::ppk
