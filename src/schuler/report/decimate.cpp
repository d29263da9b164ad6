#include "schuler/report/decimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::report {
namespace {

/// Whether all numbers are finite; without a branch, so that several are looked at in one step.
bool all_finite(std::span<const double> values) {
    constexpr std::size_t block = 1024;
    for (std::size_t begin = 0; begin < values.size(); begin += block) {
        double sum[4] = {};  // 0 * x is not a number unless x is finite
        const std::span<const double> part = values.subspan(begin, std::min(block, values.size() - begin));
        std::size_t i = 0;
        for (; i + 4 <= part.size(); i += 4)
            for (std::size_t k = 0; k < 4; ++k) sum[k] += 0.0 * part[i + k];
        for (; i < part.size(); ++i) sum[0] += 0.0 * part[i];
        if (std::isnan(sum[0] + sum[1] + sum[2] + sum[3])) return false;
    }
    return true;
}

/// The first least and the last greatest number of [first, last), of finite ones.
std::pair<std::size_t, std::size_t> extremes(std::span<const double> values, std::size_t first, std::size_t last) {
    double low[4], high[4];
    std::fill(low, low + 4, values[first]);
    std::fill(high, high + 4, values[first]);
    std::size_t i = first;
    for (; i + 4 <= last; i += 4)
        for (std::size_t k = 0; k < 4; ++k) {
            const double x = values[i + k];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    for (; i < last; ++i) {
        low[0] = values[i] < low[0] ? values[i] : low[0];
        high[0] = values[i] > high[0] ? values[i] : high[0];
    }
    const double least = *std::min_element(low, low + 4), greatest = *std::max_element(high, high + 4);
    std::size_t at = first, to = last - 1;
    while (values[at] != least) ++at;
    while (values[to] != greatest) --to;
    return {at, to};
}

/// Without gaps, which most series have none of: no list of the finite points is made, which would take longer than all the rest.
std::vector<std::size_t> decimate_whole(std::span<const std::span<const double>> channels, std::size_t buckets) {
    const std::size_t size = channels.front().size();
    std::vector<std::size_t> kept{0, size - 1};
    kept.reserve(2 * (1 + buckets * channels.size()));
    for (std::size_t b = 0; b < buckets; ++b) {
        const std::size_t first = b * size / buckets, last = (b + 1) * size / buckets;
        if (first == last) continue;
        for (const auto& channel : channels) {
            const auto [low, high] = extremes(channel, first, last);
            kept.push_back(low);
            kept.push_back(high);
        }
    }
    return kept;
}

std::vector<std::size_t> ascending(std::vector<std::size_t> kept) {
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
}

}  // namespace

std::vector<std::size_t> decimate(std::span<const std::span<const double>> channels, std::size_t max_points) {
    if (channels.empty()) return {};
    const std::size_t buckets = std::max<std::size_t>(1, max_points / (2 * channels.size()));
    if (channels.front().size() > max_points && std::all_of(channels.begin(), channels.end(), all_finite))
        return ascending(decimate_whole(channels, buckets));
    std::vector<std::size_t> finite;
    for (std::size_t i = 0; i < channels.front().size(); ++i) {
        const bool whole = std::all_of(channels.begin(), channels.end(), [i](const auto& c) { return std::isfinite(c[i]); });
        if (whole) finite.push_back(i);
    }
    if (finite.size() <= max_points) return finite;

    std::vector<std::size_t> kept{finite.front(), finite.back()};
    for (std::size_t b = 0; b < buckets; ++b) {
        const auto first = finite.begin() + static_cast<std::ptrdiff_t>(b * finite.size() / buckets);
        const auto last = finite.begin() + static_cast<std::ptrdiff_t>((b + 1) * finite.size() / buckets);
        if (first == last) continue;
        for (const auto& channel : channels) {
            const auto less = [&channel](std::size_t i, std::size_t j) { return channel[i] < channel[j]; };
            const auto [low, high] = std::minmax_element(first, last, less);
            kept.push_back(*low);
            kept.push_back(*high);
        }
    }
    return ascending(std::move(kept));
}

}  // namespace schuler::report
