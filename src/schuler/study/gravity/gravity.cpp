#include "schuler/study/gravity/gravity.h"

#include "schuler/core/units.h"
#include "schuler/dataset/recognise.h"
#include "schuler/gravimetry/resolution.h"
#include "schuler/math/chi_square.h"
#include "schuler/math/rotation.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/toml_file.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/events.h"
#include "schuler/solution/fuse.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace schuler::study {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using gravimetry::SurveyEpoch;

/// A scenario is a TOML file with a section not present in any data set.
bool is_scenario(const fs::path& path) {
    if (path.extension() != ".toml") return false;
    const settings::ValueTable root = settings::read_toml(path);
    return std::ranges::any_of(root,
                               [](const settings::NamedValue& v) { return v.first == "trajectory" || v.first == "duration_s"; });
}

SolutionRow row_of(const earth::Earth& earth, const SurveyEpoch& e) {
    const NavState nav = [&] {
        NavState n;
        n.position = earth::geodetic_from_ecef(earth.ellipsoid, e.nav.position);
        const Eigen::Matrix3d C_ne = earth::C_en(n.position.lat, n.position.lon).transpose();
        n.v_eb_n = C_ne * e.nav.v_eb_e;
        n.q_nb = Eigen::Quaterniond(C_ne * e.nav.q_eb.toRotationMatrix());
        return n;
    }();
    SolutionRow row;
    row.time = e.time;
    row.position = nav.position;
    row.v_eb_n = nav.v_eb_n;
    row.rpy = math::rpy_from_quaternion(nav.q_nb);
    row.std_position = e.sigma_position_n;
    row.std_velocity = e.sigma_velocity_n;
    const Eigen::Matrix3d J = math::rpy_error_from_phi(row.rpy);
    row.std_rpy = (J.cwiseAbs2() * e.sigma_attitude_n.cwiseAbs2()).cwiseSqrt();
    return row;
}

fusion::Trajectory trajectory_of(const earth::Earth& earth, const std::vector<SurveyEpoch>& epochs) {
    fusion::Trajectory out;
    for (const SurveyEpoch& e : epochs) {
        out.rows.push_back(row_of(earth, e));
        const Vector3d zero = Vector3d::Zero();
        out.sensor_errors.push_back(
            {e.time, e.gyro_bias, e.sigma_gyro_bias, e.accel_bias, e.sigma_accel_bias, zero, zero, zero, zero});
    }
    return out;
}

std::string mgal_text(double x, int digits = 2) {
    return std::isfinite(x) ? fmt::format("{:.{}g} mGal", x / units::mgal, digits) : std::string("an unknown amount");
}

Attainability attainability(const GravityInput& in, const std::vector<SurveyEpoch>& forward, const settings::GravityConfig& g) {
    Attainability a;
    const SurveyEpoch& last = forward.back();
    a.vertical = last.sigma_disturbance_n.z();
    a.horizontal = last.sigma_disturbance_n.head<2>().norm() / std::sqrt(2.0);
    const bool process = g.model != gravimetry::DisturbanceKind::Constant;
    const double random_prior = process ? g.sigma_enu.z() : 0.0;
    a.prior_vertical = std::hypot(g.prior_enu.z(), random_prior);
    double least_random = random_prior;
    for (const SurveyEpoch& e : forward) least_random = std::min(least_random, e.sigma_random_n.z());
    a.resolved_period = gravimetry::resolved_period(in.settings, in.motion);
    const bool level = a.vertical < 0.5 * a.prior_vertical;
    const bool change = process && least_random < 0.5 * random_prior;
    a.usable = level || change;
    const double accel = in.settings.prior.accel_bias;
    if (!a.usable) {
        a.statement = fmt::format(
            "this log cannot show the disturbance of gravity: covariance analysis leaves {} of the {} that were assumed "
            "before (accelerometers known to {}); no gravity is written",
            mgal_text(a.vertical), mgal_text(a.prior_vertical), mgal_text(accel));
    } else {
        a.statement = fmt::format(
            "covariance analysis: the vertical disturbance is known to {} at the end, the horizontal one to {}; its level cannot "
            "be distinguished from the accelerometers' constant error ({})",
            mgal_text(a.vertical), mgal_text(a.horizontal), mgal_text(accel));
        if (std::isfinite(a.resolved_period))
            a.statement += fmt::format(
                "; a wavelength of {:.3g} s{} keeps half its amplitude", a.resolved_period,
                in.motion.speed > 0.5 ? fmt::format(" ({:.3g} km)", 1e-3 * in.motion.speed * a.resolved_period) : std::string{});
    }
    return a;
}

