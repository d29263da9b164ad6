#include "schuler/core/units.h"
#include "schuler/gravimetry/response.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/study/gravity/gravity.h"
#include "schuler/study/parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::study {
namespace {

using gravimetry::HarmonicResponse;
using gravimetry::SurveyEpoch;
using sim::AnomalyPart;

constexpr double size = 10.0 * units::mgal;  // of the harmonics: small enough for a linear response of the filter
constexpr int periods = 10;

/// Abscissa of a survey: metres along the track if moving, seconds otherwise.
struct Course {
    bool by_time = false;
    double pace = 1.0;      ///< metres (or seconds) per second
    double duration = 0.0;  ///< s
    std::vector<double> s;  ///< at the epochs
};

Course course_of(const GravityBundle& b) {
    Course c;
    const auto& epochs = b.survey.forward;
    c.duration = b.run.relative(epochs.back().time);
    double distance = 0.0;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const double before = i > 0 ? b.run.relative(epochs[i - 1].time) : 0.0;
        distance += epochs[i].nav.v_eb_e.norm() * (b.run.relative(epochs[i].time) - before);
        c.s.push_back(distance);
    }
    c.by_time = distance < 100.0;
    if (c.by_time)
        for (std::size_t i = 0; i < epochs.size(); ++i) c.s[i] = b.run.relative(epochs[i].time);
    else c.pace = distance / c.duration;
    return c;
}

AnomalyPart part(AnomalyPart::Kind kind, double sign, double start, double length, bool by_time) {
    return {kind, Eigen::Vector3d(0.0, 0.0, sign * size), start, length, by_time};
}

/// Response of an estimator to the added part: down component, settled epochs only.
std::vector<double> answer(const std::vector<SurveyEpoch>& with, const std::vector<SurveyEpoch>& without) {
    std::vector<double> out;
    for (std::size_t i = 0; i < with.size(); ++i) out.push_back(with[i].disturbance_n.z() - without[i].disturbance_n.z());
    return out;
}

/// The part of a series between two fractions of its length.
std::vector<double> between(const std::vector<double>& x, double from, double to) {
    const auto n = static_cast<double>(x.size());
    return {x.begin() + static_cast<std::ptrdiff_t>(from * n), x.begin() + static_cast<std::ptrdiff_t>(to * n)};
}

using Measured = GravityResponse::At;
using Corrected = GravityResponse::Correction;

/// Estimates with parts added to the scenario's anomaly.
GravityBundle with(const settings::ScenarioConfig& scenario, const std::vector<AnomalyPart>& parts,
                   const settings::ProcessRequest& request) {
    settings::ScenarioConfig changed = scenario;
    changed.sim.anomaly.insert(changed.sim.anomaly.end(), parts.begin(), parts.end());
    WarningLog warnings;
    return gravity_of_scenario(changed, request, warnings);
}

Measured measured(const settings::ScenarioConfig& scenario, const settings::ProcessRequest& request, const GravityBundle& base,
                  const Course& course, double period) {
    const double length = course.pace * period;
    const GravityBundle b = with(scenario, {part(AnomalyPart::Kind::Harmonic, 1.0, 0.0, length, course.by_time)}, request);
    const auto fitted = [&](const std::vector<SurveyEpoch>& after, const std::vector<SurveyEpoch>& before, double from,
                            double to) {
        if (after.empty()) return HarmonicResponse{not_given, not_given, not_given};
        return gravimetry::harmonic_response(between(course.s, from, to), between(answer(after, before), from, to), length, 0.0,
                                             size);
    };
    return {period, fitted(b.survey.forward, base.survey.forward, 0.4, 1.0),
            fitted(b.survey.smoothed, base.survey.smoothed, 0.25, 0.75)};
}

double rms_less_mean(const std::vector<double>& x) {
    double sum = 0.0, squares = 0.0;
    for (const double v : x) {
        sum += v;
        squares += v * v;
    }
    const auto n = static_cast<double>(x.size());
    return std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
}

