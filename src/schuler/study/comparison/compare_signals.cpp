// Signals tracked by a receiver at correlator level on a compared flight.
#include "schuler/study/comparison/compare.h"

#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/study/comparison/compare_windows.h"

#include <algorithm>
#include <cmath>

namespace schuler::study {

void add_signal_statistics(WindowStatistics& out, const settings::CompareWindow& window,
                           const std::vector<scenario::ReceiverRow>& rows, Time origin) {
    constexpr int enough = 4;
    constexpr double hold = 1.0;  // s
    double since = not_given;
    for (const scenario::ReceiverRow& row : rows) {
        const double t = (row.time - origin).seconds();
        const bool inside = t >= window.start - same_instant && t <= window.end + same_instant;
        if (inside && row.heard >= enough && row.code >= enough) out.held = std::fmin(out.held, row.cn0);
        if (t < window.end - same_instant || std::isfinite(out.back)) continue;
        const bool follows = row.heard > 0 && row.code >= std::min(enough, row.heard);
        if (!follows) since = not_given;
        else if (!std::isfinite(since)) since = t <= window.end + same_instant ? window.end : t;
        if (t - since >= hold - same_instant) out.back = since - window.end;
    }
}

std::vector<report::Panel> signal_panels(const Comparison& c, Time origin) {
    using report::Ink;
    constexpr Ink inks[] = {Ink::Blue, Ink::Vermillion, Ink::Green, Ink::Purple, Ink::Orange, Ink::Sky};
    report::Panel strength{"strength of the signals, jammers included", "time, s", "C/N0, dB-Hz"};
    report::Panel jammed{"jammers to signal", "time, s", "J/S, dB"};
    report::Panel followed{"satellites followed", "time, s", "number"};
    std::vector<const ComparedRun*> drawn;
    for (const ComparedRun& run : c.runs) {
        if (run.receiver.empty() || run.satellites != c.runs.front().satellites) continue;
        // An unaided receiver is identical for several schemes: one line for all of them.
        const auto same = std::ranges::find_if(drawn, [&run](const ComparedRun* other) {
            return std::ranges::equal(other->receiver, run.receiver, {}, &scenario::ReceiverRow::code,
                                      &scenario::ReceiverRow::code);
        });
        if (same != drawn.end()) {
            followed.series[static_cast<std::size_t>(same - drawn.begin())].name += std::string(" = ") + run.scheme->name;
            continue;
        }
        report::Series line{run.scheme->title, {}, {}, inks[drawn.size() % std::size(inks)]};
        for (const scenario::ReceiverRow& row : run.receiver) {
            line.x.push_back((row.time - origin).seconds());
            line.y.push_back(row.code);
        }
        followed.series.push_back(std::move(line));
        drawn.push_back(&run);
    }
    if (drawn.empty()) return {};
    report::Series cn0{"", followed.series.front().x, {}, Ink::Text}, js = cn0;
    for (const scenario::ReceiverRow& row : drawn.front()->receiver) {
        cn0.y.push_back(row.cn0);
        js.y.push_back(row.jammed);
    }
    const bool any_jammed = std::ranges::any_of(js.y, [](double y) { return std::isfinite(y); });
    strength.series.push_back(std::move(cn0));
    jammed.series.push_back(std::move(js));
    strength.x_limits = jammed.x_limits = followed.x_limits = {0.0, c.duration};
    followed.height = 260;
    return any_jammed ? std::vector{strength, jammed, followed} : std::vector{strength, followed};
}

}  // namespace schuler::study
