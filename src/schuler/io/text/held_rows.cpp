#include "schuler/io/text/held_rows.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace schuler::io {

std::vector<std::size_t> held_rows(const std::vector<bool>& repeats) {
    std::vector<double> lengths;  // rows from one change to the next
    std::vector<std::size_t> held;
    for (std::size_t i = 0, last = 0; i < repeats.size(); ++i) {
        if (i > 0 && repeats[i]) {
            held.push_back(i);
            continue;
        }
        if (i > 0 && last > 0) lengths.push_back(static_cast<double>(i - last));
        last = i;
    }
    constexpr std::ptrdiff_t fewest = 10;
    if (std::ssize(lengths) < fewest) return {};
    const double usual = math::median(lengths);
    if (usual < 2.0) return {};
    // A pause is a multiple of the interval; a change in between would be rounding.
    constexpr double row = 1.0, share = 0.1, nearly_all = 0.8;
    const double tolerance = std::max(row, share * usual);
    const auto steady = std::ranges::count_if(lengths, [&](double n) {
        const double times = std::max(1.0, std::round(n / usual));
        return std::abs(n - times * usual) <= std::max(row, times * tolerance) && (times == 1.0 || usual >= 2.0 * tolerance);
    });
    const auto single = std::ranges::count_if(lengths, [&](double n) { return std::abs(n - usual) <= tolerance; });
    return static_cast<double>(steady) >= nearly_all * static_cast<double>(lengths.size()) && 2 * single >= std::ssize(lengths)
               ? held
               : std::vector<std::size_t>{};
}

}  // namespace schuler::io