/// The true disturbance at the forward epochs.
std::vector<Vector3d> truth_at(const std::vector<SurveyEpoch>& epochs, const std::vector<sim::SensorTruth>& truth) {
    std::vector<Vector3d> out;
    for (const SurveyEpoch& e : epochs) {
        auto after = std::ranges::lower_bound(truth, e.time, {}, &sim::SensorTruth::time);
        if (after == truth.end()) --after;
        if (after == truth.begin() || after->time == e.time) {
            out.push_back(after->disturbance_n);
            continue;
        }
        const auto before = after - 1;
        const double share = (e.time - before->time).seconds() / (after->time - before->time).seconds();
        out.push_back((1.0 - share) * before->disturbance_n + share * after->disturbance_n);
    }
    return out;
}

GravityErrors errors_of(const GravityBundle& b) {
    GravityErrors out;
    if (b.truth.empty()) return out;
    const auto& epochs = b.epochs();
    Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
    double n = 0.0;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        if (epochs[i].time < b.run.evaluation.settled) continue;
        const Vector3d e = epochs[i].disturbance_n - b.truth[i];
        sum += e;
        squares += e.cwiseAbs2();
        n += 1.0;
    }
    out.last = epochs.back().disturbance_n - b.truth.back();
    if (n < 1.0) return out;
    out.rms = (squares / n).cwiseSqrt();
    out.spread = (squares / n - (sum / n).cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
    return out;
}

GravityInnovations innovations_of(const GravityBundle& b) {
    GravityInnovations out;
    double sum = 0.0;
    int freedoms = 0;
    for (const SurveyEpoch& e : b.survey.forward) {
        if (e.time < b.run.evaluation.settled || e.measured == 0) continue;
        sum += e.nis;
        freedoms += e.measured;
        ++out.epochs;
    }
    if (freedoms == 0) return out;
    out.nis = sum / freedoms;
    out.low = math::chi_square_quantile(0.025, freedoms) / freedoms;
    out.high = math::chi_square_quantile(0.975, freedoms) / freedoms;
    return out;
}

GravitySeparation separation_of(const GravityBundle& b) {
    GravitySeparation out;
    Vector3d squares = Vector3d::Zero(), inside = Vector3d::Zero();
    for (const gravimetry::SurveySeparation& s : b.survey.separation) {
        if (s.time < b.run.evaluation.settled) continue;
        squares += s.difference_n.cwiseAbs2();
        inside += Vector3d((s.difference_n.array().abs() <= 3.0 * s.sigma_n.array()).cast<double>());
        ++out.epochs;
    }
    if (out.epochs == 0) return out;
    const auto n = static_cast<double>(out.epochs);
    out.rms = (squares / n).cwiseSqrt();
    out.inside_3sigma = inside / n;
    return out;
}

