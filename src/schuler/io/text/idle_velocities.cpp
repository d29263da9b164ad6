#include "schuler/io/text/idle_velocities.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace schuler::io {

bool has_idle_velocities(const std::vector<GnssFix>& fixes) {
    std::vector<double> lat, lon;
    bool any = false;
    for (const GnssFix& fix : fixes) {
        for (const double v : fix.velocity_n) {
            if (std::isfinite(v) && v != 0.0) return false;
            any = any || v == 0.0;
        }
        lat.push_back(fix.position.lat);
        lon.push_back(fix.position.lon);
    }
    if (!any) return false;
    const double middle_lat = math::median(std::move(lat)), middle_lon = math::median(std::move(lon));
    constexpr double radius = 6.371e6, travelled = 50.0;  // m
    const auto away = std::ranges::count_if(fixes, [&](const GnssFix& fix) {
        return radius * std::hypot(fix.position.lat - middle_lat, std::cos(middle_lat) * (fix.position.lon - middle_lon)) >
               travelled;
    });
    return 10 * away > std::ssize(fixes);
}

}  // namespace schuler::io
