#include "schuler/analysis/outages.h"

#include <algorithm>
#include <cmath>

namespace schuler::analysis {

namespace {

/// The solution at a time, before an update at that time.
std::optional<SolutionRow> solution_before_update(const earth::Earth& earth, std::span<const SolutionRow> rows, Time time,
                                                  Duration max_gap) {
    const auto at = std::lower_bound(rows.begin(), rows.end(), time, [](const SolutionRow& row, Time t) { return row.time < t; });
    const bool twice = at != rows.end() && at + 1 != rows.end() && at->time == time && (at + 1)->time == time;
    if (twice) return *at;
    if (at == rows.begin() || time - (at - 1)->time > max_gap) return std::nullopt;
    SolutionRow row = *(at - 1);
    row.position = earth::moved_by_ned(earth, row.position, (time - row.time).seconds() * row.v_eb_n);
    row.time = time;
    return row;
}

}  // namespace

OutageStatistics outage_statistics(const OutageSpan& span, std::span<const OutageError> errors) {
    OutageStatistics out;
    out.span = span;
    out.epochs = errors.size();
    if (errors.empty()) return out;
    out.max_horizontal = out.max_3d = 0.0;
    out.inside_3sigma = true;
    for (const OutageError& e : errors) {
        out.max_horizontal = std::max(out.max_horizontal, std::hypot(e.error.x(), e.error.y()));
        out.max_3d = std::max(out.max_3d, e.error.norm());
        // Written so that a NaN counts as outside.
        const bool inside = std::abs(e.error.x()) <= 3.0 * e.sigma.x() && std::abs(e.error.y()) <= 3.0 * e.sigma.y();
        out.inside_3sigma = out.inside_3sigma && inside;
        out.epochs_inside += inside ? 1 : 0;
    }
    const Eigen::Vector3d& end = errors.back().error;
    out.end_horizontal = std::hypot(end.x(), end.y());
    out.growth_horizontal = (end - errors.front().error).head<2>().norm();
    out.end_vertical = std::abs(end.z());
    return out;
}

std::vector<OutageError> outage_errors(const earth::Earth& earth, std::span<const SolutionRow> rows,
                                       std::span<const ReferenceSample> reference, const OutageSpan& span, bool updates_jump,
                                       const ErrorOptions& options) {
    std::vector<OutageError> errors;
    const Time end = span.start + span.duration;
    for (const ReferenceSample& sample : reference) {
        if (sample.time <= span.start) continue;
        const bool last = sample.time >= end;
        const std::optional<SolutionRow> row = last && updates_jump
                                                   ? solution_before_update(earth, rows, sample.time, options.max_gap)
                                                   : solution_at(earth, rows, sample.time, options.max_gap);
        if (row) {
            const ErrorRow e = error_between(earth, *row, sample, options.lever_arm_b);
            errors.push_back({sample.time, e.position, e.std_position});
        }
        if (last) break;
    }
    return errors;
}

}  // namespace schuler::analysis
