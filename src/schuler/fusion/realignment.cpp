#include "schuler/fusion/realignment.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace schuler::fusion {
namespace {

bool is_position(const MeasurementRecord& r) { return r.kind == MeasurementKind::GnssPosition; }

}  // namespace

bool may_realign(const Settings& s) {
    return !uses_ranges(s.coupling) && s.coupling != Coupling::Separate && !s.integrity.use &&
           s.constraints.gate_probability > 0.0;
}

PositionCount positions_after(const Result& result, Time since) {
    PositionCount n;
    for (const MeasurementRecord& r : result.measurements) {
        if (!is_position(r) || r.time <= since) continue;
        n.used += r.status == MeasurementStatus::Accepted ? 1 : 0;
        n.refused += r.status == MeasurementStatus::Rejected ? 1 : 0;
    }
    return n;
}

std::optional<Time> diverged_at(const Result& result) {
    constexpr double span = 120.0;  // s
    constexpr std::size_t least = 5;
    const auto again = [&](const Alert& a) {
        return std::ranges::any_of(result.alerts, [&](const Alert& b) {
            return b.test == IntegrityTest::Navigation && b.time > a.time && (b.time - a.time).seconds() < span;
        });
    };
    for (const Alert& a : result.alerts) {
        if (a.test != IntegrityTest::Navigation) continue;
        PositionCount n;
        std::optional<Time> before;
        for (const MeasurementRecord& r : result.measurements) {
            if (!is_position(r) || (r.time - a.time).seconds() > span) continue;
            if (r.time > a.time) {
                n.used += r.status == MeasurementStatus::Accepted ? 1 : 0;
                n.refused += r.status == MeasurementStatus::Rejected ? 1 : 0;
            } else if (r.status == MeasurementStatus::Accepted) {
                before = r.time;
            }
        }
        if (n.refused < least || (10 * n.refused < n.refused + n.used && !again(a))) continue;
        return before.value_or(result.findings.started_at);
    }
    return std::nullopt;
}

bool explains(const Result& anew, const Result& diverged, Time since) {
    constexpr double clear = 5.0 * units::deg, span = 120.0, least = 2.0;  // rad, s, s
    const PositionCount before = positions_after(diverged, since), now = positions_after(anew, since);
    if (now.used == 0 || 2 * now.refused >= before.refused || 10 * now.refused > now.refused + now.used) return false;
    double apart = 0.0;  // s
    const std::vector<SolutionRow>& rows = anew.forward.rows;
    for (std::size_t i = 1; i < rows.size() && (rows[i].time - rows.front().time).seconds() < span; ++i) {
        const auto same = std::ranges::lower_bound(diverged.forward.rows, rows[i].time, {}, &SolutionRow::time);
        if (same == diverged.forward.rows.end()) break;
        const double angle = math::quaternion_from_rpy(rows[i].rpy).angularDistance(math::quaternion_from_rpy(same->rpy));
        if (angle > clear) apart += (rows[i].time - rows[i - 1].time).seconds();
    }
    return apart > least;
}

std::optional<CarriedHeading> heading_carried_back(const Result& before, const Result& after) {
    if (before.forward.rows.empty() || after.forward.rows.empty()) return std::nullopt;
    const SolutionRow &end = before.forward.rows.back(), &begin = after.forward.rows.front();
    constexpr double longest = 5.0, turning = 5.0 * units::deg, unknown = 1.0;  // s between the two, rad within it, rad
    if ((begin.time - end.time).seconds() > longest) return CarriedHeading{before.findings.heading, unknown};
    const double off = math::wrap_pi(end.rpy.z() - begin.rpy.z()), sigma = std::hypot(end.std_rpy.z(), begin.std_rpy.z());
    if (std::abs(off) < 3.0 * sigma) return std::nullopt;
    return CarriedHeading{math::wrap_pi(before.findings.heading - off), std::hypot(begin.std_rpy.z(), turning)};
}

}  // namespace schuler::fusion
