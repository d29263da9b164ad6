// What a receiver at correlator level followed on a compared flight.
#include "schuler/app/compare.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {

void add_signal_statistics(WindowStatistics& out, const CompareWindow& window, const std::vector<ReceiverRow>& rows, Time origin) {
    constexpr int enough = 4;
    constexpr double hold = 1.0;   // s
    double since = not_given;
    for (const ReceiverRow& row : rows) {
        const double t = (row.time - origin).seconds();
        if (t >= window.start && t <= window.end && row.heard >= enough && row.code >= enough) out.held = std::fmin(out.held, row.cn0);
        if (t < window.end + 1e-6 || std::isfinite(out.back)) continue;
        const bool follows = row.heard > 0 && row.code >= std::min(enough, row.heard);
        if (!follows) since = not_given;
        else if (!std::isfinite(since)) since = t;
        if (t - since >= hold) out.back = since - window.end;
    }
}

std::vector<report::Panel> signal_panels(const Comparison& c, Time origin) {
    using report::Ink;
    constexpr Ink inks[] = {Ink::Blue, Ink::Vermillion, Ink::Green, Ink::Purple, Ink::Orange, Ink::Sky};
    report::Panel strength{"strength of the signals, jammers included", "time, s", "C/N0, dB-Hz"};
    report::Panel jammed{"jammers to signal", "time, s", "J/S, dB"};
    report::Panel followed{"satellites followed", "time, s", "number"};
    for (const ComparedRun& run : c.runs) {
        if (run.receiver.empty() || run.satellites != c.runs.front().satellites) continue;
        // a receiver that gets no help is the same for several schemes
        const bool again = std::ranges::any_of(c.runs, [&](const ComparedRun& other) {
            return &other < &run && std::ranges::equal(other.receiver, run.receiver, {}, &ReceiverRow::code, &ReceiverRow::code);
        });
        if (again) continue;
        report::Series line{run.scheme->title, {}, {}, inks[followed.series.size() % std::size(inks)]};
        report::Series cn0{"", {}, {}, Ink::Text}, js = cn0;
        for (const ReceiverRow& row : run.receiver) {
            line.x.push_back((row.time - origin).seconds());
            line.y.push_back(row.code);
            cn0.x.push_back(line.x.back());
            cn0.y.push_back(row.cn0);
            js.y.push_back(std::isfinite(row.jammed) ? row.jammed : not_given);
        }
        followed.series.push_back(std::move(line));
        if (!strength.series.empty()) continue;
        js.x = cn0.x;
        jammed.series.push_back(std::move(js));
        strength.series.push_back(std::move(cn0));
    }
    if (followed.series.empty()) return {};
    followed.series.front().name += ", and all without help";
    strength.x_limits = jammed.x_limits = followed.x_limits = {0.0, c.duration};
    followed.height = 260;
    if (std::ranges::any_of(jammed.series.front().y, [](double y) { return std::isfinite(y); })) return {strength, jammed, followed};
    return {strength, followed};
}

}  // namespace schuler::app
