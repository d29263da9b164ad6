#include "schuler/core/units.h"
#include "schuler/report/evaluation_json.h"
#include "schuler/report/facts.h"
#include "schuler/report/published.h"
#include "schuler/report/summary.h"
#include "schuler/solution/bundle.h"

#include <cmath>

namespace schuler::report {
namespace {

std::string alert_text(const fusion::Alert& a) {
    using fusion::IntegrityTest;
    const std::string size = fmt::format("{:.3g} {}", a.size, a.kind == fusion::AidKind::GnssVelocity ? "m/s" : "m");
    switch (a.test) {
        case IntegrityTest::Readmitted: return "used again";
        case IntegrityTest::Jump:
            return fmt::format("the receiver jumps by {}, not felt by the IMU: sigmas cover both levels", size);
        case IntegrityTest::JumpBack: return fmt::format("the receiver is back from a jump of {}", size);
        case IntegrityTest::OtherLevel:
            return fmt::format("the receiver has stayed {} away for longer than before: that counts now", size);
        case IntegrityTest::Navigation:
            return fmt::format("the navigation was wrong ({}): attitude and biases re-estimated", size);
        case IntegrityTest::Receiver: return fmt::format("the receiver was wrong ({}) and agrees again", size);
        default: return fmt::format("excluded ({} test)", integrity_test_name(a.test));
    }
}

std::string cell(double x, double unit = 1.0) {
    if (!std::isfinite(x)) return "-";
    const double v = x / unit, a = std::abs(v);
    if (a != 0.0 && (a < 1e-3 || a >= 1e5)) return fmt::format("{:.2e}", v);
    return fmt::format("{:.{}f}", v, a < 1.0 ? 4 : a < 100.0 ? 3 : 1);
}

std::string error_line(const std::string& name, const analysis::Spread& s, double unit = 1.0) {
    if (!std::isfinite(s.rms)) return {};
    return fmt::format("  {:<26}{:>11}{:>11}{:>11}\n", name, cell(s.rms, unit), cell(s.p95, unit), cell(s.max, unit));
}

std::string error_table(const analysis::ErrorSummary& s, const std::string& title) {
    if (s.epochs == 0) return {};
    std::string out = fmt::format("{:<28}{:>11}{:>11}{:>11}\n", title, "rms", "95 %", "max");
    out += error_line("position east, m", s.east) + error_line("position north, m", s.north) + error_line("position up, m", s.up);
    out += error_line("position horizontal, m", s.horizontal) + error_line("position 3-d, m", s.three_d);
    out += error_line("velocity east, m/s", s.v_east) + error_line("velocity north, m/s", s.v_north) +
           error_line("velocity up, m/s", s.v_up);
    out += error_line("roll, deg", s.roll, units::deg) + error_line("pitch, deg", s.pitch, units::deg) +
           error_line("heading, deg", s.heading, units::deg);
    return out;
}

std::string consistency_table(const solution::Evaluation& e) {
    std::string out;
    const auto nees = [&](const char* name, const analysis::NeesStatistics& n) {
        if (std::isfinite(n.mean))
            out += fmt::format("  NEES {:<17}{:>11}{:>11}   ({} to {})\n", name, cell(n.mean), cell(n.expected), cell(n.low95),
                               cell(n.high95));
    };
    if (e.consistency) {
        nees("position", e.consistency->position);
        nees("velocity", e.consistency->velocity);
        nees("attitude", e.consistency->attitude);
    }
    if (!out.empty()) out = fmt::format("{:<24}{:>11}{:>11}   {}\n", "consistency", "mean", "expected", "95 % bounds") + out;
    if (!e.aids.empty())
        out += fmt::format("{:<24}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "innovations", "NIS mean", "dof", "accepted", "rejected",
                           "lag 1");
    for (const solution::AidConsistency& a : e.aids) {
        out += fmt::format("  {:<22}{:>11}{:>11}{:>11}{:>11}{:>11}\n", a.name, cell(a.nis.mean), cell(a.nis.dof), a.nis.accepted,
                           a.nis.rejected, cell(a.nis.lag1));
    }
    return out;
}

std::string outage_table(const std::vector<analysis::OutageStatistics>& outages, Time origin, const std::string& title) {
    if (outages.empty()) return {};
    std::string out = fmt::format("{:<20}{:>10}{:>13}{:>13}{:>13}{:>10}   {}\n", title, "length, s", "end hor., m", "max hor., m",
                                  "end vert., m", "max 3-d", "3 sigma");
    double end2 = 0.0, max2 = 0.0;
    std::size_t counted = 0;
    for (const analysis::OutageStatistics& o : outages) {
        out += fmt::format("  at {:<15}{:>10}{:>13}{:>13}{:>13}{:>10}   {}\n",
                           fmt::format("{:.10g} s", (o.span.start - origin).seconds()),
                           fmt::format("{:.6g}", o.span.duration.seconds()), cell(o.end_horizontal), cell(o.max_horizontal),
                           cell(o.end_vertical), cell(o.max_3d),
                           o.epochs == 0     ? "nothing to compare"
                           : o.inside_3sigma ? "inside"
                                             : "OUTSIDE");
        if (!std::isfinite(o.max_horizontal)) continue;
        end2 += std::isfinite(o.end_horizontal) ? o.end_horizontal * o.end_horizontal : 0.0;
        max2 += o.max_horizontal * o.max_horizontal;
        ++counted;
    }
    if (counted > 1) {
        const double n = static_cast<double>(counted);
        out += fmt::format("  {:<18}{:>10}{:>13}{:>13}\n", "rms", "", cell(std::sqrt(end2 / n)), cell(std::sqrt(max2 / n)));
    }
    return out;
}

std::string separation_table(const solution::Evaluation& e) {
    if (e.separation.empty()) return {};
    const auto line = [](const char* name, const analysis::SeparationSpread& s, double unit) {
        return fmt::format("  {:<22}{:>11}{:>15.1f} %\n", name, cell(s.rms / unit), 100.0 * s.inside_3sigma);
    };
    const analysis::SeparationSummary& s = e.separated;
    return fmt::format("{:<24}{:>11}{:>17}\n", "forward minus backward", "rms", "inside 3 sigma") +
           line("north, m", s.north, 1.0) + line("east, m", s.east, 1.0) + line("up, m", s.up, 1.0) +
           line("heading, deg", s.heading, units::deg);
}

}  // namespace

std::string summary_tables(const solution::ResultBundle& b) {
    const fusion::Counters& n = b.result.counters;
    const auto& rows = b.solution().rows;
    std::string out = fmt::format(
        "{}: {:.1f} s, {} IMU epochs at {:.4g} Hz ({} gaps), {} GNSS epochs ({} accepted, {} rejected, {} withheld){}\n", b.name,
        rows.empty() ? 0.0 : (rows.back().time - rows.front().time).seconds(), n.imu_epochs, n.imu_rate, n.imu_gaps,
        n.gnss_epochs, n.gnss_accepted, n.gnss_rejected, n.gnss_withheld, b.smoothed() ? ", smoothed" : "");
    if (!b.result.findings.alignment.empty()) out += fmt::format("start: {}\n", b.result.findings.alignment);
    if (b.command == "process") out += "\n" + facts_table(b.facts, false);
    const solution::Evaluation& e = b.evaluation;
    if (e.summary.epochs > 0) {
        out += "\n" + error_table(e.summary, fmt::format("errors against {} from {:.1f} s",
                                                         e.reference == "truth" ? "truth" : "reference", b.relative(e.settled)));
        if (e.forward)
            out += error_line("forward horizontal, m", e.forward->horizontal) + error_line("forward 3-d, m", e.forward->three_d);
    }
    if (!e.outages.empty()) {
        out += "\n" + outage_table(e.outages, b.data.origin, b.smoothed() ? "outages, smoothed" : "outages");
        out += outage_table(e.outages_forward, b.data.origin, "outages, forward");
    }
    if (!b.result.alerts.empty()) out += "\nrefused fixes: who was wrong\n";
    constexpr std::size_t most_lines = 20;
    for (std::size_t i = 0; i < std::min(most_lines, b.result.alerts.size()); ++i) {
        const fusion::Alert& a = b.result.alerts[i];
        out += fmt::format("  {:>8.1f} s  {:<9} {}\n", b.relative(a.time),
                           a.kind == fusion::AidKind::GnssVelocity ? "velocity" : "position", alert_text(a));
    }
    if (b.result.alerts.size() > most_lines)
        out += fmt::format("  and {} more (summary.json has them all)\n", b.result.alerts.size() - most_lines);
    const std::string consistency = consistency_table(e), separation = separation_table(e);
    if (!consistency.empty()) out += "\n" + consistency;
    if (!separation.empty()) out += "\n" + separation;
    if (!b.published.source.empty() && !e.states.empty())
        out += "\n" + published_table(b.published, rms_of(e.states, e.settled),
                                      fmt::format("{}, from {:.0f} s", b.name, b.relative(e.settled)));
    if (b.self_check) out += "\n" + solution::self_check_table(*b.self_check);
    const std::string checked =
        b.self_check && b.self_check->done() ? fmt::format("self-check {:.2f} s, ", b.timing.check_s) : std::string();
    out += fmt::format("\nread {:.2f} s, filter {:.2f} s ({:.3g} million IMU epochs/s forward), {}write {:.2f} s\n",
                       b.timing.read_s, b.timing.filter_s,
                       b.result.filter_seconds > 0.0 ? 1e-6 * static_cast<double>(n.imu_epochs) / b.result.filter_seconds : 0.0,
                       checked, b.timing.write_s);
    return out;
}

std::string evaluation_tables(const solution::Evaluation& e) {
    std::string out = error_table(e.summary, fmt::format("errors at {} epochs", e.summary.epochs));
    if (out.empty()) out = "no epoch is left after settling; give a smaller --settle\n";
    const std::string consistency = consistency_table(e);
    return consistency.empty() ? out : out + "\n" + consistency;
}

}  // namespace schuler::report
