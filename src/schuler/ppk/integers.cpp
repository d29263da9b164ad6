#include "schuler/ppk/integers.h"

#include "schuler/math/chi_square.h"
#include "schuler/ppk/lambda.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace schuler::ppk {
namespace {

/// One double difference: state less reference.
struct Pair {
    const WholeState *of, *reference;
};

std::vector<Pair> double_differences(std::span<const WholeState> whole) {
    std::map<int, const WholeState*> highest;
    for (const WholeState& w : whole) {
        const WholeState*& h = highest[w.group];
        if (h == nullptr || w.elevation > h->elevation) h = &w;
    }
    std::vector<Pair> pairs;
    for (const WholeState& w : whole)
        if (highest[w.group] != &w) pairs.push_back({&w, highest[w.group]});
    return pairs;
}

/// The largest squared distance between float and integers that chance explains.
double largest_distance(double false_alarm, Eigen::Index count) {
    return math::chi_square_quantile(1.0 - false_alarm, static_cast<double>(count));
}

IntegerTrial tried(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole, Eigen::Index states,
                   const IntegerSettings& settings) {
    IntegerTrial out;
    const std::vector<Pair> pairs = double_differences(whole);
    const auto n = static_cast<Eigen::Index>(pairs.size());
    constexpr Eigen::Index least = 4;   // fewer say little of three coordinates, and rarely prove themselves
    if (n < least) return out;
    Eigen::VectorXd a(n);
    Eigen::MatrixXd Q(n, n), C(states, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto [of, ref] = pairs[static_cast<std::size_t>(i)];
        a[i] = (x[of->state] - x[ref->state]) / of->wavelength;
        a[i] -= std::round(a[i]);
        C.col(i) = (P.col(of->state).head(states) - P.col(ref->state).head(states)) / of->wavelength;
        for (Eigen::Index j = 0; j <= i; ++j) {
            const auto [other, other_ref] = pairs[static_cast<std::size_t>(j)];
            Q(i, j) = Q(j, i) = (P(of->state, other->state) - P(of->state, other_ref->state) - P(ref->state, other->state) +
                                 P(ref->state, other_ref->state)) /
                                (of->wavelength * other->wavelength);
        }
    }
    const auto decorrelated = decorrelate(Q);
    if (!decorrelated) return out;
    const Eigen::Index count = count_with_success(*decorrelated, settings.success);
    out.success = success_rate(*decorrelated, std::max(count, least));
    if (count < least) return out;
    const Eigen::VectorXd z = decorrelated->Z.transpose() * a;
    const auto best = nearest_integers(*decorrelated, z, count, 2);
    if (best.size() < 2) return out;
    constexpr double exact = 1e-12;
    out.ratio = std::min(best[1].distance / std::max(best[0].distance, exact), 9999.9);
    if (out.ratio < settings.ratio || best[0].distance > largest_distance(settings.false_alarm, count)) return out;
    // conditioned on the integers: Q = L' D L
    const auto L = decorrelated->L.bottomRightCorner(count, count);
    const Eigen::VectorXd scale = decorrelated->d.tail(count).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd cross = (C * decorrelated->Z.rightCols(count)).transpose();
    const Eigen::MatrixXd whitened = scale.asDiagonal() * L.transpose().triangularView<Eigen::UnitUpper>().solve(cross);
    const Eigen::VectorXd miss = best[0].z - z.tail(count);
    const Eigen::VectorXd whitened_miss = scale.asDiagonal() * L.transpose().triangularView<Eigen::UnitUpper>().solve(miss);
    IntegerFix& fix = out.fix.emplace();
    fix.correction = whitened.transpose() * whitened_miss;
    fix.covariance = P.topLeftCorner(states, states) - whitened.transpose() * whitened;
    fix.ratio = out.ratio;
    fix.success = out.success;
    fix.count = static_cast<int>(count);
    fix.ambiguities = static_cast<int>(n);
    return out;
}

}  // namespace

IntegerTrial fix_integers(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole, Eigen::Index states,
                          const IntegerSettings& settings) {
    std::vector<WholeState> left;
    std::ranges::copy_if(whole, std::back_inserter(left), [&](const WholeState& w) { return w.elevation >= settings.elevation_mask; });
    IntegerTrial out = tried(x, P, left, states, settings);
    constexpr int more = 3;
    for (int i = 0; i < more && !out.fix; ++i) {
        std::set<SatelliteId> satellites;
        for (const WholeState& w : left) satellites.insert(w.id);
        constexpr std::size_t least = 6;
        if (satellites.size() < least) break;
        const SatelliteId lowest = std::ranges::min_element(left, {}, &WholeState::elevation)->id;
        std::erase_if(left, [&](const WholeState& w) { return w.id == lowest; });
        IntegerTrial next = tried(x, P, left, states, settings);
        if (next.fix) out = std::move(next);
    }
    return out;
}

}  // namespace schuler::ppk
