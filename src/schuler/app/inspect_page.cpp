#include "schuler/app/inspect_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::app {
namespace {

using report::Ink;
using report::Panel;
using report::Series;

Ink ink_of(const std::string& kind) {
    if (kind.find("imu") != std::string::npos) return Ink::Blue;
    if (kind == "baro") return Ink::Sky;
    if (kind == "mag") return Ink::Purple;
    if (kind == "trajectory" || kind.find("reference") != std::string::npos) return Ink::Muted;
    return Ink::Green;
}

/// A file with its bar on the common axis.
struct Bar {
    const inspect::FileReport* file;
    double shift, start, stop;
};

bool is_imu(const inspect::FileReport& f) { return f.chosen && f.kind.find("imu") != std::string::npos; }

/// Files converted to the IMU's time axis: those that share its clock are shifted too.
std::vector<Bar> bars_of(const inspect::InspectReport& found) {
    std::vector<Bar> bars;
    const auto imu = std::ranges::find_if(found.files, is_imu);
    const double shift = found.motion.imu_shift;
    for (const inspect::FileReport& f : found.files) {
        if (f.rows == 0 || !std::isfinite(f.start_s) || !std::isfinite(f.stop_s)) continue;
        const bool of_imu = imu != found.files.end() && shift != 0.0 && f.start_s <= imu->stop_s && f.stop_s >= imu->start_s;
        const double s = of_imu ? shift : 0.0;
        bars.push_back({&f, s, f.start_s + s, f.stop_s + s});
    }
    return bars;
}

/// Bars close to each other in time: unrelated clocks are drawn separately.
std::vector<std::vector<Bar>> clusters(std::vector<Bar> bars) {
    constexpr double apart = 86'400.0;  // s
    std::ranges::stable_sort(bars, {}, &Bar::start);
    std::vector<std::vector<Bar>> out;
    double end = -std::numeric_limits<double>::infinity();
    for (const Bar& b : bars) {
        if (out.empty() || b.start > end + apart) out.emplace_back();
        end = std::max(out.back().size() > 0 ? end : b.stop, b.stop);
        out.back().push_back(b);
    }
    for (auto& cluster : out)  // in the order found
        std::ranges::stable_sort(cluster, {}, [](const Bar& b) { return b.file; });
    return out;
}

Panel bars_panel(const std::vector<Bar>& bars, const inspect::Motion& motion, double zero) {
    Panel p;
    p.title = "when each stream has data; squares: gaps";
    p.x_label = "time, s";
    p.y_label = "stream";
    const auto rows = static_cast<double>(bars.size());
    p.y_limits = std::pair{0.4, rows + 0.95};
    p.height = static_cast<int>(70 + 44 * bars.size());
    Series gaps{.name = "gaps", .x = {}, .y = {}, .ink = Ink::Vermillion, .mark = report::Mark::Squares};
    double y = rows;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const Bar& b : bars) {
        const inspect::FileReport& f = *b.file;
        Series s{.name = "", .x = {b.start - zero}, .y = {y}, .ink = ink_of(f.kind), .width = f.chosen ? 8.0 : 4.0};
        for (const auto& hole : f.holes) {
            const double from = hole.start + b.shift - zero;
            s.x.insert(s.x.end(), {from, from + 0.5 * hole.length, from + hole.length});
            s.y.insert(s.y.end(), {y, std::nan(""), y});
            gaps.x.push_back(from + 0.5 * hole.length);
            gaps.y.push_back(y);
        }
        s.x.push_back(b.stop - zero);
        s.y.push_back(y);
        p.series.push_back(std::move(s));
        p.row_names.emplace_back(y, fmt::format("{}: {}, {:.4g} Hz, {} rows, {} gap{}{}", f.path, f.kind, f.rate_hz, f.rows,
                                                f.gaps, f.gaps == 1 ? "" : "s", f.chosen ? "" : " (not used)"));
        first = std::min(first, b.start), last = std::max(last, b.stop);
        y -= 1.0;
    }
    if (!gaps.x.empty()) p.series.push_back(std::move(gaps));
    for (const auto& [from, to] : motion.still)
        if (to > first && from < last) p.spans.push_back({from - zero, to - zero, "still", false});
    return p;
}

