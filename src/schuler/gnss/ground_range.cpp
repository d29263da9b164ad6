#include "schuler/gnss/ground_range.h"

#include <array>
#include <cmath>

namespace schuler::gnss {

double ground_range_delay(const Geodetic& station, const Geodetic& aircraft, double D, double n0) {
    constexpr double H = 7350.0, radius = 6'371'000.0;  // m
    // nodes and weights of Gauss-Legendre on [0, 1]
    constexpr std::array<double, 4> x{0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
    constexpr std::array<double, 4> w{0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double h = station.h + (aircraft.h - station.h) * x[i] - D * D * x[i] * (1.0 - x[i]) / (2.0 * radius);
        sum += w[i] * std::exp(-h / H);
    }
    const double straight = 1e-6 * D * n0 * sum;
    const double bend = straight / (D * H);  // 1/m, curvature of the ray
    return straight - bend * bend * D * D * D / 24.0;
}

}  // namespace schuler::gnss
