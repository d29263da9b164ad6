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

/// Takes back excursions of the clock: see repair_times. Every step back is paired with the step ahead before it, or after it.
void take_back_excursions(std::vector<std::int64_t>& times, std::int64_t usual, TimeRepair& repair) {
    constexpr std::int64_t longest = 1'000'000'000 * one_second;  // beyond: another epoch, and sums would overflow
    if (usual <= 0 || usual > longest) return;
    const std::size_t n = times.size();
    const auto excess = [&](std::size_t i) { return times[i] - times[i - 1] - usual; };
    for (std::size_t back = 1; back < n; ++back) {
        if (times[back] >= times[back - 1] - usual / 2) continue;
        const std::int64_t size = -excess(back);
        if (size <= 0 || size > longest) continue;
        // The nearest step of about this size on either side: it ends the interval, whether it matches or not.
        const auto is_step = [&](std::size_t i) { return excess(i) < -usual || excess(i) >= size / 2; };
        const auto matches = [&](std::size_t i) { return std::abs(excess(i) - size) <= usual / 2; };
        std::size_t before = back - 1, after = back + 1;
        while (before > 0 && !is_step(before)) --before;
        while (after < n && !is_step(after)) ++after;
        const auto held = [&](std::size_t first, std::size_t end) { return end - first > longest_run && 2 * (end - first) < n; };
        const bool ahead = before > 0 && matches(before) && held(before, back),
                   behind = after < n && matches(after) && held(back, after);
        if (ahead == behind) continue;  // no pair, or no telling which rows are off
        const std::size_t first = ahead ? before : back, end = ahead ? back : after;
        const std::int64_t step = (ahead ? 1 : -1) * ((ahead ? excess(before) : excess(after)) + size) / 2;
        for (std::size_t i = first; i < end; ++i) times[i] -= step;
        if (repair.excursions++ == 0) repair.first_away = first;
        repair.away += end - first;
        repair.step = step;
    }
}

}  // namespace

TimeRepair repair_times(std::vector<std::int64_t>& times) {
    TimeRepair repair;
    if (times.size() < 3) return repair;
    take_back_excursions(times, median_step(times), repair);
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

std::size_t spread_equal_times(std::vector<std::int64_t>& times) {
    struct Run {
        std::size_t first, count;
    };
    std::vector<Run> runs;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (runs.empty() || times[i] != times[i - 1]) runs.push_back({i, 1});
        else ++runs.back().count;
    }
    constexpr std::size_t least_runs = 5;
    if (runs.size() < least_runs) return 0;
    const std::int64_t step = median_step(times);
    std::vector<std::size_t> counts;
    std::size_t on_steps = 0;
    for (std::size_t k = 0; k < runs.size(); ++k) {
        counts.push_back(runs[k].count);
        if (k > 0 && (times[runs[k].first] - times[runs[k - 1].first]) % step == 0) ++on_steps;
    }
    std::ranges::sort(counts);
    const std::size_t usual = counts[counts.size() / 2];
    const auto alike = [&](std::size_t count) { return 4 * count >= 3 * usual && 4 * count <= 5 * usual + 3; };
    const auto regular = static_cast<std::size_t>(std::ranges::count_if(counts, alike));
    // A coarse clock gives every run about the same number of rows; single repeated stamps are something else.
    if (usual < 2 || 10 * regular < 9 * runs.size() || 10 * on_steps < 9 * (runs.size() - 1)) return 0;
    std::size_t changed = 0;
    for (std::size_t k = 0; k < runs.size(); ++k) {
        const auto [first, count] = runs[k];
        const bool end = k == 0 || k + 1 == runs.size();
        const auto parts = static_cast<std::int64_t>(end ? std::max(usual, count) : count);
        const std::int64_t late = k == 0 ? parts - static_cast<std::int64_t>(count) : 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t shift = step * (static_cast<std::int64_t>(i) + late) / parts;
            if (shift != 0) ++changed;
            times[first + i] += shift;
        }
    }
    return changed;
}

}  // namespace schuler::io
