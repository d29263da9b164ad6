#include "schuler/solution/evaluate.h"

#include "schuler/analysis/reference_point.h"
#include "schuler/earth/enu.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::solution {
namespace {

using fusion::MeasurementKind;

constexpr double default_settle = 60.0;  // s after alignment, from the interface contract

analysis::OutageSpan span_of(const fusion::Outage& outage, Time origin) {
    return {origin + Duration::from_seconds(outage.start), Duration::from_seconds(outage.duration)};
}

bool has_position(const std::vector<ReferenceSample>& reference) {
    return std::ranges::any_of(reference, [](const ReferenceSample& s) { return s.position.lat == s.position.lat; });
}

/// True if the reference agrees with the fixes. An autopilot's own estimate may use another height reference: outages are then
/// evaluated with the withheld fixes.
bool among_the_fixes(const LoadedDataset& data, const std::vector<ReferenceSample>& reference) {
    constexpr double far = 10.0;  // m, median
    std::vector<double> distance;
    for (const GnssFix& fix : data.recording.gnss) {
        const auto next = std::ranges::lower_bound(reference, fix.time, {}, &ReferenceSample::time);
        if (next == reference.end() || (next->time - fix.time).seconds() > 0.5) continue;
        const Eigen::Vector3d d = earth::ned_difference(data.config.filter.earth, next->position, fix.position);
        if (std::isfinite(d.z())) distance.push_back(std::abs(d.z()));
    }
    if (distance.empty()) return true;
    return math::median(std::move(distance)) < far;
}

/// The outages of a trajectory relative to the reference, or to the withheld fixes at the antenna.
std::vector<analysis::OutageStatistics> outages_of(const LoadedDataset& data, const std::vector<ReferenceSample>& reference,
                                                   const fusion::Trajectory& trajectory, bool jumps) {
    std::vector<analysis::OutageStatistics> out;
    const bool by_reference = has_position(reference) && (data.true_reference || among_the_fixes(data, reference));
    const auto& outages = data.config.filter.outages;
    for (std::size_t k = 0; k < outages.size(); ++k) {
        const analysis::OutageSpan span = span_of(outages[k], data.origin);
        if (by_reference) {
            const auto errors = analysis::outage_errors(data.config.filter.earth, trajectory.rows, reference, span, jumps);
            out.push_back(analysis::outage_statistics(span, errors));
            continue;
        }
        std::vector<analysis::OutageError> errors;
        for (const fusion::OutageEpoch& e : trajectory.outage_epochs) {
            if (e.outage != static_cast<int>(k)) continue;
            errors.push_back({e.time, earth::enu_from_ned(e.error), earth::sigma_swapped(e.sigma_apart)});
        }
        out.push_back(analysis::outage_statistics(span, errors));
    }
    return out;
}

std::vector<MeasurementConsistency> measurements_of(const std::vector<fusion::MeasurementRecord>& records, Time settled) {
    std::vector<MeasurementConsistency> out;
    for (const filter::MeasurementInfo& info : filter::measurement_infos) {
        std::vector<analysis::InnovationSample> samples;
        for (const fusion::MeasurementRecord& r : records) {
            if (r.kind != info.kind || r.status == fusion::MeasurementStatus::Withheld || r.time < settled) continue;
            Eigen::Vector3d standardised = Eigen::Vector3d::Zero();
            for (int i = 0; i < 3; ++i) standardised[i] = r.sigma[i] > 0.0 ? r.innovation[i] / r.sigma[i] : 0.0;
            samples.push_back({r.nis, r.dof, r.status == fusion::MeasurementStatus::Accepted, standardised});
        }
        if (!samples.empty()) out.push_back({info.key, analysis::nis_statistics(samples)});
    }
    return out;
}

/// Estimated minus true biases at the end of the run.
void bias_errors(const fusion::Trajectory& trajectory, const std::vector<sim::SensorTruth>& truth, Evaluation& out) {
    if (trajectory.sensor_errors.empty() || truth.empty()) return;
    const fusion::SensorErrorRow& last = trajectory.sensor_errors.back();
    const auto it = std::ranges::lower_bound(truth, last.time, {}, &sim::SensorTruth::time);
    const sim::SensorTruth& t = it == truth.end() ? truth.back() : *it;
    out.gyro_bias_error = last.gyro_bias - t.gyro_bias;
    out.accel_bias_error = last.accel_bias - t.accel_bias;
}

/// The reference epochs for comparison: those that coincide with rows of the solution if there are enough, because the solution
/// between its rows is interpolated and a vehicle may vibrate between them.
std::vector<ReferenceSample> comparable(const std::vector<SolutionRow>& rows, const std::vector<ReferenceSample>& reference) {
    constexpr std::int64_t same_instant_ns = 1'000;
    std::vector<ReferenceSample> out;
    std::size_t i = 0;
    for (const ReferenceSample& s : reference) {
        while (i < rows.size() && rows[i].time.ns < s.time.ns - same_instant_ns) ++i;
        if (i < rows.size() && rows[i].time.ns <= s.time.ns + same_instant_ns) out.push_back(s);
    }
    const std::size_t smaller = std::min(rows.size(), reference.size());
    return 2 * out.size() >= smaller ? out : reference;
}

/// The solution is the motion of the antenna, the reference that of the IMU.
bool of_two_points(const LoadedDataset& data) {
    return data.config.scheme == settings::Scheme::Gnss && !data.config.filter.gnss.lever_arm_b.isZero(0.0) &&
           has_position(data.recording.reference);
}

}  // namespace

