#include "schuler/io/text/lonely_samples.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace schuler::io {

namespace {

std::vector<std::size_t> lonely_of(const std::vector<double>& sizes, double least) {
    constexpr std::size_t enough = 100;
    constexpr double of_most = 20.0, of_neighbours = 10.0;
    std::vector<double> sorted;
    sorted.reserve(sizes.size());
    std::ranges::copy_if(sizes, std::back_inserter(sorted), [](double s) { return std::isfinite(s); });
    if (sorted.size() < enough) return {};
    const auto high = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() - 1 - sorted.size() / 100);
    std::ranges::nth_element(sorted, high);
    const double limit = std::max(least, of_most * *high);
    std::vector<std::size_t> lonely;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        if (!(sizes[i] > limit)) continue;
        const double before = i > 0 ? sizes[i - 1] : 0.0, after = i + 1 < sizes.size() ? sizes[i + 1] : 0.0;
        if (sizes[i] > of_neighbours * before && sizes[i] > of_neighbours * after) lonely.push_back(i);
    }
    if (100 * lonely.size() > sizes.size()) lonely.clear();
    return lonely;
}

}  // namespace

std::vector<std::size_t> lonely_samples(const std::vector<double>& rates, const std::vector<double>& forces) {
    constexpr double rate = 100.0, force = 400.0;  // rad/s, m/s^2
    std::vector<std::size_t> either;
    std::ranges::set_union(lonely_of(rates, rate), lonely_of(forces, force), std::back_inserter(either));
    return either;
}

}  // namespace schuler::io
