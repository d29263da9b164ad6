#include "schuler/fusion/fault_watch.h"

#include "schuler/fusion/range_update.h"
#include "schuler/math/chi_square.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::fusion {

ProtectionLimits::ProtectionLimits(const ProtectionSettings& s) {
    const auto two_sided = [](double p) { return std::sqrt(math::chi_square_quantile(1.0 - p, 1.0)); };
    const auto radial = [](double p) { return std::sqrt(-2.0 * std::log(p)); };
    test = two_sided(s.false_alarm);
    bias = two_sided(2.0 * s.missed_detection);   // on one side: the fault has a sign
    horizontal = radial(s.missed_detection);
    vertical = two_sided(s.missed_detection);
    horizontal_free = radial(s.fault_free);
    vertical_free = two_sided(s.fault_free);
}

template <int M, int N>
void FaultWatch<M, N>::begin(int source, Time now) {
    // hypotheses of a source stand in the order of their starts; the next youngest of the two that are nearest in age goes
    std::vector<FaultHypothesis<M>>& list = all;
    std::array<std::size_t, most_ages + 1> mine{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < list.size() && n <= most_ages; ++i)
        if (list[i].source == source) mine[n++] = i;
    if (n < most_ages) {
        list.push_back({});
        list.back().source = source;
        list.back().since = now;
        return;
    }
    const auto age = [&](std::size_t k) { return std::max(1e-3, (now - list[mine[k]].since).seconds()); };
    std::size_t superfluous = 1;
    for (std::size_t k = 2; k + 1 < n; ++k)
        if (age(k - 1) * age(superfluous + 1) < age(superfluous - 1) * age(k + 1)) superfluous = k;
    for (std::size_t k = superfluous; k + 1 < n; ++k) list[mine[k]] = list[mine[k + 1]];
    FaultHypothesis<M>& youngest = list[mine[n - 1]];
    youngest = {};
    youngest.source = source;
    youngest.since = now;
}

template <int M, int N>
void FaultWatch<M, N>::forget(int source) {
    std::erase_if(all, [&](const FaultHypothesis<M>& h) { return h.source == source; });
}

template <int M, int N>
void FaultWatch<M, N>::propagate(const estim::GatheredTransition<N>& gathered, const Vector& decay) {
    for (FaultHypothesis<M>& h : all) {
        h.response.template head<N>() = gathered.phi.times(h.response.template head<N>());
        h.response.template tail<M - N>().array() *= decay.template tail<M - N>().array();
    }
}

template <int M, int N>
template <int Most>
void FaultWatch<M, N>::follow(const Matrix& P, const estim::SparseRow<Most>& row, double innovation, double r, int used,
                              int source) {
    if (all.empty()) return;
    Vector gain = Vector::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(row.count); ++k)
        gain.head(used) += row.value[k] * P.col(row.index[k]).head(used);
    const double s = row.dot(gain) + r;
    gain *= 1.0 / s;
    for (FaultHypothesis<M>& h : all) {
        // computed minus measured: what is measured too long makes it smaller
        const double mean = row.dot(h.response) - (h.source == source ? 1.0 : 0.0);
        if (mean == 0.0) continue;
        h.response.head(used) -= mean * gain.head(used);
        h.information += mean * mean / s;
        h.evidence += mean * innovation / s;
    }
}

template <int M, int N>
const FaultHypothesis<M>* FaultWatch<M, N>::found(double limit) const {
    const FaultHypothesis<M>* worst = nullptr;
    double most = limit * limit;
    for (const FaultHypothesis<M>& h : all) {
        if (!(h.evidence * h.evidence > most * h.information)) continue;
        most = h.evidence * h.evidence / h.information;
        worst = &h;
    }
    return worst;
}

template <int M, int N>
ProtectionLevels FaultWatch<M, N>::levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                          const Eigen::Matrix<double, 3, 9>& T) const {
    const Eigen::Matrix2d level = P.topLeftCorner<2, 2>();
    const double horizontal = std::sqrt(level.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()),
                 vertical = std::sqrt(P(2, 2));
    double most_horizontal = 0.0, most_vertical = 0.0;
    for (const FaultHypothesis<M>& h : all) {
        if (!(h.information > 0.0)) continue;
        const Eigen::Vector3d moved = T * h.response.template head<9>();
        const double size = (limits.test + limits.bias) / std::sqrt(h.information);
        most_horizontal = std::max(most_horizontal, size * moved.head<2>().norm());
        most_vertical = std::max(most_vertical, size * std::abs(moved.z()));
    }
    return {std::max(limits.horizontal_free * horizontal, most_horizontal + limits.horizontal * horizontal),
            std::max(limits.vertical_free * vertical, most_vertical + limits.vertical * vertical)};
}

template struct FaultWatch<TightLayout::size, TightLayout::inertial>;
using TightWatch = FaultWatch<TightLayout::size, TightLayout::inertial>;
template void TightWatch::follow(const Matrix&, const estim::SparseRow<RangeScalar::most_entries>&, double, double, int, int);

}  // namespace schuler::fusion
