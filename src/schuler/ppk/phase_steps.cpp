#include "schuler/ppk/phase_steps.h"

#include "schuler/math/quantile.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace schuler::ppk {
namespace {

/// Weighted least squares of displacement and clock step.
struct Normal {
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    DisplacementAndClock right = DisplacementAndClock::Zero();

    void add(const PhaseStep& s, double value, double weight) {
        DisplacementAndClock row;
        row << s.towards, 1.0;
        information += weight * row * row.transpose();
        right += weight * value * row;
    }
    [[nodiscard]] std::optional<DisplacementAndClock> solution() const {
        const Eigen::LDLT<Eigen::Matrix4d> factor(information);
        if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-9 * factor.vectorD().maxCoeff()))
            return std::nullopt;
        const DisplacementAndClock x = factor.solve(right);
        if (!x.allFinite()) return std::nullopt;
        return x;
    }
};

/// Steps within their tolerance of a displacement and clock step.
struct Agreement {
    std::vector<char> inside;
    std::size_t satellites = 0;
    double left = 0;  ///< m, sum of the absolute residuals inside

    [[nodiscard]] bool better_than(const Agreement& o) const {
        return satellites != o.satellites ? satellites > o.satellites : left < o.left;
    }
    [[nodiscard]] bool contradicts(const Agreement& o) const {
        for (std::size_t i = 0; i < inside.size(); ++i)
            if (inside[i] != 0 && o.inside[i] == 0) return true;
        return false;
    }
};

Agreement agreement_with(const std::vector<PhaseStep>& steps, const DisplacementAndClock& x) {
    Agreement a;
    a.inside.resize(steps.size());
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double r = std::abs(residual(steps[i], x));
        if (!(r <= steps[i].tolerance)) continue;
        a.inside[i] = 1;
        a.left += r;
        a.satellites += last != steps[i].satellite ? 1 : 0;
        last = steps[i].satellite;
    }
    return a;
}

/// The set about the solution of four satellites, by least squares over it until it does not change.
std::optional<Agreement> agreement_of_four(const std::vector<PhaseStep>& steps, const std::array<std::size_t, 4>& four) {
    Eigen::Matrix4d rows;
    DisplacementAndClock grown;
    for (Eigen::Index k = 0; k < 4; ++k) {
        const PhaseStep& s = steps[four[static_cast<std::size_t>(k)]];
        rows.row(k) << s.towards.transpose(), 1.0;
        grown[k] = s.grown;
    }
    const Eigen::PartialPivLU<Eigen::Matrix4d> factor(rows);
    if (!(std::abs(factor.determinant()) > 1e-2))
        return std::nullopt;  // a geometry that would spread the noise of the four too far
    Agreement a = agreement_with(steps, factor.solve(grown));
    for (int i = 0; i < 3; ++i) {
        Normal normal;
        for (std::size_t k = 0; k < steps.size(); ++k)
            if (a.inside[k] != 0) normal.add(steps[k], steps[k].grown, 1.0 / (steps[k].sigma * steps[k].sigma));
        const auto x = normal.solution();
        if (!x) break;
        Agreement next = agreement_with(steps, *x);
        if (!next.better_than(a)) break;
        a = std::move(next);
    }
    return a;
}

/// Calls with sets of four of `n`: with all of them, or with `most` drawn from them, the same in every run.
template <class Call>
void for_fours(std::size_t n, std::size_t most, Call call) {
    if (n * (n - 1) * (n - 2) * (n - 3) / 24 <= most) {
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = a + 1; b < n; ++b)
                for (std::size_t c = b + 1; c < n; ++c)
                    for (std::size_t d = c + 1; d < n; ++d) call(std::array{a, b, c, d});
        return;
    }
    std::uint64_t draw = 1;
    for (std::size_t i = 0; i < most; ++i) {
        std::array<std::size_t, 4> four{};
        for (std::size_t k = 0; k < 4;) {
            draw = draw * 6364136223846793005ULL + 1442695040888963407ULL;
            four[k] = static_cast<std::size_t>(draw >> 33U) % n;
            const auto drawn = four.begin() + static_cast<std::ptrdiff_t>(k);
            if (std::find(four.begin(), drawn, *drawn) == drawn) ++k;
        }
        call(four);
    }
}

