#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/request.h"
#include "schuler/solution/bundle.h"
#include "schuler/study/gravity/gravity.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace schuler::study {
namespace {

using gravimetry::SurveyEpoch;

/// Quantity evaluated for every run: |error| at the end, or RMS over a survey.
struct Quantity {
    const char* name;
    const char* unit;
    double si;
};
constexpr std::array quantities{Quantity{"disturbance up", "mGal", units::mgal},
                                Quantity{"disturbance north", "mGal", units::mgal},
                                Quantity{"disturbance east", "mGal", units::mgal},
                                Quantity{"disturbance up, rms", "mGal", units::mgal},
                                Quantity{"disturbance up, rms - mean", "mGal", units::mgal},
                                Quantity{"tilt north", "arcsec", units::arcsec},
                                Quantity{"tilt east", "arcsec", units::arcsec},
                                Quantity{"azimuth", "arcsec", units::arcsec},
                                Quantity{"velocity north", "m/s", 1.0},
                                Quantity{"velocity east", "m/s", 1.0},
                                Quantity{"velocity up", "m/s", 1.0},
                                Quantity{"gyro bias north", "deg/h", units::deg_per_hour},
                                Quantity{"gyro bias east", "deg/h", units::deg_per_hour},
                                Quantity{"gyro bias down", "deg/h", units::deg_per_hour},
                                Quantity{"lines, resolved", "mGal", units::mgal},
                                Quantity{"lines, levelled", "mGal", units::mgal},
                                Quantity{"classical, rms - mean", "mGal", units::mgal},
                                Quantity{"separation up", "mGal", units::mgal},
                                Quantity{"separation north", "mGal", units::mgal},
                                Quantity{"separation east", "mGal", units::mgal}};

/// Sigma is 0 if the filter states none.
struct ErrorAndSigma {
    double error = not_given, sigma = 0.0;
};
using SurveyErrors = std::array<ErrorAndSigma, quantities.size()>;

struct SurveyRun {
    std::string name{};
    bool failed = false;
    std::string reason{};  ///< against using it; empty: usable
    SurveyErrors errors{};
};

SurveyErrors errors_of_survey(const GravityBundle& b) {
    const SurveyEpoch& last = b.survey.forward.back();
    const auto& error_row =
        b.run.evaluation.errors_forward.empty() ? b.run.evaluation.errors.back() : b.run.evaluation.errors_forward.back();
    const Eigen::Vector3d dg = last.disturbance_n - b.truth.back(), sigma = last.sigma_disturbance_n;
    // Level surveys: roll and pitch rotated by the heading are tilts about north and east.
    const SolutionRow& row = b.run.result.forward.rows.back();
    const double s = std::sin(row.rpy.z()), c = std::cos(row.rpy.z());
    // Forward minus backward filter (with --backward) in the middle of the survey, where both have settled.
    const gravimetry::SurveySeparation parted = b.survey.separation.empty()
                                                    ? gravimetry::SurveySeparation{{}, not_given3(), Eigen::Vector3d::Zero()}
                                                    : b.survey.separation[b.survey.separation.size() / 2];
    // Resolved in north, east and down; the sigmas are those of the body axes, as the conversion would require their covariance.
    const Eigen::Vector3d gyro = math::dcm_from_rpy(row.rpy) * (last.gyro_bias - b.run.truth.sensors.back().gyro_bias);
    return {{{dg.z(), sigma.z()},
             {dg.x(), sigma.x()},
             {dg.y(), sigma.y()},
             {b.errors.rms.z()},
             {b.errors.spread.z()},
             {c * error_row.rpy.x() - s * error_row.rpy.y(), last.sigma_attitude_n.x()},
             {s * error_row.rpy.x() + c * error_row.rpy.y(), last.sigma_attitude_n.y()},
             {error_row.rpy.z(), last.sigma_attitude_n.z()},
             {error_row.velocity.y(), last.sigma_velocity_n.x()},
             {error_row.velocity.x(), last.sigma_velocity_n.y()},
             {error_row.velocity.z(), last.sigma_velocity_n.z()},
             {gyro.x()},
             {gyro.y()},
             {gyro.z()},
             {b.lines.resolved_spread},
             {b.lines.levelled_spread},
             {b.classical.spread},
             {parted.difference_n.z(), parted.sigma_n.z()},
             {parted.difference_n.x(), parted.sigma_n.x()},
             {parted.difference_n.y(), parted.sigma_n.y()}}};
}

SurveyRun survey_run(const GravityRequest& request, std::size_t run) {
    settings::ProcessRequest one = request.common;
    one.seed = request.common.seed.value_or(1) + run;
    one.progress = {};
    WarningLog warnings;
    std::string notice;
    SurveyRun out;
    try {
        const GravityBundle b = gravity_survey(one, warnings, notice);
        out.name = b.run.name;
        if (b.truth.empty())
            throw input_error("recorded data have no seeds", {one.input.string(), 0, 0, {}}, "--runs is for scenarios");
        out.errors = errors_of_survey(b);
        if (!b.verdict.usable) out.reason = b.verdict.reasons.front();
    } catch (const Error& e) {
        if (e.kind() == ErrorKind::Input) throw;
        out.failed = true;
    }
    return out;
}

}  // namespace

