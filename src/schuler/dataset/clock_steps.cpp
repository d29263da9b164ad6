#include "schuler/dataset/clock_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace schuler::dataset {
namespace {

/// The first sample after the gap of a step.
template <class Sample>
std::optional<Time> end_of_hole(const std::vector<Sample>& log, const inspect::ClockStep& step) {
    constexpr double same = 1e-3, about = 60.0;  // s: rows without values at the beginning may have been omitted
    std::optional<Time> end;
    double nearest = about;
    for (std::size_t i = 1; i < log.size(); ++i) {
        if (std::abs((log[i].time - log[i - 1].time).seconds() - step.hole) > same) continue;
        const double off = std::abs((log[i - 1].time - log.front().time).seconds() - step.after);
        if (off >= nearest) continue;
        nearest = off;
        end = log[i].time;
    }
    return end;
}

template <class Sample>
void move_back(std::vector<Sample>& log, Time from, double seconds) {
    for (Sample& s : log)
        if (s.time >= from) s.time = s.time + Duration::from_seconds(-seconds);
}

/// True if a log has no sample in the gap except near its ends, and continues after it.
template <class Sample>
bool shares(const std::vector<Sample>& log, Time end, const inspect::ClockStep& step) {
    const Time begin = end + Duration::from_seconds(-step.hole), late = end + Duration::from_seconds(-0.1 * step.seconds);
    const auto inside = std::ranges::lower_bound(log, begin + Duration::from_seconds(0.5 * step.seconds), {}, &Sample::time);
    return inside != log.end() && inside->time >= late && inside != log.begin();
}

}  // namespace

void put_clock_steps_back(Recording& recording, const std::vector<inspect::ClockStep>& steps) {
    for (const inspect::ClockStep& step : steps) {
        const std::optional<Time> end = step.imu ? end_of_hole(recording.imu, step) : end_of_hole(recording.gnss, step);
        if (!end) continue;
        if (!step.imu) {
            move_back(recording.gnss, *end, step.seconds);
            continue;
        }
        move_back(recording.imu, *end, step.seconds);
        for_each_instrument_log(recording, [&]<class Sample>(std::vector<Sample>& log) {
            if constexpr (!std::is_same_v<Sample, HeadingSample>)  // two antennas: the receiver's clock
                if (shares(log, *end, step)) move_back(log, *end, step.seconds);
        });
    }
}

}  // namespace schuler::dataset