/// Displacement and clock step with the least absolute residuals.
std::optional<DisplacementAndClock> robust_step(const std::vector<PhaseStep>& steps) {
    DisplacementAndClock x = DisplacementAndClock::Zero();
    for (int i = 0; i < 12; ++i) {
        Normal normal;
        for (const PhaseStep& s : steps)
            normal.add(s, s.grown, 1.0 / (s.sigma * (i == 0 ? s.sigma : std::max(s.sigma, std::abs(residual(s, x))))));
        const auto next = normal.solution();
        if (!next) return std::nullopt;
        const bool settled = i > 0 && (*next - x).norm() < 1e-4;
        x = *next;
        if (settled) break;
    }
    return x;
}

/// Root mean square of the residuals of a fit to all steps, relative to their sigmas.
std::optional<double> relative_noise(const std::vector<PhaseStep>& steps) {
    Normal normal;
    for (const PhaseStep& s : steps) normal.add(s, s.grown, 1.0 / (s.sigma * s.sigma));
    const auto x = normal.solution();
    if (!x || steps.size() < 6) return std::nullopt;
    double square = 0;
    for (const PhaseStep& s : steps) square += std::pow(residual(s, *x) / s.sigma, 2);
    return std::sqrt(square / static_cast<double>(steps.size() - 4));
}

}  // namespace

void UsualSize::learn(double value) {
    constexpr std::size_t most = 100;
    if (last_.size() < most) last_.push_back(value);
    else last_[next_++ % most] = value;
}

double UsualSize::quantile(double p) const { return math::quantile(last_, p); }

std::optional<DopplerDifference> doppler_difference(const std::vector<PhaseStep>& steps, const std::vector<char>& which) {
    Normal normal;
    std::size_t satellites = 0;
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        if (which[i] == 0 || !std::isfinite(steps[i].by_doppler)) continue;
        normal.add(steps[i], steps[i].by_doppler, 1.0);
        satellites += last != steps[i].satellite ? 1 : 0;
        last = steps[i].satellite;
    }
    if (constexpr std::size_t enough = 4; satellites < enough) return std::nullopt;
    const auto x = normal.solution();
    if (!x) return std::nullopt;
    return DopplerDifference{x->head<3>().norm(), std::sqrt(normal.information.inverse().topLeftCorner<3, 3>().trace())};
}

std::optional<bool> PhaseContinuity::usual(const DopplerDifference& d) const {
    if (!dopplers_.known()) return std::nullopt;
    return d.size <= 2.0 * dopplers_.quantile(0.9) * d.dilution;
}

/// Larger than the Dopplers' noise and any acceleration of a vehicle explain.
bool PhaseContinuity::impossible(const DopplerDifference& d, double dt) const {
    if (usual(d) != false) return false;
    constexpr double acceleration = 20.0;  // m/s^2, change within the interval: its mean Doppler misses up to an eighth of it
    constexpr double least = 0.1;          // m: half a cycle of L1
    return d.size > least && d.size > 6.0 * dopplers_.quantile(0.5) * d.dilution + acceleration * dt * dt / 8.0;
}

std::optional<std::vector<char>> PhaseContinuity::kept(const std::vector<PhaseStep>& steps, double dt) {
    const auto x = robust_step(steps);
    if (!x) return std::nullopt;
    std::vector<char> inside = agreement_with(steps, *x).inside;
    const bool undisturbed = std::ranges::find(inside, 0) == inside.end();
    if (!undisturbed) {
        // the narrower the bounds, the fewer agree by chance
        std::vector<PhaseStep> bounded = steps;
        if (noise_.known())
            for (PhaseStep& s : bounded) s.tolerance = std::min(s.tolerance, 6.0 * std::max(1.0, noise_.quantile(0.9)) * s.sigma);
        auto found = all_but_one(bounded);
        if (!found) found = largest_agreement(bounded);
        inside = found.value_or(std::vector<char>(steps.size()));
    }
    const auto difference = doppler_difference(steps, inside);
    if (difference && impossible(*difference, dt)) inside.assign(steps.size(), 0);
    if (undisturbed) {
        if (difference) dopplers_.learn(difference->size / difference->dilution);
        if (const auto noise = relative_noise(steps)) noise_.learn(*noise);
    }
    return inside;
}

