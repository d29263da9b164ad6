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
    bias = two_sided(2.0 * s.missed_detection);  // one-sided: the fault has a sign
    horizontal = radial(s.missed_detection);
    vertical = two_sided(s.missed_detection);
    horizontal_free = radial(s.fault_free);
    vertical_free = two_sided(s.fault_free);
}

namespace {

/// Hypotheses of a source are in the order of their starts; of the two nearest in age the younger one is removed.
void begin_in(std::vector<FaultHypothesis>& list, int source, bool growing, Time now, Eigen::Index states) {
    constexpr std::size_t most = FaultWatch::most_ages;
    std::array<std::size_t, most + 1> mine{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < list.size() && n <= most; ++i)
        if (list[i].source == source) mine[n++] = i;
    if (n < most) {
        list.push_back({});
        mine[n++] = list.size() - 1;
    } else {
        const auto age = [&](std::size_t k) { return std::max(1e-3, (now - list[mine[k]].since).seconds()); };
        std::size_t superfluous = 1;
        for (std::size_t k = 2; k + 1 < n; ++k)
            if (age(k - 1) * age(superfluous + 1) < age(superfluous - 1) * age(k + 1)) superfluous = k;
        for (std::size_t k = superfluous; k + 1 < n; ++k) list[mine[k]] = list[mine[k + 1]];
    }
    FaultHypothesis& youngest = list[mine[n - 1]];
    youngest = {};
    youngest.source = source;
    youngest.growing = growing;
    youngest.since = now;
    youngest.response = estim::StateVector::Zero(states);
}

}  // namespace

void FaultWatch::reserve(std::size_t sources) {
    all.reserve(most_ages * sources);
    growing.reserve(most_ages * sources);
    without.reserve(std::min(sources, most_sources));
    left_out.reserve(sources);
}

void FaultWatch::begin(int source, Time now, Eigen::Index states) {
    begin_in(all, source, false, now, states);
    begin_in(growing, source, true, now, states);
    if (without.size() == most_sources || std::ranges::find(without, source, &WithoutSource::source) != without.end()) return;
    WithoutSource& w = without.emplace_back();
    w.source = source;
    w.since = now;
    w.offset = estim::StateVector::Zero(states);
    w.excess = estim::StateMatrix::Zero(states, states);
}

void FaultWatch::forget(int source) {
    const auto its = [&](const auto& h) { return h.source == source; };
    std::erase_if(all, its);
    std::erase_if(growing, its);
    std::erase_if(without, its);
    std::erase_if(left_out, its);
}

void FaultWatch::clear() {
    all.clear();
    growing.clear();
    without.clear();
}

bool FaultWatch::leaves_out(int source) const {
    return std::ranges::any_of(left_out, [&](const LeftOutSource& l) { return l.source == source && !l.on_probation(); });
}

void FaultWatch::propagate(const estim::Transition& phi, int used) {
    for (FaultHypothesis& h : all) h.response = phi.times(h.response);
    for (FaultHypothesis& h : growing) h.response = phi.times(h.response);
    for (WithoutSource& w : without) {
        w.offset = phi.times(w.offset);
        estim::propagate(w.excess, phi, used);
    }
}

void FaultWatch::renew(int state) {
    for (FaultHypothesis& h : all) h.response(state) = 0.0;
    for (FaultHypothesis& h : growing) h.response(state) = 0.0;
    for (WithoutSource& w : without) {
        w.offset(state) = 0.0;
        w.excess.row(state).setZero();
        w.excess.col(state).setZero();
    }
}

void FaultWatch::clone(int first, const std::array<estim::Row, 3>& rows, int used) {
    const auto combine = [&](estim::StateVector& x) {
        Eigen::Vector3d y;
        for (int k = 0; k < 3; ++k) y(k) = rows[static_cast<std::size_t>(k)].dot(x);
        x.segment<3>(first) = y;
    };
    for (FaultHypothesis& h : all) combine(h.response);
    for (FaultHypothesis& h : growing) combine(h.response);
    for (int k = 0; k < 3; ++k)
        for (WithoutSource& w : without) {
            w.excess.row(first + k).setZero();
            w.excess.col(first + k).setZero();
        }
    for (WithoutSource& w : without) {
        combine(w.offset);
        estim::clone(w.excess, rows, first, used);
    }
}

