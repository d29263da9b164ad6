#include "schuler/filter/update/correction_period.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::filter {

namespace {

// An order-of-magnitude rule: standard gravity and the mean radius are adequate everywhere.
constexpr double g = 9.80665, radius = 6371000.0;

}  // namespace

double attitude_growth(const InertialErrorBounds& b, double t) {
    return b.gyro * t + ((b.attitude * g + b.accel) * t * t / 2.0 + g * b.gyro * t * t * t / 6.0) / radius;
}

double correction_period(const InertialErrorBounds& bounds, double allowed) {
    double low = 1.0, high = 0.5 * std::numbers::pi * std::sqrt(radius / g);
    if (attitude_growth(bounds, high) <= allowed) return high;
    while (high - low > 1e-6) {
        const double middle = 0.5 * (low + high);
        (attitude_growth(bounds, middle) > allowed ? high : low) = middle;
    }
    return low;
}

}  // namespace schuler::filter
