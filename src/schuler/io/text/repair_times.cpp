#include "schuler/io/text/repair_times.h"

#include <algorithm>
#include <cstdlib>

namespace schuler::io {
namespace {

constexpr std::int64_t one_second = 1'000'000'000, day = 86'400 * one_second, week = 7 * day;
/// Largest number of consecutive stray rows; more are a pause, or another log.
constexpr std::size_t longest_run = 5;

std::int64_t median_step(const std::vector<std::int64_t>& times) {
    std::vector<std::int64_t> steps;
    steps.reserve(times.size());
    for (std::size_t i = 1; i < times.size(); ++i)
        if (times[i] > times[i - 1]) steps.push_back(times[i] - times[i - 1]);
    if (steps.empty()) return 0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

}  // namespace

TimeRepair repair_times(std::vector<std::int64_t>& times) {
    TimeRepair repair;
    if (times.size() < 3) return repair;
    constexpr std::int64_t steps = 20;
    const std::int64_t limit = std::max(one_second, steps * std::min(median_step(times), INT64_MAX / steps));
    const auto near = [&](std::int64_t from, std::int64_t to) { return std::abs(to - from) <= limit; };
    // a first row far from the second and the third, which are close to each other and before it
    std::size_t i = 1;
    if (!near(times[0], times[1]) && near(times[1], times[2]) && times[0] > times[1] && week - (times[0] - times[1]) > limit &&
        day - (times[0] - times[1]) > limit) {
        repair.strays.push_back(0);
        i = 2;
    }
    std::int64_t last = times[i - 1], shift = 0;
    for (; i < times.size(); ++i) {
        times[i] += shift;
        if (near(last, times[i])) {
            last = std::max(last, times[i]);
            continue;
        }
        // back among the others within a few rows: those between are stray
        std::size_t k = i + 1;
        while (k < times.size() && k <= i + longest_run && !near(last, times[k] + shift)) ++k;
        if (k < times.size() && k <= i + longest_run) {
            for (std::size_t s = i; s < k; ++s) repair.strays.push_back(s);
            for (std::size_t s = i + 1; s < k; ++s) times[s] += shift;
            i = k - 1;
            continue;
        }
        const bool alone = i + 1 == times.size();
        for (const std::int64_t period : {week, day}) {
            if (alone || !near(last, times[i] + period) || last % period < period - limit - one_second) continue;
            times[i] += period;
            shift += period;
            repair.period = period;
            ++repair.rollovers;
            break;
        }
        last = times[i];
    }
    return repair;
}

}  // namespace schuler::io