report::Outcome gravity_campaign(const GravityRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    std::vector<SurveyRun> runs(static_cast<std::size_t>(request.runs));
    for_each_run(
        runs.size(), request.jobs, [&](std::size_t run) { runs[run] = survey_run(request, run); }, request.common.progress);
    std::string name;
    for (const SurveyRun& r : runs)
        if (!r.name.empty()) name = r.name;
    const auto failed = std::ranges::count(runs, true, &SurveyRun::failed);
    const double seconds = solution::seconds_since(begin);
    report::Outcome out;
    report::ResultTable table{
        fmt::format("{}: {} runs, {} failed, {:.2f} runs a second", name, request.runs, failed, request.runs / seconds),
        {{"", "size of the error at the end"},
         {"unit", ""},
         {"median", "median"},
         {"q05", "5 %"},
         {"q95", "95 %"},
         {"nees", "NEES"}}};
    report::Json errors = report::Json::object();
    for (std::size_t q = 0; q < quantities.size(); ++q) {
        std::vector<double> sizes;
        double squares = 0.0, n = 0.0;
        for (const SurveyRun& r : runs) {
            const ErrorAndSigma& e = r.errors[q];
            if (std::isfinite(e.error)) sizes.push_back(std::abs(e.error) / quantities[q].si);
            if (!std::isfinite(e.error) || !(e.sigma > 0.0)) continue;
            squares += (e.error / e.sigma) * (e.error / e.sigma);
            n += 1.0;
        }
        if (sizes.empty()) continue;
        // NEES: near one if the filter's stated uncertainty is correct.
        table.rows.push_back({fmt::format("{}, {}", quantities[q].name, quantities[q].unit), quantities[q].unit,
                              math::quantile(sizes, 0.5), math::quantile(sizes, 0.05), math::quantile(sizes, 0.95),
                              n > 0.0 ? squares / n : not_given});
        report::put_row(errors[quantities[q].name], table.columns, table.rows.back());
    }
    out.tables = report::table_text(table);
    const auto refused = std::ranges::count_if(runs, [](const SurveyRun& r) { return !r.reason.empty(); });
    if (refused > 0) {
        const SurveyRun& one = *std::ranges::find_if(runs, [](const SurveyRun& r) { return !r.reason.empty(); });
        const std::string verdict = fmt::format("{} of {} surveys are not to be used, as: {}", refused, request.runs, one.reason);
        out.usable = 2 * refused < request.runs;
        if (out.usable) out.warnings.push_back(verdict);
        else out.verdict = "do not use: " + verdict;
    }
    const report::Json document{
        {"name", name},
        {"command", "gravity"},
        {"version", request.common.version},
        // clang-format off
                        {"montecarlo", {{"runs", request.runs}, {"failed", failed}, {"not_usable", refused}, {"runs_per_s", request.runs / seconds}}},
                        {"errors", errors}};
    // clang-format on
    out.json = report::text_of(document);
    if (!request.common.output.empty()) {
        report::ResultFolder files(out, request.common.output);
        files.write("summary.json", out.json);
        files.publish();
    }
    return out;
}

}  // namespace schuler::study
