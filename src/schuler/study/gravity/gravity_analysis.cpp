#include "schuler/core/units.h"
#include "schuler/gravimetry/classical.h"
#include "schuler/study/gravity/gravity.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace schuler::study {
namespace {

using gravimetry::SurveyEpoch;

constexpr double shortest_line = 1000.0;  // m
constexpr double course_tolerance = 5.0 * units::deg;
constexpr double slowest = 5.0;            // m/s: below this the course is undefined
constexpr double repeated_within = 200.0;  // m

/// RMS of value - truth, and the same less the mean, over the settled part; truth is down, like the values.
std::pair<double, double> error_of(const GravityBundle& b, const std::vector<double>& down, double edge) {
    double sum = 0.0, squares = 0.0, n = 0.0;
    const double end = b.run.relative(b.survey.forward.back().time) - edge;
    for (std::size_t i = 0; i < down.size(); ++i) {
        const Time time = b.survey.forward[i].time;
        const double t = b.run.relative(time);
        if (time < b.run.evaluation.settled || t > end || t < edge || !std::isfinite(down[i])) continue;
        const double e = down[i] - b.truth[i].z();
        sum += e;
        squares += e * e;
        n += 1.0;
    }
    if (n < 1.0) return {not_given, not_given};
    return {std::sqrt(squares / n), std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)))};
}

/// A disturbance simulated along the track is subtracted: a crossing would compare two positions along it.
std::vector<gravimetry::TrackPoint> track_of(const GravityBundle& b) {
    const earth::Earth& earth = b.run.data.config.filter.earth;
    const std::vector<SolutionRow>& rows = b.run.solution().rows;
    std::vector<gravimetry::TrackPoint> out;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Eigen::Vector3d from_start = earth::ned_difference(earth, rows[i].position, rows.front().position);
        const double along_track = b.truth.empty() || b.over_ground ? 0.0 : b.truth[i].z();
        const double course = std::atan2(rows[i].v_eb_n.y(), rows[i].v_eb_n.x());
        out.push_back({from_start.head<2>(), course, b.epochs()[i].disturbance_n.z() - along_track});
    }
    return out;
}

}  // namespace

GravityLines gravity_lines(const GravityBundle& b) {
    GravityLines out;
    const std::vector<SolutionRow>& rows = b.run.solution().rows;
    double fastest = 0.0;
    for (const SolutionRow& row : rows) fastest = std::max(fastest, row.v_eb_n.head<2>().norm());
    if (fastest < slowest) return out;
    const std::vector<gravimetry::TrackPoint> track = track_of(b);
    out.lines = gravimetry::survey_lines(track, shortest_line, course_tolerance);
    out.crossings = gravimetry::crossovers(track, out.lines);
    out.repeats = gravimetry::repeated_lines(track, out.lines, repeated_within, shortest_line);
    out.rms_before = gravimetry::crossover_rms(out.lines, out.crossings);
    gravimetry::level(out.lines, out.crossings);
    out.rms_after = gravimetry::crossover_rms(out.lines, out.crossings);
    out.levelled.assign(rows.size(), not_given);
    out.line_of.assign(rows.size(), -1);
    for (std::size_t k = 0; k < out.lines.size(); ++k) {
        for (std::size_t i = out.lines[k].first; i <= out.lines[k].last; ++i) {
            out.levelled[i] = b.epochs()[i].disturbance_n.z() - out.lines[k].level;
            out.line_of[i] = static_cast<int>(k);
        }
    }
    if (b.truth.empty()) return out;
    out.levelled_spread = error_of(b, out.levelled, 0.0).second;
    if (!std::isfinite(b.attainable.resolved_period)) return out;
    std::vector<double> t, error;
    for (std::size_t i = 0; i < track.size(); ++i) {
        t.push_back((rows[i].time - rows.front().time).seconds());
        error.push_back(b.epochs()[i].disturbance_n.z() - b.truth[i].z());
    }
    std::vector<double> slow = gravimetry::low_passed(t, error, b.attainable.resolved_period);
    for (std::size_t i = 0; i < slow.size(); ++i) slow[i] = out.line_of[i] < 0 ? not_given : slow[i] + b.truth[i].z();
    out.resolved_spread = error_of(b, slow, b.attainable.resolved_period).second;
    return out;
}

ClassicalGravity classical_gravity(const GravityBundle& b, const GravityInput& input) {
    ClassicalGravity out;
    const double given = b.run.data.config.gravity.lowpass;
    out.period = std::isfinite(given)                          ? given
                 : std::isfinite(b.attainable.resolved_period) ? b.attainable.resolved_period
                                                               : 400.0;
    out.down = gravimetry::classical_disturbance(input.filter.earth, input.filter.gnss.lever_arm_b, input.recording->gnss,
                                                 b.survey.forward, out.period);
    if (!b.truth.empty()) std::tie(out.rms, out.spread) = error_of(b, out.down, out.period);
    return out;
}

}  // namespace schuler::study
