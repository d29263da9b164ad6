#include "schuler/core/units.h"
#include "schuler/report/evaluation_json.h"
#include "schuler/report/facts.h"
#include "schuler/report/published.h"
#include "schuler/report/result_table.h"
#include "schuler/report/summary.h"
#include "schuler/solution/bundle.h"

#include <cmath>

namespace schuler::report {
namespace {

std::string alert_text(const fusion::Alert& a) {
    using fusion::IntegrityTest;
    const std::string size = fmt::format("{:.3g} {}", a.size, a.kind == fusion::MeasurementKind::GnssVelocity ? "m/s" : "m");
    switch (a.test) {
        case IntegrityTest::Readmitted: return "used again";
        case IntegrityTest::Returned: return "fault has ended";
        case IntegrityTest::Unjudged: return "used without judgement from here on: the solution is too tilted to contradict it";
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

void add_error(ResultTable& table, const char* name, const analysis::Spread& s, double unit = 1.0) {
    if (std::isfinite(s.rms)) table.rows.push_back({name, s.rms / unit, s.p95 / unit, s.max / unit});
}

ResultTable error_table(const analysis::ErrorSummary& s, const std::string& title) {
    ResultTable table = table_for_people("", {title, "rms", "95 %", "largest"});
    add_error(table, "position east, m", s.east);
    add_error(table, "position north, m", s.north);
    add_error(table, "position up, m", s.up);
    add_error(table, "position horizontal, m", s.horizontal);
    add_error(table, "position 3-d, m", s.three_d);
    add_error(table, "velocity east, m/s", s.v_east);
    add_error(table, "velocity north, m/s", s.v_north);
    add_error(table, "velocity up, m/s", s.v_up);
    add_error(table, "roll, deg", s.roll, units::deg);
    add_error(table, "pitch, deg", s.pitch, units::deg);
    add_error(table, "heading, deg", s.heading, units::deg);
    return table;
}

std::string consistency_table(const solution::Evaluation& e) {
    std::string out;
    if (e.consistency) {
        ResultTable table = table_for_people("", {"consistency", "mean", "expected", "95 % bounds: from", "to"});
        const auto nees = [&](const char* name, const analysis::NeesStatistics& n) {
            if (std::isfinite(n.mean)) table.rows.push_back({name, n.mean, n.expected, n.low95, n.high95});
        };
        nees("NEES position", e.consistency->position);
        nees("NEES velocity", e.consistency->velocity);
        nees("NEES attitude", e.consistency->attitude);
        if (!table.rows.empty()) out += table_text(table);
    }
    if (e.measurements.empty()) return out;
    ResultTable table = table_for_people("", {"innovations", "NIS mean", "dof", "accepted", "rejected", "lag 1"});
    for (const solution::MeasurementConsistency& a : e.measurements)
        table.rows.push_back({a.name, a.nis.mean, a.nis.dof, a.nis.accepted, a.nis.rejected, a.nis.lag1});
    return out + table_text(table);
}

std::string outage_table(const std::vector<analysis::OutageStatistics>& outages, Time origin, const std::string& title) {
    if (outages.empty()) return {};
    ResultTable table = table_for_people(
        "", {title, "length, s", "end, horizontal, m", "largest, m", "end, vertical, m", "largest 3-d, m", "3 sigma"});
    table.columns[1].format = ".6g";
    double end2 = 0.0, max2 = 0.0;
    std::size_t counted = 0;
    for (const analysis::OutageStatistics& o : outages) {
        table.rows.push_back({fmt::format("at {:.10g} s", (o.span.start - origin).seconds()), o.span.duration.seconds(),
                              o.end_horizontal, o.max_horizontal, o.end_vertical, o.max_3d,
                              o.epochs == 0     ? "nothing to compare"
                              : o.inside_3sigma ? "inside"
                                                : "OUTSIDE"});
        if (!std::isfinite(o.max_horizontal)) continue;
        end2 += std::isfinite(o.end_horizontal) ? o.end_horizontal * o.end_horizontal : 0.0;
        max2 += o.max_horizontal * o.max_horizontal;
        ++counted;
    }
    if (const auto n = static_cast<double>(counted); counted > 1)
        table.rows.push_back({"rms", "", std::sqrt(end2 / n), std::sqrt(max2 / n), "", "", ""});
    return table_text(table);
}

std::string separation_table(const solution::Evaluation& e) {
    if (e.separation.empty()) return {};
    ResultTable table{"", {{"", "forward minus backward"}, {"", "rms"}, {"", "inside 3 sigma", "", ".1f%"}}};
    const analysis::SeparationSummary& s = e.separated;
    table.rows = {{"north, m", s.north.rms, s.north.inside_3sigma},
                  {"east, m", s.east.rms, s.east.inside_3sigma},
                  {"up, m", s.up.rms, s.up.inside_3sigma},
                  {"heading, deg", s.heading.rms / units::deg, s.heading.inside_3sigma}};
    return table_text(table);
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
        ResultTable table =
            error_table(e.summary, fmt::format("errors against {} from {:.1f} s", e.reference == "truth" ? "truth" : "reference",
                                               b.relative(e.settled)));
        if (e.forward) {
            add_error(table, "forward horizontal, m", e.forward->horizontal);
            add_error(table, "forward 3-d, m", e.forward->three_d);
        }
        out += "\n" + table_text(table);
    }
    if (!e.outages.empty()) {
        out += "\n" + outage_table(e.outages, b.data.origin, b.smoothed() ? "outages, smoothed" : "outages");
        out += outage_table(e.outages_forward, b.data.origin, "outages, forward");
    }
    if (!b.result.alerts.empty()) out += "\nrejected fixes: diagnosis\n";
    constexpr std::size_t most_lines = 20;
    for (std::size_t i = 0; i < std::min(most_lines, b.result.alerts.size()); ++i) {
        const fusion::Alert& a = b.result.alerts[i];
        out += fmt::format("  {:>8.1f} s  {:<9} {}\n", b.relative(a.time),
                           a.kind == fusion::MeasurementKind::GnssVelocity ? "velocity" : "position", alert_text(a));
    }
    if (b.result.alerts.size() > most_lines)
        out += fmt::format("  and {} more (summary.json has them all)\n", b.result.alerts.size() - most_lines);
    if (const auto& carriers = b.result.forward.carriers; !carriers.empty()) {
        const auto whole = std::ranges::count_if(carriers, [](const fusion::CarrierRow& r) { return r.held > 0; });
        int slipped = 0;
        for (const fusion::CarrierRow& r : carriers) slipped += r.slipped;
        out += fmt::format("\ncarrier phases relative to the base: {} epochs, {} with integers, {} slips found by the filter\n",
                           carriers.size(), whole, slipped);
    }
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
    const std::string out = e.summary.epochs > 0
                                ? table_text(error_table(e.summary, fmt::format("errors at {} epochs", e.summary.epochs)))
                                : "no epoch is left after settling; give a smaller --settle\n";
    const std::string consistency = consistency_table(e);
    return consistency.empty() ? out : out + "\n" + consistency;
}

}  // namespace schuler::report