/// From loaded data to the survey and its results. `asked`: keys of given settings; `command_line`: those of them that were typed.
void estimate(GravityBundle& b, const std::set<std::string>& asked, const settings::SettingList& command_line,
              WarningLog& warnings) {
    b.run.command = "gravity";
    b.run.ignored = solution::leave_out_chosen(b.run.data, true);
    std::ranges::move(solution::ignored_of(b.run, asked), std::back_inserter(b.run.ignored));
    solution::warn_of_ignored_here(b.run.ignored, command_line, warnings);
    settings::Config& c = b.run.data.config;
    c.scheme = settings::Scheme::Loose;
    c.filter.coupling = fusion::Coupling::Loose;
    c.filter.mechanization = fusion::Mechanization::Ecef;
    c.filter.smooth = c.gravity.smooth;
    const GravityInput input = gravity_input(b.run.data, warnings);
    const auto filter_begin = std::chrono::steady_clock::now();
    b.survey = gravimetry::run_survey(input.data, input.filter, input.start,
                                      {.smooth = c.gravity.smooth, .backward = c.filter.backward, .steps = input.steps});
    b.run.result.filter_seconds = b.run.timing.filter_s = solution::seconds_since(filter_begin);
    b.run.result.forward = trajectory_of(c.filter.earth, b.survey.forward);
    if (c.gravity.smooth) b.run.result.smoothed = trajectory_of(c.filter.earth, b.survey.smoothed);
    b.run.result.backward = trajectory_of(c.filter.earth, b.survey.backward).rows;
    b.run.result.states = std::move(b.survey.states);
    b.run.result.forward.parameters = std::move(b.survey.parameters);
    b.run.result.forward.covariances = std::move(b.survey.covariances);
    b.run.result.smoothed.parameters = std::move(b.survey.smoothed_parameters);
    b.run.result.smoothed.covariances = std::move(b.survey.smoothed_covariances);
    fusion::Counters& n = b.run.result.counters;
    n.imu_epochs = input.data.imu.increments.size() - input.start.increment;
    n.imu_gaps = input.data.imu.gaps;
    n.imu_rate = 1.0 / input.data.imu.median_dt;
    for (const fusion::MeasurementRecord& r : b.survey.measurements) {
        if (r.kind != fusion::MeasurementKind::GnssPosition) continue;
        ++n.gnss_epochs;
        ++(r.status == fusion::MeasurementStatus::Accepted   ? n.gnss_accepted
           : r.status == fusion::MeasurementStatus::Withheld ? n.gnss_withheld
                                                             : n.gnss_rejected);
    }
    b.run.result.measurements = b.survey.measurements;
    b.run.result.findings.aligned_at = b.survey.forward.front().time;
    b.run.evaluation = solution::evaluate(b.run.data, b.run.result, b.run.truth);
    if (!b.run.truth.sensors.empty()) b.truth = truth_at(b.survey.forward, b.run.truth.sensors);
    b.errors = errors_of(b);
    b.innovations = innovations_of(b);
    b.biased = gravimetry::most_biased_run(b.survey.measurements, b.run.evaluation.settled);
    b.separation = separation_of(b);
    b.attainable = attainability(input, b.survey.forward, c.gravity);
    b.changes = gravity_changes(b, input);
    b.verdict = gravity_verdict(b);
    if (!b.verdict.usable) {
        b.attainable.usable = false;
        b.attainable.statement = "the disturbance of this survey is not to be used: " + b.verdict.reasons.front();
    } else if (std::ranges::any_of(
                   b.changes, [&](const GravityChange& change) { return change.sigma_n.z() < 0.5 * b.attainable.vertical; })) {
        b.attainable.statement += "; its change at a step is known better";
    }
    if (b.verdict.usable && b.biased.significant())
        warnings.add("gravity.model", dependence_of_innovations(b) + "; the sigmas are too small where that is so");
    b.classical = classical_gravity(b, input);
    b.lines = gravity_lines(b);
    b.run.timing.read_s = b.run.data.read_seconds;
}

}  // namespace

std::vector<GravityRow> gravity_rows(const GravityBundle& b) {
    const earth::Earth& earth = b.run.data.config.filter.earth;
    const std::optional<double> undulation = b.run.data.config.undulation;
    const auto& epochs = b.epochs();
    std::vector<GravityRow> out;
    auto separated = b.survey.separation.begin();
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const SurveyEpoch& e = epochs[i];
        const SolutionRow row = row_of(earth, e);
        const earth::EarthTerms terms = earth::terms_at(earth, row.position, row.v_eb_n);
        GravityRow r;
        r.t = b.run.relative(e.time);
        const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + 1, epochs.size() - 1);
        if (i > 0)
            r.distance = out.back().distance + 0.5 * (epochs[i].nav.v_eb_e + epochs[i - 1].nav.v_eb_e).norm() *
                                                   (epochs[i].time - epochs[i - 1].time).seconds();
        r.position = row.position;
        r.disturbance_n = e.disturbance_n;
        r.sigma_n = e.sigma_disturbance_n;
        // Normal gravity at the height above the geoid instead of that above the ellipsoid.
        if (undulation)
            r.free_air = e.disturbance_n.z() + earth::gravity_down(earth.gravity, row.position.lat, row.position.h) -
                         earth::gravity_down(earth.gravity, row.position.lat, row.position.h - *undulation);
        r.eotvos = ((2.0 * terms.w_ie_n + terms.w_en_n).cross(row.v_eb_n)).z();
        const double span = (epochs[after].time - epochs[before].time).seconds();
        if (span > 0.0)
            r.vertical_acceleration =
                -(row_of(earth, epochs[after]).v_eb_n.z() - row_of(earth, epochs[before]).v_eb_n.z()) / span;
        while (separated != b.survey.separation.end() && separated->time < e.time) ++separated;
        if (separated != b.survey.separation.end() && separated->time == e.time) {
            r.separation_n = separated->difference_n;
            r.sigma_separation_n = separated->sigma_n;
        }
        if (!b.truth.empty()) r.truth_n = b.truth[i];
        r.classical = b.classical.down[i];
        if (!b.lines.line_of.empty()) {
            r.levelled = b.lines.levelled[i];
            r.line = b.lines.line_of[i];
        }
        out.push_back(r);
    }
    return out;
}

