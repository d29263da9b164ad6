// The solution at user-specified instants.
#include "schuler/solution/events.h"

#include "schuler/solution/bundle.h"

#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <optional>

namespace schuler::solution {

EventRows event_rows(const ResultBundle& b) {
    const std::vector<NamedInstant>& events = b.data.events;
    std::vector<std::optional<SolutionRow>> found(events.size());
    for (const fusion::InstantRow& r : b.solution().instants) found[r.index] = r.row;
    std::vector<std::size_t> order(events.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return events[i].line; });
    EventRows out;
    for (const std::size_t i : order) {
        SolutionRow row{{},          {not_given, not_given, not_given}, not_given3(), not_given3(), not_given3(), not_given3(),
                        not_given3()};
        if (found[i]) row = *found[i];
        else out.outside.push_back(events[i]);
        row.time = events[i].time;
        out.events.push_back(events[i]);
        out.rows.push_back(row);
    }
    return out;
}

void warn_of_events_outside(const ResultBundle& b, WarningLog& warnings) {
    const std::vector<NamedInstant> outside = event_rows(b).outside;
    if (outside.empty() || b.data.config.scheme == settings::Scheme::Gnss) return;
    constexpr std::size_t most = 10;
    std::string lines;
    for (std::size_t i = 0; i < std::min(most, outside.size()); ++i)
        lines += fmt::format("{}{} ({:.3f} s)", i > 0 ? ", " : "", outside[i].line, outside[i].time.seconds());
    if (outside.size() > most) lines += fmt::format(" and {} more", outside.size() - most);
    const std::vector<SolutionRow>& rows = b.solution().rows;
    warnings.add("events.outside",
                 fmt::format("{}: {} of {} times lie outside the solution ({:.3f} to {:.3f} s), their rows of events.csv are "
                             "empty: line{} {}",
                             b.data.config.output.events, outside.size(), b.data.events.size(), rows.front().time.seconds(),
                             rows.back().time.seconds(), outside.size() > 1 ? "s" : "", lines));
}

std::vector<Ignored> leave_out_chosen(LoadedDataset& data, bool has_backward) {
    fusion::Settings& f = data.config.filter;
    std::vector<Ignored> out;
    const auto tell = [&](bool given, const char* key) {
        if (given) out.push_back({key, "it belongs to `schuler process` and `run`"});
    };
    tell(!f.output_lever_arm_b.isZero(0.0), "output.lever_arm_m");
    tell(!data.events.empty(), "output.events");
    tell(f.backward && !has_backward, "filter.backward");
    f.output_lever_arm_b.setZero();
    f.output_instants.clear();
    f.backward = f.backward && has_backward;
    data.events.clear();
    return out;
}

}  // namespace schuler::solution
