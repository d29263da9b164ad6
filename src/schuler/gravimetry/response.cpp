#include "schuler/gravimetry/response.h"

#include "schuler/core/error.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::gravimetry {

HarmonicResponse harmonic_response(const std::vector<double>& s, const std::vector<double>& y, double length, double start,
                                   double size) {
    if (s.size() < 4)
        throw input_error("fewer than four points are left for a harmonic", {}, "give a longer survey or a shorter wavelength");
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double squares = 0.0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const double phase = 2.0 * std::numbers::pi * (s[i] - start) / length;
        const Eigen::Vector3d row(std::sin(phase), std::cos(phase), 1.0);
        A += row * row.transpose();
        b += row * y[i];
        squares += y[i] * y[i];
    }
    const Eigen::Vector3d x = A.ldlt().solve(b);
    const double rest = std::max(0.0, squares - x.dot(b));
    return {x.head<2>().norm() / size, -std::atan2(x(1), x(0)), std::sqrt(rest / static_cast<double>(s.size())) / size};
}

double half_width(const std::vector<double>& s, const std::vector<double>& y) {
    const auto top = std::ranges::max_element(y);
    const double half = 0.5 * *top;
    const auto peak = static_cast<std::size_t>(top - y.begin());
    const auto crossing = [&](std::size_t high, std::size_t low) {
        return s[high] + (s[low] - s[high]) * (y[high] - half) / (y[high] - y[low]);
    };
    std::size_t left = peak, right = peak;
    while (left > 0 && y[left] > half) --left;
    while (right + 1 < y.size() && y[right] > half) ++right;
    if (y[left] > half || y[right] > half) return std::numeric_limits<double>::quiet_NaN();
    return crossing(right - 1, right) - crossing(left + 1, left);
}

std::vector<double> corrected_for(const std::vector<double>& s, const std::vector<double>& y, const HarmonicResponse& response,
                                  double length) {
    double mean = 0.0;
    for (const double value : y) mean += value / static_cast<double>(y.size());
    const double late = response.lag / (2.0 * std::numbers::pi) * length;
    std::vector<double> out(y.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
        const double at = s[i] + late;
        while (next + 2 < y.size() && s[next + 1] < at) ++next;
        while (next > 0 && s[next] > at) --next;
        const double share = std::clamp((at - s[next]) / (s[next + 1] - s[next]), 0.0, 1.0);
        out[i] = mean + (y[next] + share * (y[next + 1] - y[next]) - mean) / response.gain;
    }
    return out;
}

}  // namespace schuler::gravimetry
