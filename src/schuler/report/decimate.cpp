#include "schuler/report/decimate.h"

#include <algorithm>
#include <cmath>

namespace schuler::report {

std::vector<std::size_t> decimate(std::span<const std::span<const double>> channels, std::size_t max_points) {
    if (channels.empty()) return {};
    std::vector<std::size_t> finite;
    for (std::size_t i = 0; i < channels.front().size(); ++i) {
        const bool whole = std::all_of(channels.begin(), channels.end(), [i](const auto& c) { return std::isfinite(c[i]); });
        if (whole) finite.push_back(i);
    }
    if (finite.size() <= max_points) return finite;

    const std::size_t buckets = std::max<std::size_t>(1, max_points / (2 * channels.size()));
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
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
}

}  // namespace schuler::report
