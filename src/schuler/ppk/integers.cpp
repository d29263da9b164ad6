#include "schuler/ppk/integers.h"

#include "schuler/math/chi_square.h"
#include "schuler/ppk/lambda.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace schuler::ppk {
namespace {

/// One double difference: state minus reference.
struct Pair {
    const WholeState *of, *reference;
    double wavelength;
};

std::vector<Pair> double_differences(std::span<const WholeState> whole) {
    std::map<int, const WholeState*> highest;
    for (const WholeState& w : whole) {
        const WholeState*& h = highest[w.group];
        if (h == nullptr || std::pair(!w.halves, w.elevation) > std::pair(!h->halves, h->elevation)) h = &w;
    }
    std::vector<Pair> pairs;
    for (const WholeState& w : whole)
        if (highest[w.group] != &w) pairs.push_back({&w, highest[w.group], std::min(w.wavelength, highest[w.group]->wavelength)});
    return pairs;
}

/// The largest squared distance between float and integers explained by chance.
double largest_distance(double false_alarm, Eigen::Index count) {
    return math::chi_square_quantile(1.0 - false_alarm, static_cast<double>(count));
}

/// Covariance of the double differences and their cross-covariance with the first states, in cycles.
struct Differenced {
    std::vector<Pair> pairs;
    Eigen::VectorXd a;  ///< minus the nearest integers
    Eigen::MatrixXd Q, C;
    Eigen::MatrixXd repeated;  ///< added to Q for the search
};

Differenced differenced(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole,
                        Eigen::Index states) {
    Differenced out;
    out.pairs = double_differences(whole);
    const auto n = static_cast<Eigen::Index>(out.pairs.size());
    out.a.resize(n);
    out.Q.resize(n, n);
    out.C.resize(states, n);
    out.repeated = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto [of, ref, wavelength] = out.pairs[static_cast<std::size_t>(i)];
        const double a = (x[of->state] - x[ref->state]) / wavelength;
        out.a[i] = a - std::round(a);
        out.C.col(i) = (P.col(of->state).head(states) - P.col(ref->state).head(states)) / wavelength;
        for (Eigen::Index j = 0; j <= i; ++j) {
            const auto [other, other_ref, other_wavelength] = out.pairs[static_cast<std::size_t>(j)];
            const double scale = 1.0 / (wavelength * other_wavelength);
            out.Q(i, j) = out.Q(j, i) = scale * (P(of->state, other->state) - P(of->state, other_ref->state) -
                                                 P(ref->state, other->state) + P(ref->state, other_ref->state));
            const double both = (ref == other_ref ? ref->repeated : 0.0) + (i == j ? of->repeated : 0.0);
            out.repeated(i, j) = out.repeated(j, i) = scale * both;
        }
    }
    return out;
}

IntegerTrial tried(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole, Eigen::Index states,
                   const IntegerSettings& settings) {
    IntegerTrial out;
    const Differenced d = differenced(x, P, whole, states);
    const Eigen::Index n = d.a.size();
    constexpr Eigen::Index least = 4;  // fewer give little information about three coordinates, and are rarely validated
    if (n < least) return out;
    const auto decorrelated = decorrelate(d.Q + d.repeated);
    if (!decorrelated) return out;
    const Eigen::Index count = count_with_success(*decorrelated, settings.success);
    out.success = success_rate(*decorrelated, std::max(count, least));
    if (count < least) return out;
    const Eigen::VectorXd z = decorrelated->Z.transpose() * d.a;
    const auto best = nearest_integers(*decorrelated, z, count, 2);
    if (best.size() < 2) return out;
    constexpr double exact = 1e-12;
    out.ratio = std::min(best[1].distance / std::max(best[0].distance, exact), 9999.9);
    if (out.ratio < settings.ratio || best[0].distance > largest_distance(settings.false_alarm, count)) return out;
    // conditioned on the integers with the filter's knowledge
    const Eigen::MatrixXd Z = decorrelated->Z.rightCols(count);
    const Eigen::LLT<Eigen::MatrixXd> root(Z.transpose() * d.Q * Z);
    if (root.info() != Eigen::Success) return out;
    const Eigen::MatrixXd cross = d.C * Z;
    const Eigen::MatrixXd whitened = root.matrixL().solve(cross.transpose());
    const Eigen::VectorXd miss = root.matrixL().solve(best[0].z - z.tail(count));
    IntegerFix& fix = out.fix.emplace();
    fix.correction = whitened.transpose() * miss;
    fix.covariance = P.topLeftCorner(states, states) - whitened.transpose() * whitened;
    fix.ratio = out.ratio;
    fix.success = out.success;
    fix.count = static_cast<int>(count);
    fix.ambiguities = static_cast<int>(n);
    for (const WholeState& w : whole) fix.states.push_back(w.state);
    return out;
}

/// Excluded ambiguities whose double difference with their group's reference is determined by the fix, and is not an integer.
void find_broken(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> all,
                 std::span<const WholeState> used, Eigen::Index, IntegerFix& fix, const IntegerSettings& settings) {
    for (const WholeState& w : all) {
        if (std::ranges::find(fix.states, w.state) != fix.states.end()) continue;
        std::vector<WholeState> with(used.begin(), used.end());
        with.push_back(w);
        const IntegerTrial together = tried(x, P, with, 1, settings);
        if (!together.fix && together.ratio > 0.0 && together.success >= settings.success) fix.broken.push_back(w.state);
    }
}

}  // namespace

IntegerTrial fix_integers(const Eigen::VectorXd& x, const Eigen::MatrixXd& P, std::span<const WholeState> whole,
                          Eigen::Index states, const IntegerSettings& settings) {
    std::vector<WholeState> all;
    std::ranges::copy_if(whole, std::back_inserter(all),
                         [&](const WholeState& w) { return w.elevation >= settings.elevation_mask; });
    IntegerTrial out = tried(x, P, all, states, settings);
    if (out.fix) return out;
    std::vector<WholeState> trusted;
    std::ranges::copy_if(all, std::back_inserter(trusted), [](const WholeState& w) { return w.trusted; });
    if (trusted.size() < all.size()) {
        IntegerTrial next = tried(x, P, trusted, states, settings);
        if (next.fix) {
            find_broken(x, P, all, trusted, states, *next.fix, settings);
            return next;
        }
    }
    // omitting one satellite after the other, the lowest first
    constexpr int more = 3;
    std::vector<WholeState> left = all;
    for (int i = 0; i < more; ++i) {
        std::set<gnss::SatelliteId> satellites;
        for (const WholeState& w : left) satellites.insert(w.id);
        constexpr std::size_t least = 6;
        if (satellites.size() < least) break;
        const gnss::SatelliteId lowest = std::ranges::min_element(left, {}, &WholeState::elevation)->id;
        std::erase_if(left, [&](const WholeState& w) { return w.id == lowest; });
        IntegerTrial next = tried(x, P, left, states, settings);
        if (next.fix) return next;
    }
    return out;
}

}  // namespace schuler::ppk
