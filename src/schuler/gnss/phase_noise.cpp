#include "schuler/gnss/phase_noise.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/detail/least_squares.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace schuler::gnss {
namespace {

constexpr double rounding = 1e-6;  // s, of the epochs' times

/// Growth of a satellite's range beyond its own motion, m, and its sigma relative to that at the zenith.
struct Change {
    Eigen::Vector3d line_of_sight;
    double grown, factor;
};

std::vector<Change> changes_between(const RangingLog& log, const RangeEpoch& before, const RangeEpoch& now, const Ecef& receiver,
                                    const RangeSettings& settings) {
    const Geodetic place = earth::geodetic_from_ecef(earth::wgs84, receiver);
    const std::vector<Range> begin = satellite_ranges(log, before), end = satellite_ranges(log, now);
    std::vector<Change> out;
    for (const RangeSample& m : log.of(now)) {
        if (!(std::abs((now.time - before.time).seconds() - m.phase_span) < rounding)) continue;
        const auto satellite = satellite_from(log.sources[m.source].name);
        const auto of_it = [&](const Range& r) { return r.satellite == satellite; };
        const auto first = std::ranges::find_if(begin, of_it), last = std::ranges::find_if(end, of_it);
        if (first == begin.end() || last == end.end()) continue;
        const ModelledRange here = model_range(*last, receiver, place, nullptr, settings),
                            there = model_range(*first, receiver, place, nullptr, settings);
        out.push_back({here.line_of_sight, last->range_rate * m.phase_span - (here.range - there.range),
                       noise_factor(here.direction.elevation, m.cn0)});
    }
    return out;
}

/// Variance at the zenith that a least-squares fit of displacement and clock leaves, m^2, less what the median of a chi-square
/// variable over its degrees of freedom is below one (Wilson and Hilferty's approximation).
std::optional<double> variance_left(const std::vector<Change>& changes) {
    detail::NormalEquations normal;
    for (const Change& c : changes) normal.add(c.line_of_sight, 0, c.grown, 1.0 / (c.factor * c.factor));
    const auto x = normal.solve();
    if (!x) return std::nullopt;
    double sum = 0.0;
    for (const Change& c : changes) sum += std::pow((c.grown - c.line_of_sight.dot(x->head<3>()) - (*x)[3]) / c.factor, 2);
    const double dof = static_cast<double>(changes.size()) - 4.0;
    return sum / dof / std::pow(1.0 - 2.0 / (9.0 * dof), 3);
}

}  // namespace

double phase_change_sigma(const RangingLog& log, const SinglePointSettings& settings) {
    constexpr std::size_t most = 300, fewest_epochs = 10, fewest = 6;
    const BroadcastSource nobody{Navigation{}};
    SinglePointSettings single = settings;
    single.ranges.ionosphere = IonosphereModel::None;
    SinglePoint solver(nobody, {}, single);
    const std::size_t step = std::max<std::size_t>(1, log.epochs.size() / most);
    std::vector<double> variances;
    for (std::size_t i = 1; i < log.epochs.size(); i += step) {
        const SinglePointSolution s = solver.solve(satellite_ranges(log, log.epochs[i]), log.epochs[i].time);
        if (s.status != SinglePointStatus::Solved) continue;
        const std::vector<Change> changes = changes_between(log, log.epochs[i - 1], log.epochs[i], s.position, single.ranges);
        if (changes.size() < fewest) continue;
        if (const auto variance = variance_left(changes)) variances.push_back(*variance);
    }
    return variances.size() < fewest_epochs ? std::numeric_limits<double>::quiet_NaN()
                                            : std::sqrt(math::median(std::move(variances)));
}

}  // namespace schuler::gnss
