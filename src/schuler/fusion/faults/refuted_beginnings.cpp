#include "schuler/fusion/faults/refuted_beginnings.h"

#include "schuler/filter/integrity/refused_fixes.h"

#include <algorithm>
#include <iterator>
#include <optional>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

/// Displacement by the velocities of the rows, m.
Vector3d travelled(const std::vector<SolutionRow>& rows, Time from, Time to) {
    Vector3d sum = Vector3d::Zero();
    auto row = std::ranges::lower_bound(rows, from, {}, &SolutionRow::time);
    for (Time t = from; t < to && row != rows.end(); ++row) {
        const Time next = std::min(row->time, to);
        sum += row->v_eb_n * (next - t).seconds();
        t = next;
    }
    return sum;
}

/// The first fix after the last jump like this one between two others, up to `until`.
std::optional<RefutedBeginning> beginning(const std::vector<SolutionRow>& rows, const std::vector<GnssFix>& fixes,
                                          const earth::Earth& earth, Time until, const Vector3d& jump) {
    constexpr double like = 0.5, sigmas = 4.0;  // of the size; of the fix
    auto fix = std::ranges::upper_bound(fixes, until, {}, &GnssFix::time);
    std::optional<Time> end;
    while (fix != fixes.begin()) {
        --fix;
        const bool first = fix == fixes.begin();
        const GnssFix& before = first ? *fix : *std::prev(fix);
        if (first || (fix->time - before.time).seconds() >= filter::interruption) {
            if (!end) return std::nullopt;
            return RefutedBeginning{fix->time, *end, jump};
        }
        if (end) continue;
        const Vector3d by =
            earth::ned_difference(earth, fix->position, before.position) - travelled(rows, before.time, fix->time);
        // NaN: no sigma is stated
        const bool noise = jump.norm() < sigmas * fix->std_position.head<2>().maxCoeff();
        if (!noise && (by - jump).norm() < like * jump.norm()) end = fix->time;
    }
    return std::nullopt;
}

}  // namespace

std::vector<RefutedBeginning> refuted_beginnings(const std::vector<SolutionRow>& smoothed, const std::vector<GnssFix>& fixes,
                                                 const earth::Earth& earth) {
    constexpr double dense = 0.2, sparse = 2.0, least = 1.0, least_of_sparse = 5.0;  // s, m
    std::vector<RefutedBeginning> out;
    for (std::size_t i = 1; i < smoothed.size(); ++i) {
        const SolutionRow &a = smoothed[i - 1], &b = smoothed[i];
        const double dt = (b.time - a.time).seconds();
        if (!(dt > 0.0 && dt <= sparse)) continue;
        const Vector3d jump = earth::ned_difference(earth, b.position, a.position) - 0.5 * dt * (a.v_eb_n + b.v_eb_n);
        if (!(jump.norm() > (dt <= dense ? least : least_of_sparse))) continue;
        if (const auto found = beginning(smoothed, fixes, earth, b.time, jump)) out.push_back(*found);
    }
    return out;
}

std::size_t withhold(std::vector<filter::Event>& events, const std::vector<RefutedBeginning>& beginnings) {
    std::size_t n = 0;
    for (filter::Event& e : events) {
        if (e.kind != filter::MeasurementKind::GnssPosition || e.withheld) continue;
        e.withheld =
            std::ranges::any_of(beginnings, [&](const RefutedBeginning& b) { return e.stamp >= b.first && e.stamp < b.end; });
        n += e.withheld ? 1 : 0;
    }
    return n;
}

}  // namespace schuler::fusion
