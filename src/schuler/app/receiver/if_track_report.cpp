#include "schuler/app/receiver/if_recording.h"
#include "schuler/report/outcome.h"
#include "schuler/report/report.h"
#include "schuler/report/result_table.h"
#include "schuler/study/parts.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::app {
namespace {

using receiver::ChannelSample;
using receiver::SatelliteRecord;

/// "-" if not finite.
report::Cell fixed(double x, int digits) {
    return std::isfinite(x) ? report::Cell(fmt::format("{:.{}f}", x, digits)) : report::Cell();
}

/// The last second in phase, or the result of the search with its lower resolution.
std::vector<report::Cell> cells_of(const SatelliteRecord& r, int search_periods) {
    const receiver::Acquired& a = r.acquired;
    const std::string name = fmt::format("G{:02}", r.prn);
    const char* state = !r.tracked ? "lost" : std::isfinite(r.locked_at) && r.locked ? "locked" : "not locked";
    if (!std::isfinite(r.locked_at))
        return {name,
                fixed(a.replica.carrier_frequency, 0),
                fixed(-a.replica.code_phase, 1),
                fixed(receiver::db_from_cn0(a.cn0(search_periods)), 0),
                fixed(r.found_at, 2),
                {},
                {},
                {},
                {},
                state};
    return {name,
            fixed(r.last.doppler, 2),
            fixed(r.last.code_delay, 3),
            fixed(receiver::db_from_cn0(r.last.cn0), 1),
            fixed(r.last.time, 2),
            fixed(r.locked_at, 2),
            r.symbols,
            r.changes,
            static_cast<double>(r.edge_changes) / static_cast<double>(r.dump_changes),
            state};
}

report::ResultTable table_of_satellites(const TrackedRecording& run) {
    report::ResultTable table =
        report::table_for_people("", {"satellite", "Doppler, Hz", "code delay, chips", "C/N0, dB-Hz", "at, s", "phase lock, s",
                                      "symbols", "changes", "at edges", "state"});
    table.columns[8].format = ".0f%";
    for (const SatelliteRecord& r : run.satellites)
        if (r.found) table.rows.push_back(cells_of(r, run.search_periods));
    return table;
}

report::Ink ink_of(std::size_t i) {
    using report::Ink;
    constexpr std::array inks{Ink::Blue, Ink::Vermillion, Ink::Green, Ink::Purple, Ink::Orange, Ink::Sky, Ink::Text, Ink::Muted};
    return inks[i % inks.size()];
}

/// One line per satellite over time; the ninth and further ones are dashed.
template <class Value>
report::Panel over_time(const TrackedRecording& run, const std::vector<int>& prns, const std::string& title,
                        const std::string& unit, Value value) {
    report::Panel panel{title, "time, s", unit};
    for (std::size_t i = 0; i < prns.size(); ++i) {
        report::Series line{fmt::format("G{:02}", prns[i]), {}, {}, ink_of(i), i < 8 ? report::Mark::Line : report::Mark::Dashed};
        for (const ChannelSample& s : run.decimated) {
            if (s.prn != prns[i]) continue;
            line.x.push_back(s.time);
            line.y.push_back(value(s));
        }
        panel.series.push_back(std::move(line));
    }
    return panel;
}

report::Panel prompts_in_phase(const TrackedRecording& run, const std::vector<int>& prns) {
    report::Panel panel{"Prompt over 20 ms, while in phase", "I, noise has 1", "Q, noise has 1"};
    panel.time_axis = false;
    panel.height = 260;
    for (std::size_t i = 0; i < prns.size(); ++i) {
        report::Series dots{
            fmt::format("G{:02}", prns[i]), {}, {}, ink_of(i), i < 8 ? report::Mark::Dots : report::Mark::Squares};
        for (const ChannelSample& s : run.decimated) {
            if (s.prn != prns[i] || !s.locked) continue;
            dots.x.push_back(s.prompt.real());
            dots.y.push_back(s.prompt.imag());
        }
        panel.series.push_back(std::move(dots));
    }
    return panel;
}

}  // namespace

std::string name_of(receiver::TrackState state, bool locked) {
    switch (state) {
        case receiver::TrackState::Idle: return "idle";
        case receiver::TrackState::PullIn: return "pull-in";
        case receiver::TrackState::Phase: return locked ? "locked" : "locking";
        case receiver::TrackState::CodeOnly: return "code";
        case receiver::TrackState::Lost: break;
    }
    return "lost";
}

std::string tracking_table(const TrackedRecording& run) {
    std::string out = report::table_text(table_of_satellites(run));
    std::vector<std::string> missing;
    for (const SatelliteRecord& r : run.satellites)
        if (!r.found) missing.push_back(fmt::format("G{:02}", r.prn));
    if (!missing.empty()) out += fmt::format("not found: {}\n", fmt::join(missing, " "));
    return out +
           "Doppler, code delay and C/N0 are means over the last second in phase, about the time beside them;\nwithout phase "
           "lock they are those of the search, to 250 Hz and 2 dB.\n";
}

void write_tracking_report(report::Outcome& out, const TrackedRecording& run, const std::string& version) {
    std::vector<int> prns;
    std::size_t locked = 0;
    for (const SatelliteRecord& r : run.satellites) {
        if (!r.found) continue;
        prns.push_back(r.prn);
        locked += r.locked ? 1 : 0;
    }
    report::ReportInput page{"Tracking of a recording", run.title};
    page.version = version;
    page.warnings = out.warnings;
    page.cards = {{"satellites found", fmt::format("{}", prns.size()), fmt::format("of {} searched for", run.satellites.size())},
                  {"in phase at the end", fmt::format("{}", locked)},
                  {"recording", fmt::format("{:.4g} s", run.seconds)}};
    report::Section section{
        "Satellites", "GPS L1 C/A, found by FFT and tracked; figures of the table are means over the last second in phase."};
    section.groups.push_back({"", {}, {report::table_block(table_of_satellites(run))}});
    report::Section tracking{"Tracking", "Every symbol's duration, from the search on."};
    tracking.groups.push_back(
        {"",
         {over_time(run, prns, "C/N0", "dB-Hz", [](const ChannelSample& s) { return receiver::db_from_cn0(s.cn0); }),
          over_time(run, prns, "Doppler", "Hz", [](const ChannelSample& s) { return s.doppler; }),
          over_time(run, prns, "Phase lock detector", "1: in phase", [](const ChannelSample& s) { return s.phase_lock; }),
          prompts_in_phase(run, prns)},
         {}});
    page.sections = {section, tracking};
    study::write_report(out, out.folder, page);
}

}  // namespace schuler::app