GravityBundle gravity_of_scenario(const settings::ScenarioConfig& scenario, const settings::ProcessRequest& request,
                                  WarningLog& warnings) {
    const auto begin = std::chrono::steady_clock::now();
    GravityBundle b;
    b.run = solution::simulated_bundle(scenario, request.over({}), warnings);
    b.run.data.read_seconds = solution::seconds_since(begin);
    b.run.version = request.version;
    b.over_ground = scenario.sim.anomaly.empty();
    estimate(b, settings::keys_of_processing(scenario, request.over({})), request.above, warnings);
    return b;
}

GravityBundle gravity_survey(const settings::ProcessRequest& request, WarningLog& warnings, std::string& notice) {
    if (is_scenario(request.input))
        return gravity_of_scenario(settings::read_scenario(request.input, request.seed), request, warnings);
    GravityBundle b;
    const settings::Dataset dataset = settings::open_dataset(request.input, dataset::Needs::ImuAndGnss, request.over({}));
    const settings::Config config = settings::config_from(dataset.settings);
    b.run.name = config.name.empty() ? dataset.name : config.name;
    b.run.version = request.version;
    b.run.data = solution::load_dataset(dataset, config, warnings);
    notice = dataset.inferred_toml;
    estimate(b, b.run.data.given, request.above, warnings);
    return b;
}

report::Outcome gravity_command(const GravityRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    WarningLog warnings;
    report::Outcome out;
    GravityBundle b = gravity_survey(request.common, warnings, out.notice);
    settings::Config& c = b.run.data.config;
    b.run.config_toml = settings::to_toml(settings::config_table().used(c), settings::config_table().specs(), true);
    b.run.warnings = warnings.summary();
    if (!b.attainable.usable) b.run.warnings.insert(b.run.warnings.begin(), b.attainable.statement);
    report::ResultFolder files(out, request.common.folder_for(b.run.name));
    const auto write_begin = std::chrono::steady_clock::now();
    const std::vector<std::string> wanted = c.output.files;
    std::erase(c.output.files, "report");
    files.add_written(report::write_outputs(b.run, files.path(), false));
    c.output.files = wanted;
    const std::vector<GravityRow> rows = b.attainable.usable ? gravity_rows(b) : std::vector<GravityRow>{};
    if (b.attainable.usable) {
        files.write("gravity.csv", gravity_csv(b, rows));
        files.write("gravity.geojson", gravity_geojson(b, rows));
    }
    if (c.output.wants("report")) files.write("report.html", gravity_report_html(b, rows));
    b.run.timing.write_s = solution::seconds_since(write_begin);
    b.run.timing.wall_s = solution::seconds_since(begin);
    out.json = gravity_summary_json(b, rows.size());
    if (c.output.wants("summary")) files.write("summary.json", out.json);
    files.publish();
    out.tables = gravity_tables(b);
    out.warnings = b.run.warnings;
    out.usable = b.verdict.usable;
    if (!out.usable) {
        out.verdict = "do not use";
        for (const std::string& reason : b.verdict.reasons)
            out.verdict += (&reason == &b.verdict.reasons.front() ? ": " : "; ") + reason;
    }
    return out;
}

}  // namespace schuler::study
