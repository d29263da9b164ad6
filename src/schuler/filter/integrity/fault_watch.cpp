#include "schuler/filter/integrity/fault_watch.h"

#include "schuler/math/chi_square.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::filter {

ProtectionLimits::ProtectionLimits(const ProtectionSettings& s) {
    const auto two_sided = [](double p) { return std::sqrt(math::chi_square_quantile(1.0 - p, 1.0)); };
    const auto radial = [](double p) { return std::sqrt(-2.0 * std::log(p)); };
    test = two_sided(s.false_alarm);
    bias = two_sided(2.0 * s.missed_detection);  // on one side: the fault has a sign
    horizontal = radial(s.missed_detection);
    vertical = two_sided(s.missed_detection);
    horizontal_free = radial(s.fault_free);
    vertical_free = two_sided(s.fault_free);
}

void FaultWatch::begin(int source, Time now, Eigen::Index states) {
    // hypotheses of a source stand in the order of their starts; the next youngest of the two that are nearest in age goes
    std::vector<FaultHypothesis>& list = all;
    std::array<std::size_t, most_ages + 1> mine{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < list.size() && n <= most_ages; ++i)
        if (list[i].source == source) mine[n++] = i;
    if (n < most_ages) {
        list.push_back({});
        list.back().source = source;
        list.back().since = now;
        list.back().response = estim::StateVector::Zero(states);
        return;
    }
    const auto age = [&](std::size_t k) { return std::max(1e-3, (now - list[mine[k]].since).seconds()); };
    std::size_t superfluous = 1;
    for (std::size_t k = 2; k + 1 < n; ++k)
        if (age(k - 1) * age(superfluous + 1) < age(superfluous - 1) * age(k + 1)) superfluous = k;
    for (std::size_t k = superfluous; k + 1 < n; ++k) list[mine[k]] = list[mine[k + 1]];
    FaultHypothesis& youngest = list[mine[n - 1]];
    youngest = {};
    youngest.source = source;
    youngest.since = now;
    youngest.response = estim::StateVector::Zero(states);
}

void FaultWatch::forget(int source) {
    std::erase_if(all, [&](const FaultHypothesis& h) { return h.source == source; });
}

void FaultWatch::propagate(const estim::Transition& phi) {
    for (FaultHypothesis& h : all) h.response = phi.times(h.response);
}

void FaultWatch::follow(const estim::StateMatrix& P, const estim::Row& row, double innovation, double r, int used, int source) {
    if (all.empty()) return;
    estim::StateVector gain = row.times(P, used);
    const double s = row.dot(gain) + r;
    gain *= 1.0 / s;
    for (FaultHypothesis& h : all) {
        // computed minus measured: what is measured too long makes it smaller
        const double mean = row.dot(h.response) - (h.source == source ? 1.0 : 0.0);
        if (mean == 0.0) continue;
        h.response.head(used) -= mean * gain.head(used);
        h.information += mean * mean / s;
        h.evidence += mean * innovation / s;
    }
}

const FaultHypothesis* FaultWatch::found(double limit) const {
    const FaultHypothesis* worst = nullptr;
    double most = limit * limit;
    for (const FaultHypothesis& h : all) {
        if (!(h.evidence * h.evidence > most * h.information)) continue;
        most = h.evidence * h.evidence / h.information;
        worst = &h;
    }
    return worst;
}

ProtectionLevels FaultWatch::levels(const ProtectionLimits& limits, const Eigen::Matrix3d& P,
                                    const Eigen::Matrix<double, 3, 9>& T) const {
    const Eigen::Matrix2d level = P.topLeftCorner<2, 2>();
    const double horizontal = std::sqrt(level.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()),
                 vertical = std::sqrt(P(2, 2));
    double most_horizontal = 0.0, most_vertical = 0.0;
    for (const FaultHypothesis& h : all) {
        if (!(h.information > 0.0)) continue;
        const Eigen::Vector3d moved = T * h.response.head<9>();
        const double size = (limits.test + limits.bias) / std::sqrt(h.information);
        most_horizontal = std::max(most_horizontal, size * moved.head<2>().norm());
        most_vertical = std::max(most_vertical, size * std::abs(moved.z()));
    }
    return {std::max(limits.horizontal_free * horizontal, most_horizontal + limits.horizontal * horizontal),
            std::max(limits.vertical_free * vertical, most_vertical + limits.vertical * vertical)};
}

}  // namespace schuler::filter