void FaultWatch::follow(const estim::StateMatrix& P, std::span<const WatchedScalar> scalars, Time now, int used) {
    if (all.empty()) return;
    estim::StateMatrix after = P;
    estim::StateVector dx = estim::StateVector::Zero(P.rows());
    for (const WatchedScalar& s : scalars) {
        follow_one(after, s, s.innovation - s.row->dot(dx), now, used);
        (void)estim::update(dx, after, *s.row, s.innovation, s.variance, used);
    }
    for (WithoutSource& w : without) {
        estim::StateMatrix Q = P + w.excess;
        estim::StateVector found = estim::StateVector::Zero(P.rows());
        for (const WatchedScalar& s : scalars)
            if (s.source != w.source)
                (void)estim::update(found, Q, *s.row, s.innovation + s.row->dot(w.offset), s.variance, used);
        w.score = 0.0;
        for (const WatchedScalar& s : scalars) {
            if (s.source != w.source) continue;
            const double z = s.innovation + s.row->dot(w.offset) - s.row->dot(found);
            w.score = std::max(w.score, z * z / (s.row->dot(s.row->times(Q, used)) + s.variance));
        }
        w.offset += dx - found;
        w.excess = Q - after;
        for (int k = 0; k < 6; ++k) {
            constexpr double rounding = 1e-6;  // fraction of the variance, because the excess is a difference of such
            if (w.excess(k, k) > rounding * Q(k, k)) w.score = std::max(w.score, w.offset(k) * w.offset(k) / w.excess(k, k));
        }
    }
}

void FaultWatch::follow_one(const estim::StateMatrix& P, const WatchedScalar& scalar, double innovation, Time now, int used) {
    const estim::Row& row = *scalar.row;
    estim::StateVector gain = row.times(P, used);
    const double s = row.dot(gain) + scalar.variance;
    gain *= 1.0 / s;
    const auto told = [&](FaultHypothesis& h, double wrong) {
        // computed minus measured: a measurement that is too long makes it smaller
        const double mean = row.dot(h.response) - (h.source == scalar.source ? wrong : 0.0);
        if (mean == 0.0) return;
        h.response.head(used) -= mean * gain.head(used);
        h.information += mean * mean / s;
        h.evidence += mean * innovation / s;
    };
    for (FaultHypothesis& h : all) told(h, scalar.is_rate ? 0.0 : 1.0);
    for (FaultHypothesis& h : growing) told(h, scalar.is_rate ? 1.0 : (now - h.since).seconds());
}

void FaultWatch::weigh() {
    for (const std::vector<FaultHypothesis>* list : {&all, &growing})
        for (const FaultHypothesis& h : *list) {
            if (!(h.information > 0.0)) continue;
            const auto w = std::ranges::find(without, h.source, &WithoutSource::source);
            if (w != without.end()) w->score = std::max(w->score, h.evidence * h.evidence / h.information);
        }
    double most = 0.0, sum = 0.0;
    for (const WithoutSource& w : without) most = std::max(most, w.score);
    for (WithoutSource& w : without) {
        const bool suspect = std::ranges::find(left_out, w.source, &LeftOutSource::source) != left_out.end();
        sum += w.weight = (suspect ? probation_odds : prior_odds) * std::exp(0.5 * (w.score - most));
    }
    for (WithoutSource& w : without) w.weight /= sum + std::exp(-0.5 * most);
}

const WithoutSource* FaultWatch::found(double limit) const {
    const auto worst = std::ranges::max_element(without, {}, &WithoutSource::score);
    if (worst == without.end() || !(worst->score > limit * limit)) return nullptr;
    const bool alone = std::ranges::all_of(
        without, [&](const WithoutSource& w) { return w.source == worst->source || w.score < worst->score - decided; });
    return alone ? &*worst : nullptr;
}

Eigen::Matrix<double, 9, 9> FaultWatch::undecided() const {
    Eigen::Matrix<double, 9, 9> out = Eigen::Matrix<double, 9, 9>::Zero();
    for (const WithoutSource& w : without) {
        const Eigen::Matrix<double, 9, 1> d = w.offset.head<9>();
        out += w.weight * (estim::as_double(w.excess.topLeftCorner<9, 9>()) + d * d.transpose());
    }
    return out;
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