/// All satellites but one, if the Dopplers do not contradict it; without each one that is about as likely as the likeliest.
std::optional<std::vector<char>> PhaseContinuity::all_but_one(const std::vector<PhaseStep>& steps) const {
    const double noise = noise_.known() ? std::max(1.0, noise_.quantile(0.9)) : 0.0;
    struct Candidate {
        std::size_t first, end;
        double square;
    };
    std::vector<Candidate> candidates;
    for (std::size_t first = 0, end = 0; first < steps.size(); first = end) {
        Normal normal;
        std::vector<char> others(steps.size(), 1);
        for (end = first; end < steps.size() && steps[end].satellite == steps[first].satellite; ++end) others[end] = 0;
        for (std::size_t i = 0; i < steps.size(); ++i)
            if (others[i] != 0) normal.add(steps[i], steps[i].grown, 1.0 / (steps[i].sigma * steps[i].sigma));
        const auto x = normal.solution();
        if (!x) continue;
        double square = 0;
        for (std::size_t i = 0; i < steps.size(); ++i) {
            if (others[i] == 0) continue;
            const double r = residual(steps[i], *x);
            if (!(std::abs(r) <= steps[i].tolerance)) square = std::numeric_limits<double>::infinity();
            square += std::pow(r / (noise > 0.0 ? noise * steps[i].sigma : steps[i].tolerance / 4.0), 2);
        }
        const auto difference = doppler_difference(steps, others);
        if (std::isfinite(square) && !(difference && usual(*difference) == false)) candidates.push_back({first, end, square});
    }
    if (candidates.empty()) return std::nullopt;
    const double least = std::ranges::min(candidates, {}, &Candidate::square).square;
    constexpr double unlikely = 14.0;  // twice the logarithm of a thousand
    std::vector<char> inside(steps.size(), 1);
    for (const Candidate& c : candidates)
        for (std::size_t i = c.first; i < c.end && c.square < least + unlikely; ++i) inside[i] = 0;
    return inside;
}

/// Nothing where the largest set cannot be told from others.
std::optional<std::vector<char>> PhaseContinuity::largest_agreement(const std::vector<PhaseStep>& steps) const {
    std::vector<std::size_t> firsts;  // of each satellite
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (i == 0 || steps[i].satellite != steps[i - 1].satellite) firsts.push_back(i);
    constexpr std::size_t enough = 6;
    if (firsts.size() < enough) return std::nullopt;

    constexpr std::size_t most_fours = 500;
    constexpr std::size_t clear = 3;  // satellites by which a set has to be larger: those four were chosen to agree
    std::vector<Agreement> found;
    std::size_t largest = 0;
    for_fours(firsts.size(), most_fours, [&](const std::array<std::size_t, 4>& four) {
        auto a = agreement_of_four(steps, {firsts[four[0]], firsts[four[1]], firsts[four[2]], firsts[four[3]]});
        if (!a || a->satellites + clear <= largest) return;
        largest = std::max(largest, a->satellites);
        if (std::ranges::none_of(found, [&](const Agreement& f) { return f.inside == a->inside; }))
            found.push_back(std::move(*a));
    });
    if (largest < enough) return std::nullopt;
    const auto first = std::ranges::max_element(found, [](const Agreement& a, const Agreement& b) { return b.better_than(a); });
    const Agreement best = std::move(*first);
    std::vector<Agreement> rivals;
    for (Agreement& a : found)
        if (&a != &*first && a.satellites + clear > largest && a.contradicts(best)) rivals.push_back(std::move(a));
    if (rivals.empty()) return best.inside;

    // the Dopplers decide where they are known well enough to refute the others
    const auto is_usual = [&](const Agreement& a) -> std::optional<bool> {
        const auto difference = doppler_difference(steps, a.inside);
        return difference ? usual(*difference) : std::nullopt;
    };
    if (is_usual(best) != true || std::ranges::any_of(rivals, [&](const Agreement& a) { return is_usual(a) != false; }))
        return std::nullopt;
    return best.inside;
}

}  // namespace schuler::ppk
