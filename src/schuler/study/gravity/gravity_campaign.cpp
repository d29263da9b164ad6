#include "schuler/core/units.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
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

/// One number of every run, with its sigma where the filter has one: |error| at the end or RMS over a survey.
struct Tally {
    const char* name;
    const char* unit;
    double si;
    std::vector<double> sizes{}, normalised{};
    void add(double error, double sigma) {
        sizes.push_back(std::abs(error) / si);
        if (sigma > 0.0) normalised.push_back(error / sigma);
    }
    [[nodiscard]] double quantile(double p) const { return math::quantile(sizes, p); }
    /// Mean of (error/sigma)^2: near one where the filter knows what it does not know.
    [[nodiscard]] double nees() const {
        double sum = 0.0;
        for (const double x : normalised) sum += x * x;
        return normalised.empty() ? not_given : sum / static_cast<double>(normalised.size());
    }
};

}  // namespace

report::Outcome gravity_campaign(const GravityRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    std::array tallies{Tally{"disturbance up", "mGal", units::mgal},
                       Tally{"disturbance north", "mGal", units::mgal},
                       Tally{"disturbance east", "mGal", units::mgal},
                       Tally{"disturbance up, rms", "mGal", units::mgal},
                       Tally{"disturbance up, rms - mean", "mGal", units::mgal},
                       Tally{"tilt north", "arcsec", units::arcsec},
                       Tally{"tilt east", "arcsec", units::arcsec},
                       Tally{"azimuth", "arcsec", units::arcsec},
                       Tally{"velocity north", "m/s", 1.0},
                       Tally{"velocity east", "m/s", 1.0},
                       Tally{"velocity up", "m/s", 1.0},
                       Tally{"gyro bias north", "deg/h", units::deg_per_hour},
                       Tally{"gyro bias east", "deg/h", units::deg_per_hour},
                       Tally{"gyro bias down", "deg/h", units::deg_per_hour},
                       Tally{"lines, resolved", "mGal", units::mgal},
                       Tally{"lines, levelled", "mGal", units::mgal},
                       Tally{"classical, rms - mean", "mGal", units::mgal}};
    int failed = 0;
    std::string name;
    for (int run = 0; run < request.runs; ++run) {
        settings::ProcessRequest one = request.common;
        one.seed = request.common.seed.value_or(1) + static_cast<std::uint64_t>(run);
        WarningLog warnings;
        std::string notice;
        try {
            const GravityBundle b = gravity_survey(one, warnings, notice);
            name = b.run.name;
            if (b.truth.empty())
                throw input_error("recorded data have no seeds", {one.input.string(), 0, 0, {}}, "--runs is for scenarios");
            const SurveyEpoch& last = b.survey.forward.back();
            const auto& error_row =
                b.run.evaluation.errors_forward.empty() ? b.run.evaluation.errors.back() : b.run.evaluation.errors_forward.back();
            const Eigen::Vector3d dg = last.disturbance_n - b.truth.back();
            tallies[0].add(dg.z(), last.sigma_disturbance_n.z());
            tallies[1].add(dg.x(), last.sigma_disturbance_n.x());
            tallies[2].add(dg.y(), last.sigma_disturbance_n.y());
            tallies[3].add(b.errors.rms.z(), 0.0);
            tallies[4].add(b.errors.spread.z(), 0.0);
            // Level surveys: roll and pitch turned by the heading are tilts about north and east.
            const SolutionRow& row = b.run.result.forward.rows.back();
            const double s = std::sin(row.rpy.z()), c = std::cos(row.rpy.z());
            tallies[5].add(c * error_row.rpy.x() - s * error_row.rpy.y(), last.sigma_attitude_n.x());
            tallies[6].add(s * error_row.rpy.x() + c * error_row.rpy.y(), last.sigma_attitude_n.y());
            tallies[7].add(error_row.rpy.z(), last.sigma_attitude_n.z());
            tallies[8].add(error_row.velocity.y(), last.sigma_velocity_n.x());
            tallies[9].add(error_row.velocity.x(), last.sigma_velocity_n.y());
            tallies[10].add(error_row.velocity.z(), last.sigma_velocity_n.z());
            // Seen from north, east and down; their sigmas are those of the body axes and would need the covariance between them.
            const Eigen::Vector3d gyro = math::dcm_from_rpy(row.rpy) * (last.gyro_bias - b.run.truth.sensors.back().gyro_bias);
            for (std::size_t i = 0; i < 3; ++i) tallies[11 + i].add(gyro(static_cast<int>(i)), 0.0);
            if (std::isfinite(b.lines.resolved_spread)) tallies[14].add(b.lines.resolved_spread, 0.0);
            if (std::isfinite(b.lines.levelled_spread)) tallies[15].add(b.lines.levelled_spread, 0.0);
            if (std::isfinite(b.classical.spread)) tallies[16].add(b.classical.spread, 0.0);
        } catch (const Error& e) {
            if (e.kind() == ErrorKind::Input) throw;
            ++failed;
        }
        if (request.common.progress) request.common.progress(static_cast<double>(run + 1) / request.runs);
    }
    const double seconds = solution::seconds_since(begin);
    report::Outcome out;
    out.tables =
        fmt::format("{}: {} runs, {} failed, {:.2f} runs a second\n", name, request.runs, failed, request.runs / seconds);
    out.tables +=
        fmt::format("{:<36}{:>11}{:>11}{:>11}{:>11}\n", "size of the error at the end", "median", "5 %", "95 %", "NEES");
    report::Json errors = report::Json::object();
    for (const Tally& t : tallies) {
        if (t.sizes.empty()) continue;
        out.tables += fmt::format("  {:<34}{:>11.4g}{:>11.4g}{:>11.4g}{:>11.3g}\n", fmt::format("{}, {}", t.name, t.unit),
                                  t.quantile(0.5), t.quantile(0.05), t.quantile(0.95), t.nees());
        errors[t.name] = {{"unit", t.unit},
                          {"median", t.quantile(0.5)},
                          {"q05", t.quantile(0.05)},
                          {"q95", t.quantile(0.95)},
                          {"nees", report::json_number(t.nees())}};
    }
    const report::Json document{
        {"name", name},
        {"command", "gravity"},
        {"version", request.common.version},
        // clang-format off
                        {"montecarlo", {{"runs", request.runs}, {"failed", failed}, {"runs_per_s", request.runs / seconds}}},
                        {"errors", errors}};
    // clang-format on
    out.json = report::text_of(document);
    if (!request.common.output.empty()) {
        report::make_folder(request.common.output);
        out.files.push_back(request.common.output / "summary.json");
        report::write_text(out.files.back(), out.json);
    }
    return out;
}

}  // namespace schuler::study
