#include "schuler/analysis/attitude_errors.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace schuler::analysis {
namespace {

/// From rotations about the vertical and about a level axis: perpendicular, so the cosines of the half angles multiply.
double total_of(double heading, double inclination) {
    return 2.0 * std::acos(std::min(1.0, std::abs(std::cos(0.5 * heading) * std::cos(0.5 * inclination))));
}

}  // namespace

BroadErrors broad_errors(std::span<const AttitudePair> pairs) {
    BroadErrors out;
    out.epochs = pairs.size();
    if (pairs.empty()) return out;
    std::complex<double> mean = 0.0;
    for (const AttitudePair& p : pairs) {
        const Eigen::Quaterniond e = p.q_estimate * p.q_reference.conjugate();
        out.headings.push_back(2.0 * std::atan2(e.z(), e.w()));
        out.inclinations.push_back(2.0 * std::acos(std::min(1.0, std::hypot(e.w(), e.z()))));
        mean += std::polar(1.0, out.headings.back());
    }
    out.heading_offset = std::arg(mean);
    double total2 = 0.0, heading2 = 0.0, inclination2 = 0.0, raw_total2 = 0.0, raw_heading2 = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        double& heading = out.headings[i];
        const double raw = std::arg(std::polar(1.0, heading)), inclination = out.inclinations[i];
        heading = std::arg(std::polar(1.0, heading - out.heading_offset));
        const double total = total_of(heading, inclination), raw_total = total_of(raw, inclination);
        total2 += total * total;
        heading2 += heading * heading;
        inclination2 += inclination * inclination;
        raw_total2 += raw_total * raw_total;
        raw_heading2 += raw * raw;
    }
    const double n = static_cast<double>(pairs.size());
    out.total = std::sqrt(total2 / n);
    out.heading = std::sqrt(heading2 / n);
    out.inclination = std::sqrt(inclination2 / n);
    out.raw_total = std::sqrt(raw_total2 / n);
    out.raw_heading = std::sqrt(raw_heading2 / n);
    return out;
}

}  // namespace schuler::analysis