Evaluation evaluate(const LoadedDataset& data, const fusion::Result& result, const HiddenTruth& truth) {
    Evaluation out;
    const settings::Config& c = data.config;
    const bool smoothed = !result.smoothed.rows.empty();
    const fusion::Trajectory& solution = smoothed ? result.smoothed : result.forward;
    out.settled = c.run.settle ? data.origin + Duration::from_seconds(*c.run.settle)
                               : result.findings.aligned_at + Duration::from_seconds(default_settle);
    if (of_two_points(data)) {
        out.at_antenna = analysis::reference_at(c.filter.earth, data.recording.reference, c.filter.gnss.lever_arm_b);
        out.at_another_point = out.at_antenna.empty();
    }
    const std::vector<ReferenceSample> reference =
        comparable(solution.rows, out.at_antenna.empty() ? data.recording.reference : out.at_antenna);
    if (!reference.empty()) {
        out.reference = data.true_reference ? "truth" : "file";
        out.errors = analysis::errors_against(c.filter.earth, solution.rows, reference);
        out.summary = analysis::summarise(out.errors, out.settled);
        out.consistency = analysis::consistency(out.errors, out.settled);
        if (smoothed) {
            out.errors_forward = analysis::errors_against(c.filter.earth, result.forward.rows, reference);
            out.forward = analysis::summarise(out.errors_forward, out.settled);
        }
    } else if (!c.filter.outages.empty()) {
        out.reference = "gnss";
    }
    out.outages = outages_of(data, reference, solution, !smoothed);
    if (smoothed) out.outages_forward = outages_of(data, reference, result.forward, true);
    out.measurements = measurements_of(result.measurements, out.settled);
    bias_errors(solution, truth.sensors, out);
    out.separation = analysis::separation(c.filter.earth, result.forward.rows, result.backward);
    if (!out.separation.empty()) {
        const Time end = out.separation.back().time, late = end - Duration::from_seconds(default_settle);
        out.separated = analysis::summarise(out.separation, out.settled, std::max(late, out.settled));
        if (out.separated.epochs < 2) out.separated = analysis::summarise(out.separation, Time{INT64_MIN}, end);
    }
    if (!result.forward.states.empty() && !smoothed)
        out.states = state_errors(result.forward.states, c.filter.earth, data.recording.reference, truth);
    else if (!truth.sensors.empty()) out.states = state_errors_by_sigmas(solution, result.states, out.errors, reference, truth);
    return out;
}

void warn_of_other_point(const Evaluation& e, WarningLog& warnings) {
    if (e.at_another_point)
        warnings.add(
            "reference.point",
            "reference: it has no attitude that would show where the antenna is, and the solution is that of the antenna: "
            "the errors contain the lever arm (gnss.lever_arm_m)");
}

Evaluation compare(const earth::Earth& earth, const std::vector<SolutionRow>& rows, const std::vector<ReferenceSample>& reference,
                   double settle) {
    Evaluation out;
    out.reference = "file";
    out.errors = analysis::errors_against(earth, rows, comparable(rows, reference));
    if (out.errors.empty()) {
        throw input_error(
            "the solution and the reference have no time in common", {},
            rows.empty() || reference.empty()
                ? "one of them has no rows"
                : fmt::format(
                      "the solution spans {:.3f} to {:.3f} s, the reference {:.3f} to {:.3f} s; both must be on one time axis",
                      rows.front().time.seconds(), rows.back().time.seconds(), reference.front().time.seconds(),
                      reference.back().time.seconds()));
    }
    out.settled = out.errors.front().time + Duration::from_seconds(settle);
    out.summary = analysis::summarise(out.errors, out.settled);
    const bool sigmas = std::ranges::any_of(rows, [](const SolutionRow& r) { return r.std_position.allFinite(); });
    if (sigmas) out.consistency = analysis::consistency(out.errors, out.settled);
    return out;
}

}  // namespace schuler::solution