/// Two panels over the time of the fixes, and the track from above.
void add_track(const inspect::Motion& m, double zero, report::Section& section) {
    if (m.t.size() < 2) return;
    Panel track{
        .title = "track of the fixes", .x_label = "east, m", .y_label = "north, m", .time_axis = false, .equal_axes = true};
    track.series.push_back({.name = "fixes", .x = m.east, .y = m.north, .ink = Ink::Blue});
    track.series.push_back(
        {.name = "first", .x = {m.east.front()}, .y = {m.north.front()}, .ink = Ink::Green, .mark = report::Mark::Squares});
    track.series.push_back(
        {.name = "last", .x = {m.east.back()}, .y = {m.north.back()}, .ink = Ink::Vermillion, .mark = report::Mark::Squares});
    std::vector<double> t, speed;
    for (std::size_t i = 1; i < m.t.size(); ++i) {
        const double dt = m.t[i] - m.t[i - 1];
        t.push_back(0.5 * (m.t[i] + m.t[i - 1]) - zero);
        speed.push_back(dt > 0.0 ? std::hypot(m.north[i] - m.north[i - 1], m.east[i] - m.east[i - 1]) / dt : std::nan(""));
    }
    Panel along{.title = "speed between fixes", .x_label = "time, s", .y_label = "speed, m/s"};
    along.series.push_back({.name = "", .x = t, .y = speed, .ink = Ink::Blue});
    Panel height{.title = "height above the first fix", .x_label = "time, s", .y_label = "height, m"};
    std::vector<double> at = m.t;
    for (double& x : at) x -= zero;
    height.series.push_back({.name = "", .x = std::move(at), .y = m.up, .ink = Ink::Blue});
    section.groups.push_back({.title = "", .panels = {std::move(track), std::move(along), std::move(height)}, .tables = {}});
}

report::Section findings_of(const inspect::InspectReport& found) {
    report::TableBlock findings{.title = "", .columns = {"what", "value", "why"}, .rows = {}},
        problems{.title = "", .columns = {"", "where", "what", "remedy"}, .rows = {}};
    for (const inspect::Finding& f : found.findings) findings.rows.push_back({f.key, f.value, f.why});
    const auto add = [&](const std::string& where, const std::vector<inspect::Problem>& list) {
        for (const inspect::Problem& p : list)
            problems.rows.push_back({std::string(inspect::name_of(p.level)), where, p.text, p.hint});
    };
    add("", found.problems);
    for (const inspect::FileReport& f : found.files) add(f.path, f.problems);
    report::Section s{.title = "Found in the data", .intro = "", .groups = {}};
    if (!findings.rows.empty()) s.groups.push_back({.title = "", .panels = {}, .tables = {std::move(findings)}});
    if (!problems.rows.empty()) s.groups.push_back({.title = "Notes", .panels = {}, .tables = {std::move(problems)}});
    return s;
}

report::Section files_of(const inspect::InspectReport& found) {
    report::TableBlock table{
        .title = "",
        .columns = {"file or stream", "kind", "used", "rows", "rate, Hz", "from, s", "to, s", "gaps", "holds"},
        .rows = {}};
    report::TableBlock columns{.title = "", .columns = {"file or stream", "column: what it was taken for"}, .rows = {}};
    for (const inspect::FileReport& f : found.files) {
        std::string holds;
        for (const std::string& line : f.contents) holds += (holds.empty() ? "" : "; ") + line;
        const bool rows = f.rows > 0;
        table.rows.push_back({f.path, f.kind, f.chosen ? "yes" : "", rows ? std::to_string(f.rows) : "",
                              rows ? report::number(f.rate_hz) : "", rows ? fmt::format("{:.3f}", f.start_s) : "",
                              rows ? fmt::format("{:.3f}", f.stop_s) : "", rows ? std::to_string(f.gaps) : "", holds});
        for (const std::string& line : f.understood) columns.rows.push_back({f.path, line});
    }
    report::Section s{.title = "Files", .intro = "", .groups = {{.title = "", .panels = {}, .tables = {std::move(table)}}}};
    if (!columns.rows.empty()) s.groups.push_back({.title = "Columns and units", .panels = {}, .tables = {std::move(columns)}});
    return s;
}

}  // namespace

report::ReportInput inspect_page(const inspect::InspectReport& found, const std::string& version) {
    report::ReportInput page;
    page.title = found.path;
    page.subtitle = "what is in it, found from the data alone";
    page.version = version;
    page.settings = found.dataset_toml;
    report::Section time{.title = "Time", .intro = "", .groups = {}};
    double zero = std::nan("");
    for (const std::vector<Bar>& bars : clusters(bars_of(found))) {
        double start = std::numeric_limits<double>::infinity();
        for (const Bar& b : bars) start = std::min(start, b.start);
        const bool fixes = !found.motion.t.empty() && found.motion.t.front() >= start - 1.0;
        if (fixes || !std::isfinite(zero)) zero = start;
        time.groups.push_back(
            {.title = fmt::format("from {:.3f} s", start), .panels = {bars_panel(bars, found.motion, start)}, .tables = {}});
    }
    if (time.groups.empty()) time.intro = "Nothing in it has times.";
    else if (time.groups.size() > 1) time.intro = "The clocks of these groups have nothing in common.";
    if (std::isfinite(zero)) add_track(found.motion, zero, time);
    page.sections = {std::move(time), findings_of(found), files_of(found)};
    return page;
}

}  // namespace schuler::app
