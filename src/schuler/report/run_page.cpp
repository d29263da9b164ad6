#include "schuler/core/units.h"
#include "schuler/earth/enu.h"
#include "schuler/report/facts.h"
#include "schuler/report/outputs.h"
#include "schuler/report/run_report.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/health.h"
#include "schuler/solution/provenance.h"

#include <algorithm>

namespace schuler::report {
namespace {

using Eigen::Vector3d;

std::vector<report::ErrorPoint> points_of(const std::vector<analysis::ErrorRow>& rows) {
    std::vector<report::ErrorPoint> out;
    out.reserve(rows.size());
    for (const analysis::ErrorRow& r : rows) {
        out.push_back({r.time, earth::ned_from_enu(r.position), earth::ned_from_enu(r.velocity), r.rpy,
                       earth::sigma_swapped(r.std_position), earth::sigma_swapped(r.std_velocity), r.std_rpy});
    }
    return out;
}

void add_accuracy(std::vector<report::AccuracyEntry>& out, const std::string& name, const std::string& unit,
                  const analysis::Spread& s, double si = 1.0) {
    if (s.rms == s.rms) out.push_back({name, unit, s.rms / si, s.p95 / si, s.max / si});
}

std::vector<report::AccuracyEntry> accuracy_of(const analysis::ErrorSummary& s) {
    std::vector<report::AccuracyEntry> out;
    add_accuracy(out, "position east", "m", s.east);
    add_accuracy(out, "position north", "m", s.north);
    add_accuracy(out, "position up", "m", s.up);
    add_accuracy(out, "position horizontal", "m", s.horizontal);
    add_accuracy(out, "position 3-d", "m", s.three_d);
    add_accuracy(out, "velocity east", "m/s", s.v_east);
    add_accuracy(out, "velocity north", "m/s", s.v_north);
    add_accuracy(out, "velocity up", "m/s", s.v_up);
    add_accuracy(out, "roll", "deg", s.roll, units::deg);
    add_accuracy(out, "pitch", "deg", s.pitch, units::deg);
    add_accuracy(out, "heading", "deg", s.heading, units::deg);
    return out;
}

report::InnovationGroup group_of(const filter::MeasurementInfo& info) {
    report::InnovationGroup g{std::string(info.name), std::string(info.unit), info.per_unit, {}, {}, not_given};
    for (const std::string_view component : info.components)
        if (!component.empty()) g.components.emplace_back(component);
    return g;
}

std::vector<report::InnovationGroup> innovations_of(const solution::ResultBundle& b) {
    std::vector<report::InnovationGroup> out;
    for (const filter::MeasurementInfo& info : filter::measurement_infos) {
        report::InnovationGroup g = group_of(info);
        for (const fusion::MeasurementRecord& r : b.result.measurements) {
            if (r.kind != info.kind) continue;
            const auto status = r.status == fusion::MeasurementStatus::Accepted   ? report::InnovationStatus::Accepted
                                : r.status == fusion::MeasurementStatus::Rejected ? report::InnovationStatus::Rejected
                                                                                  : report::InnovationStatus::Withheld;
            report::InnovationPoint p{r.time, status, r.dof, r.innovation, r.sigma, r.nis};
            for (int i = 0; i < 3; ++i) {
                if (!(r.sigma[i] > 0.0)) p.innovation[i] = p.sigma[i] = not_given;  // not a component of this record
            }
            g.points.push_back(p);
        }
        for (const solution::MeasurementConsistency& a : b.evaluation.measurements) {
            if (a.name == info.key) g.lag1 = a.nis.lag1;
        }
        if (!g.points.empty()) out.push_back(std::move(g));
    }
    return out;
}

std::vector<report::OutageEntry> outages_of(const solution::ResultBundle& b) {
    std::vector<report::OutageEntry> out;
    for (const analysis::OutageStatistics& o : b.evaluation.outages) {
        report::OutageEntry e;
        e.start_s = b.relative(o.span.start);
        e.duration_s = o.span.duration.seconds();
        e.end_horizontal = o.end_horizontal;
        e.max_horizontal = o.max_horizontal;
        e.end_vertical = o.end_vertical;
        e.max_3d = o.max_3d;
        e.compared = o.epochs > 0;
        e.inside_3sigma = o.inside_3sigma;
        for (const fusion::OutageEpoch& p : b.solution().outage_epochs) {
            if (p.outage != static_cast<int>(out.size())) continue;
            e.into_s.push_back((p.time - o.span.start).seconds());
            e.horizontal.push_back(p.error.head<2>().norm());
        }
        out.push_back(std::move(e));
    }
    return out;
}

void add_findings(const solution::ResultBundle& b, report::RunReportData& data) {
    const fusion::Findings& f = b.result.findings;
    auto& out = data.findings;
    if (!f.alignment.empty()) out.emplace_back("alignment", f.alignment);
    const Vector3d m = f.mounting_rpy / units::deg;
    if (m.norm() > 0.0)
        out.emplace_back("mounting roll, pitch, yaw", fmt::format("{:.2f}, {:.2f}, {:.2f} deg", m.x(), m.y(), m.z()));
    if (f.position_latency != 0.0 || f.velocity_latency != 0.0 || f.height_latency != 0.0) {
        out.emplace_back("GNSS latency",
                         fmt::format("position {:.3f} s, velocity {:.3f} s, height {:.3f} s, velocity down {:.3f} s",
                                     f.position_latency, f.velocity_latency, f.height_latency, f.velocity_down_latency));
    }
    const Vector3d& l = f.lever_arm_b;
    if (l.norm() > 0.0)
        out.emplace_back("lever arm forward, right, down", fmt::format("{:.3f}, {:.3f}, {:.3f} m", l.x(), l.y(), l.z()));
    for (const Fact& fact : b.facts) {
        if (!solution::is_news(fact)) continue;
        const std::string span =
            std::isfinite(fact.from) ? fmt::format(", {:.0f} to {:.0f} s", fact.from, fact.to) : std::string();
        out.emplace_back(fact.key, fmt::format("{} ({}{}{}{})", fact_text(fact), name_of(fact.how), span,
                                               fact.note.empty() ? "" : ": ", fact.note));
    }
}

void add_sensor_errors(const solution::ResultBundle& b, report::RunReportData& data) {
    for (const fusion::SensorErrorRow& r : b.solution().sensor_errors) {
        data.sensor_errors.push_back({r.time, r.gyro_bias, r.std_gyro_bias, r.accel_bias, r.std_accel_bias, r.gyro_scale,
                                      r.std_gyro_scale, r.accel_scale, r.std_accel_scale});
    }
    for (const sim::SensorTruth& t : b.truth.sensors) {
        report::SensorErrorPoint p;
        p.time = t.time;
        p.gyro_bias = t.gyro_bias;
        p.accel_bias = t.accel_bias;
        data.sensor_truth.push_back(p);
    }
}

report::GrowthCurve curve_of(const solution::Coverage& c, const std::string& name) {
    report::GrowthCurve out{name, {}, {}, {}};
    for (const solution::GrowthPoint& p : c.growth) {
        out.since_s.push_back(p.since);
        out.error.push_back(p.error);
        out.sigma.push_back(p.sigma);
    }
    return out;
}

std::string percent(const solution::Inside& x) { return x.epochs > 0 ? fmt::format("{:.1f} %", 100.0 * x.share()) : "-"; }

report::CheckEntry check_of(const std::optional<solution::SelfCheck>& check) {
    report::CheckEntry out;
    if (!check) return out;
    const solution::SelfCheck& c = *check;
    if (!c.done()) {
        out.intro = fmt::format("The sigmas were not checked on this log: {}.", c.why_not);
        return out;
    }
    out.intro = fmt::format(
        "Fixes were withheld in windows of {:.0f} s, every other one in a run of its own, and compared with the filter; the "
        "sigma is its own and the fix's together.",
        c.length);
    report::TableBlock table{
        "Inside 3σ", {"noise", "windows", "held", "epochs", "inside", "horizontal", "vertical", "end, RMS m", "sigma, m"}, {}};
    const auto add = [&](const char* name, const solution::Coverage& x) {
        table.rows.push_back({name, fmt::format("{}", x.windows.epochs), percent(x.held), fmt::format("{}", x.epochs.epochs),
                              percent(x.epochs), percent(x.horizontal), percent(x.vertical), report::number(x.end_rms, 3),
                              report::number(x.sigma_rms, 3)});
    };
    if (c.before) {
        out.growth.push_back(curve_of(*c.before, " before widening"));
        add("before widening", *c.before);
    }
    out.growth.push_back(curve_of(c.coverage, c.widened ? " with wider noise" : ""));
    if (c.all) add("wider, in all windows", *c.all);
    add(c.widened ? "wider, in validation windows" : "as it is", c.coverage);
    report::TableBlock motion{
        "By motion", {"motion", "fixes", "refused", "inside 3σ", "NIS a component", "withheld", "inside 3σ"}, {}};
    for (std::size_t k = 0; k < solution::regimes; ++k) {
        const solution::FixRegime& f = c.fixes[k];
        const solution::Inside& w = c.coverage.by_regime[k];
        motion.rows.push_back({name_of(static_cast<solution::Regime>(k)), fmt::format("{}", f.fixes),
                               fmt::format("{}", f.refused), percent(f.inside), report::number(f.nis, 3),
                               fmt::format("{}", w.epochs), percent(w)});
    }
    out.tables = {std::move(table), std::move(motion)};
    if (c.tried)
        out.intro += fmt::format(
            " The windows indicate {:.3g} times the noise of the gyros and {:.3g} times that of the accelerometers{}.",
            c.tried->gyro, c.tried->accel,
            c.widened ? ", which is in force" : ", which makes the others no truer and was left out");
    return out;
}

}  // namespace

report::ReportInput report_page(const solution::ResultBundle& b) {
    report::RunReportData data;
    const settings::Config& c = b.data.config;
    const auto& rows = b.solution().rows;
    data.title = b.name;
    data.subtitle = fmt::format("{} coupling, {} frame, {}; {} IMU epochs at {:.4g} Hz, {} GNSS epochs",
                                c.scheme == settings::Scheme::Gnss ? "no" : settings::scheme_name(c.scheme),
                                c.filter.mechanization == fusion::Mechanization::Geographic ? "geographic" : "Earth-fixed",
                                b.smoothed() ? "smoothed" : "forward filter", b.result.counters.imu_epochs,
                                b.result.counters.imu_rate, b.result.counters.gnss_epochs);
    data.version = b.version;
    data.zero = b.data.origin;
    data.settled_after_s = b.relative(b.evaluation.settled);
    data.smoothed = b.smoothed();
    data.solution = c.filter.output_rate > 0.0 ? rows : decimated(rows, 10.0);
    data.gnss = b.data.recording.gnss;
    data.reference = b.reference();
    data.reference_name = b.evaluation.reference == "truth"  ? "truth"
                          : b.evaluation.reference == "file" ? "reference file"
                          : b.evaluation.reference == "gnss" ? "withheld GNSS"
                                                             : "";
    if (!rows.empty()) {
        data.local = [earth = c.filter.earth, from = rows.front().position](const Geodetic& p) {
            return Ned{earth::ned_difference(earth, p, from)};
        };
    }
    data.errors = points_of(b.evaluation.errors);
    data.forward_errors = points_of(b.evaluation.errors_forward);
    for (const analysis::SeparationRow& r : b.evaluation.separation)
        data.separation.push_back({r.time, r.position, r.velocity, r.rpy, r.std_position, r.std_velocity, r.std_rpy});
    data.accuracy = accuracy_of(b.evaluation.summary);
    data.innovations = innovations_of(b);
    add_sensor_errors(b, data);
    data.outages = outages_of(b);
    add_findings(b, data);
    if (!b.verdict.reasons.empty()) data.verdict = solution::words_of(b.verdict.word);  // otherwise none was formed
    data.reasons = b.verdict.reasons;
    data.check = check_of(b.self_check);
    for (const solution::HealthInterval& h : solution::health_of(b.data, b.result))
        data.health.push_back({std::string(h.source), std::string(name_of(h.state)), b.relative(h.from), b.relative(h.to)});
    data.warnings = b.warnings;
    data.settings = b.config_toml;
    return report::run_report(data);
}

std::string report_html(const solution::ResultBundle& b) { return report::render(report_page(b)); }

}  // namespace schuler::report
