#include "schuler/inspect/detail/robust.h"

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {

double robust_sigma(const std::vector<double>& values) {
    const double middle = median(values);
    std::vector<double> distance;
    distance.reserve(values.size());
    for (const double v : values) distance.push_back(std::abs(v - middle));
    return 1.4826 * median(std::move(distance));
}

Minimum lowest_point(double first, double step, std::span<const double> values) {
    const auto lowest = std::min_element(values.begin(), values.end());
    if (lowest == values.end()) return {};
    const std::ptrdiff_t i = lowest - values.begin();
    Minimum result{first + step * static_cast<double>(i), *lowest, false};
    if (i == 0 || i + 1 == std::ssize(values)) return result;
    const double left = lowest[-1], right = lowest[1];
    const double curvature = left - 2.0 * *lowest + right;
    result.inside = true;
    if (curvature > 0.0) {
        const double shift = 0.5 * (left - right) / curvature;
        result.at += step * shift;
        result.value -= 0.25 * (left - right) * shift;
    }
    return result;
}

namespace {

/// Minima other than the lowest that the curves do not tell from it: the difference is within what its scatter over the curves leaves
/// open, or too small a part of the depth for the model behind the curves.
std::vector<double> rivals_of(double first, double step, const std::vector<std::vector<double>>& curves,
                              const std::vector<double>& total) {
    constexpr double sigmas = 4.0, of_depth = 0.05;
    std::vector<double> rivals;
    const auto lowest = static_cast<std::size_t>(std::min_element(total.begin(), total.end()) - total.begin());
    const double n = static_cast<double>(curves.size());
    double mean = 0.0;
    for (const double v : total) mean += v / static_cast<double>(total.size());
    for (std::size_t i = 1; i + 1 < total.size(); ++i) {
        if (i == lowest || total[i] > total[i - 1] || total[i] >= total[i + 1]) continue;
        const double higher = total[i] - total[lowest];
        double square = 0.0;
        for (const std::vector<double>& curve : curves) square += std::pow(curve[i] - curve[lowest] - higher / n, 2);
        const double scatter = std::sqrt(square * n / (n - 1.0));  // of the sum
        if (higher < std::max(sigmas * scatter, of_depth * (mean - total[lowest])))
            rivals.push_back(
                lowest_point(first + step * static_cast<double>(i - 1), step, std::span(total).subspan(i - 1, 3)).at);
    }
    return rivals;
}

}  // namespace

double Agreement::nearest_to(double expected) const {
    double nearest = at;
    for (const double rival : rivals)
        if (std::abs(rival - expected) < std::abs(nearest - expected)) nearest = rival;
    return nearest;
}

Agreement agree(double first, double step, const std::vector<std::vector<double>>& curves) {
    Agreement result;
    result.stretches = static_cast<int>(curves.size());
    if (curves.size() < 3) return result;
    std::vector<double> total(curves.front().size(), 0.0);
    for (const std::vector<double>& curve : curves) {
        for (std::size_t i = 0; i < total.size(); ++i) total[i] += curve[i];
    }
    const Minimum all = lowest_point(first, step, total);
    result.at = all.at;
    result.found = all.inside;
    double mean = 0.0;
    for (const double v : total) mean += v / static_cast<double>(total.size());
    result.contrast = all.value > 0.0 ? (mean - all.value) / all.value : 0.0;
    result.rivals = rivals_of(first, step, curves, total);

    std::vector<double> without(total.size());
    std::vector<double> places;
    double place_mean = 0.0;
    for (const std::vector<double>& curve : curves) {
        for (std::size_t i = 0; i < total.size(); ++i) without[i] = total[i] - curve[i];
        places.push_back(lowest_point(first, step, without).at);
        place_mean += places.back() / static_cast<double>(curves.size());
    }
    double sum = 0.0;
    for (const double place : places) sum += (place - place_mean) * (place - place_mean);
    const double n = static_cast<double>(curves.size());
    result.sigma = std::sqrt(sum * (n - 1.0) / n);
    return result;
}

}  // namespace schuler::inspect::detail