/// The settled half of the survey.
Corrected corrected(const settings::ScenarioConfig& scenario, const settings::ProcessRequest& request, const GravityBundle& base,
                    const Course& course) {
    Corrected out;
    const auto harmonic = std::ranges::find(scenario.sim.anomaly, AnomalyPart::Kind::Harmonic, &AnomalyPart::kind);
    if (harmonic == scenario.sim.anomaly.end()) return out;
    out.period = harmonic->length / (harmonic->by_time ? 1.0 : course.pace);
    const HarmonicResponse r = measured(scenario, request, base, course, out.period).forward;
    std::vector<double> estimate;
    for (const SurveyEpoch& e : base.survey.forward) estimate.push_back(e.disturbance_n.z());
    const std::vector<double> moved = gravimetry::corrected_for(course.s, estimate, r, harmonic->length);
    // The last part of the track, as long as the lag, has no corrected value.
    const double late = std::max(0.0, r.lag / (2.0 * std::numbers::pi) * out.period);
    for (std::size_t i = 0; i < moved.size(); ++i) {
        const double t = base.run.relative(base.survey.forward[i].time);
        if (t < 0.4 * course.duration || t + late >= course.duration) continue;
        out.t.push_back(t);
        out.e_forward.push_back(-(estimate[i] - base.truth[i].z()) / units::mgal);
        out.e_corrected.push_back(-(moved[i] - base.truth[i].z()) / units::mgal);
        if (!base.survey.smoothed.empty())
            out.e_smoothed.push_back(-(base.survey.smoothed[i].disturbance_n.z() - base.truth[i].z()) / units::mgal);
    }
    if (out.t.empty()) return out;
    out.forward = rms_less_mean(out.e_forward);
    out.corrected = rms_less_mean(out.e_corrected);
    if (!out.e_smoothed.empty()) out.smoothed = rms_less_mean(out.e_smoothed);
    return out;
}

report::ResultTable table_of_periods(const GravityResponse& r) {
    report::ResultTable table{r.name + ": response to harmonics of the vertical disturbance",
                              {{"period_s", "period", "s"},
                               {"length_m", r.by_time ? "" : "length", "m"},
                               {"forward/gain", "filter", "", ".3f"},
                               {"forward/lag_deg", "its lag", "deg", ".1f"},
                               {"forward/residual", ""},
                               {"smoothed/gain", "smoother", "", ".3f"},
                               {"smoothed/lag_deg", "its lag", "deg", ".1f"},
                               {"smoothed/residual", ""}}};
    for (const Measured& m : r.at)
        table.rows.push_back({m.period, r.by_time ? not_given : m.period * r.pace, m.forward.gain, m.forward.lag / units::deg,
                              m.forward.residual, m.smoothed.gain, m.smoothed.lag / units::deg, m.smoothed.residual});
    return table;
}

void add_page(report::Outcome& out, const settings::ProcessRequest& request, const std::vector<Measured>& all, const Corrected& c,
              const std::string& name) {
    report::ReportInput page;
    page.title = name + ": response of the gravity estimator";
    page.version = request.version;
    report::Section section{"Amplitude and phase (paper E, figure 4)",
                            "Harmonics added to the anomaly of the scenario; the same noise with and without."};
    report::Panel gain{"amplitude", "period, s", "out / in"}, phase{"phase", "period, s", "lag, deg"};
    gain.time_axis = phase.time_axis = false;
    report::Series gf{"forward filter", {}, {}, report::Ink::Vermillion}, gs{"smoother", {}, {}}, pf = gf, ps = gs;
    for (const Measured& m : all) {
        for (report::Series* s : {&gf, &gs, &pf, &ps}) s->x.push_back(m.period);
        gf.y.push_back(m.forward.gain);
        gs.y.push_back(m.smoothed.gain);
        pf.y.push_back(m.forward.lag / units::deg);
        ps.y.push_back(m.smoothed.lag / units::deg);
    }
    gain.series = {gf, gs};
    phase.series = {pf, ps};
    section.groups.push_back({"", {gain, phase}, {}});
    if (!c.t.empty()) {
        report::Panel errors{"error of the vertical disturbance after the correction (figure 5)", "time, s", "mGal"};
        errors.series = {{"forward filter", c.t, c.e_forward, report::Ink::Muted},
                         {"corrected", c.t, c.e_corrected, report::Ink::Vermillion}};
        if (!c.e_smoothed.empty()) errors.series.push_back({"smoother", c.t, c.e_smoothed});
        section.groups.push_back({"Correction of amplitude and lag", {errors}, {}});
    }
    page.sections.push_back(std::move(section));
    write_report(out, request.folder_for(name), page);
}

}  // namespace

