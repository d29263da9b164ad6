#include "schuler/analysis/allan.h"

#include "schuler/core/error.h"

#include <Eigen/QR>

#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::analysis {

AllanDeviation::AllanDeviation(double dt) : dt_(dt), levels_(1) {
    if (!(dt > 0.0)) throw input_error("the samples of an Allan deviation have no interval", {}, "give a positive one");
}

void AllanDeviation::add(double rate) {
    if (levels_.front().count == 0) offset_ = rate;
    add(0, rate - offset_);
}

void AllanDeviation::add(std::size_t at, double mean) {
    Level& level = levels_[at];
    const auto before = [&](std::size_t n) { return level.last[(level.count - n) % level.last.size()]; };
    for (std::size_t m = 1; m <= longest; ++m) {
        double &newer = level.newer[m - 1], &older = level.older[m - 1];
        newer += mean;
        if (level.count >= m) {
            newer -= before(m);
            older += before(m);
        }
        if (level.count >= 2 * m) older -= before(2 * m);
        if (level.count + 1 < 2 * m) continue;
        const double difference = (newer - older) / static_cast<double>(m);
        level.squares[m - 1] += difference * difference;
        ++level.differences[m - 1];
    }
    level.last[level.count % level.last.size()] = mean;
    if (++level.count % 2 == 1) {
        level.half = mean;
        return;
    }
    const double pair = 0.5 * (level.half + mean);
    if (at + 1 == levels_.size()) levels_.emplace_back();  // may reallocate `level`
    add(at + 1, pair);
}

std::vector<AllanPoint> AllanDeviation::points() const {
    constexpr double least_clusters = 9.0;
    const auto samples = static_cast<double>(levels_.front().count);
    std::vector<AllanPoint> out;
    for (std::size_t at = 0; at < levels_.size(); ++at) {
        for (std::size_t m = at == 0 ? 1 : 4; m <= longest; ++m) {
            const double length = std::ldexp(static_cast<double>(m), static_cast<int>(at)), clusters = samples / length;
            if (clusters < least_clusters) return out;
            const double n = static_cast<double>(levels_[at].differences[m - 1]);
            out.push_back(
                {length * dt_, std::sqrt(0.5 * levels_[at].squares[m - 1] / n), 1.0 / std::sqrt(2.0 * (clusters - 1.0))});
        }
    }
    return out;
}

AllanCoefficients fitted(const std::vector<AllanPoint>& points) {
    using Columns = Eigen::Matrix<double, Eigen::Dynamic, 5>;
    const auto n = static_cast<Eigen::Index>(points.size());
    Columns terms(n, 5);
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const AllanPoint& p = points[static_cast<std::size_t>(i)];
        const double variance = p.deviation * p.deviation;
        if (!(variance > 0.0)) {
            terms.row(i).setZero();
            continue;
        }
        // relative to the point: relative errors of the variance are twice those of the deviation
        const double weight = 1.0 / (2.0 * p.relative_sigma * variance), t = p.tau;
        terms.row(i) << 3.0 / (t * t), 1.0 / t, 2.0 * std::numbers::ln2 / std::numbers::pi, t / 3.0, 0.5 * t * t;
        terms.row(i) *= weight;
        wanted(i) = weight * variance;
    }
    // Five unknowns: the best non-negative fit is the best over all subsets with a non-negative solution.
    Eigen::Matrix<double, 5, 1> best = Eigen::Matrix<double, 5, 1>::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (unsigned subset = 1; subset < 32 && n > 0; ++subset) {
        std::vector<Eigen::Index> chosen;
        for (Eigen::Index c = 0; c < 5; ++c)
            if ((subset >> c & 1u) != 0) chosen.push_back(c);
        if (static_cast<Eigen::Index>(chosen.size()) > n) continue;
        const Eigen::MatrixXd some = terms(Eigen::all, chosen);
        // the columns differ by many orders of magnitude
        const Eigen::VectorXd scale = some.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
        const Eigen::VectorXd x =
            (some * scale.cwiseInverse().asDiagonal()).colPivHouseholderQr().solve(wanted).cwiseQuotient(scale);
        const double cost = (some * x - wanted).squaredNorm();
        if (!x.allFinite() || (x.array() < 0.0).any() || cost >= least) continue;
        least = cost;
        best.setZero();
        best(chosen) = x;
    }
    const auto root = [&](int i) { return std::sqrt(best(i)); };
    return {root(0), root(1), root(2), root(3), root(4)};
}

}  // namespace schuler::analysis
