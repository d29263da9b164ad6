// Combined statistics of many runs of the triad, and their accuracy.
#include "schuler/study/triad/triad.h"

#include "schuler/math/quantile.h"
#include "schuler/math/random.h"

#include <algorithm>
#include <cmath>

namespace schuler::study {
namespace {

constexpr std::size_t from = 300, step = 10;  // s after the loss; the reference evaluates its errors at the same instants
constexpr std::size_t instants = (triad_epochs - from - 1) / step + 1;

}  // namespace

TriadStatistics statistics_of(const std::vector<TriadRun>& runs) {
    std::vector<const TriadRun*> all;
    for (const TriadRun& r : runs) all.push_back(&r);
    return statistics_of(all);
}

TriadStatistics statistics_of(const std::vector<const TriadRun*>& runs) {
    TriadStatistics s;
    std::vector<double> each, three;
    const double n = static_cast<double>(runs.size()), epochs = static_cast<double>(instants);
    for (const TriadRun* run : runs) {
        const TriadRun& r = *run;
        double h = 0.0, v = 0.0;
        for (std::size_t i = from; i < triad_epochs; i += step) {
            h += r.horizontal[i] * r.horizontal[i] / epochs;
            v += r.vertical[i] * r.vertical[i] / epochs;
            s.predicted += r.predicted_horizontal[i] * r.predicted_horizontal[i] / epochs / n;
            s.predicted_vertical += r.predicted_vertical[i] * r.predicted_vertical[i] / epochs / n;
            s.nees3 += r.nees3[i] / epochs / n;
            s.nees9 += r.nees9[i] / epochs / n;
        }
        each.push_back(std::sqrt(h));
        three.push_back(2.0 * std::sqrt(h + v));
        s.pooled += h / n;
        s.vertical += v / n;
        s.end += r.horizontal.back() * r.horizontal.back() / n;
        s.predicted_end += r.predicted_horizontal.back() * r.predicted_horizontal.back() / n;
        s.at_300 += r.horizontal[300] * r.horizontal[300] / n;
        s.at_330 += r.horizontal[330] * r.horizontal[330] / n;
    }
    for (double* x :
         {&s.pooled, &s.predicted, &s.vertical, &s.predicted_vertical, &s.end, &s.predicted_end, &s.at_300, &s.at_330})
        *x = std::sqrt(*x);
    std::ranges::sort(each);
    std::ranges::sort(three);
    s.median = math::quantile_of_sorted(each, 0.5);
    s.low = math::quantile_of_sorted(each, 0.025);
    s.high = math::quantile_of_sorted(each, 0.975);
    s.two_sigma = math::quantile_of_sorted(three, 0.5);
    return s;
}

double standard_error_of_a_set(const std::vector<TriadRun>& runs) {
    std::vector<double> squares;
    for (const TriadRun& r : runs) {
        double sum = 0.0;
        for (std::size_t i = from; i < triad_epochs; i += step) sum += r.horizontal[i] * r.horizontal[i];
        squares.push_back(sum / static_cast<double>(instants));
    }
    const std::size_t sets = runs.size() / triad_geometries;
    const std::size_t one = std::min(runs.size(), triad_geometries);
    const auto drawn = [](math::Random& random, std::size_t n) {
        return std::min(static_cast<std::size_t>(random.uniform() * static_cast<double>(n)), n - 1);
    };
    constexpr int draws = 2000;
    math::Random random(1, "triad.bootstrap");
    double sum = 0.0, sum_of_squares = 0.0;
    for (int draw = 0; draw < draws; ++draw) {
        double mean = 0.0;
        for (std::size_t k = 0; k < one; ++k) {
            const std::size_t j = sets > 1 ? drawn(random, sets) * triad_geometries + k : drawn(random, runs.size());
            mean += squares[j] / static_cast<double>(one);
        }
        sum += std::sqrt(mean) / draws;
        sum_of_squares += mean / draws;
    }
    // drawing from few runs of a geometry scatters less than the geometry itself
    const double few = sets > 1 ? static_cast<double>(sets) / static_cast<double>(sets - 1) : 1.0;
    return std::sqrt(few * std::max(0.0, sum_of_squares - sum * sum));
}

}  // namespace schuler::study