GravityResponse gravity_response_of(const settings::ScenarioConfig& scenario, const settings::ProcessRequest& common) {
    GravityResponse out;
    const GravityBundle base = with(scenario, {}, common);
    const Course course = course_of(base);
    out.name = base.run.name;
    out.by_time = course.by_time;
    out.pace = course.pace;
    const double shortest = std::min(20.0, 0.05 * course.duration), longest = course.duration / 3.0;
    for (int i = 0; i < periods; ++i) {
        out.at.push_back(measured(scenario, common, base, course, shortest * std::pow(longest / shortest, i / (periods - 1.0))));
        if (common.progress) common.progress((i + 1.0) / (periods + 2.0));
    }
    // An impulse of one second in the middle: two steps.
    const double middle = 0.5 * course.s.back(), width = course.pace;
    const GravityBundle hit = with(scenario,
                                   {part(AnomalyPart::Kind::Step, 100.0, middle, 1.0, course.by_time),
                                    part(AnomalyPart::Kind::Step, -100.0, middle + width, 1.0, course.by_time)},
                                   common);
    out.smooth = !hit.survey.smoothed.empty();
    out.resolution = out.smooth ? gravimetry::half_width(course.s, answer(hit.survey.smoothed, base.survey.smoothed))
                                : gravimetry::half_width(course.s, answer(hit.survey.forward, base.survey.forward));
    out.corrected = corrected(scenario, common, base, course);
    return out;
}

report::Outcome gravity_response(const GravityRequest& request) {
    const settings::ProcessRequest& common = request.common;
    const GravityResponse response = gravity_response_of(settings::read_scenario(common.input, common.seed), common);
    const Corrected& c = response.corrected;

    report::Outcome out;
    out.folder = common.folder_for(response.name);
    const char* unit = response.by_time ? "s" : "m";
    const report::ResultTable table = table_of_periods(response);
    out.tables = report::table_text(table);
    out.tables += std::isfinite(response.resolution)
                      ? fmt::format("an impulse becomes a hump of {:.4g} {} at half its height ({})\n", response.resolution, unit,
                                    response.smooth ? "smoother" : "filter")
                      : std::string("an impulse does not fall to half its height: the model takes it for a constant\n");
    if (std::isfinite(c.forward))
        out.tables += fmt::format(
            "error less its mean at a period of {:.4g} s, mGal: filter {:.3f}, corrected in amplitude and lag {:.3f}, smoother "
            "{:.3f}\n",
            c.period, c.forward, c.corrected, c.smoothed);
    out.json =
        report::text_of({{"name", response.name},
                         {"command", "gravity"},
                         {"response", report::table_json(table)},
                         {"impulse_half_width", {{response.by_time ? "s" : "m", report::json_number(response.resolution)}}},
                         {"correction",
                          {{"period_s", report::json_number(c.period)},
                           {"forward_mgal", report::json_number(c.forward)},
                           {"corrected_mgal", report::json_number(c.corrected)},
                           {"smoothed_mgal", report::json_number(c.smoothed)}}}});
    add_page(out, common, response.at, c, response.name);
    return out;
}

}  // namespace schuler::study
