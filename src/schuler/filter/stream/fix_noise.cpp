#include "schuler/filter/stream/fix_noise.h"

#include "schuler/core/least_sigmas.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

// The remainder is limited to a tenth of the total, because it may be a small difference of rounded numbers; a sigma below that
// of the slow part cannot have included it.
double white_part(double stated, double slow) {
    return stated > slow ? std::max(std::sqrt(stated * stated - slow * slow), 0.1 * stated) : stated;
}

// Positions and velocities have the same limit.
static_assert(least_sigma::position == least_sigma::velocity);
bool is_stated(double sigma) { return std::isfinite(sigma) && sigma >= least_sigma::position; }

FixNoise noise_of(const GnssFix& fix, const GnssSettings& settings) {
    constexpr double floor_velocity = 0.005;  // m/s
    FixNoise n;
    for (int i = 0; i < 3; ++i) {
        const bool position = is_stated(fix.std_position(i)), velocity = is_stated(fix.std_velocity(i));
        n.position(i) = std::max(position ? settings.std_scale * fix.std_position(i) : settings.default_std_position(i),
                                 settings.std_floor_position(i));
        n.velocity(i) = std::max(velocity ? settings.velocity_std_scale * fix.std_velocity(i) : settings.default_std_velocity(i),
                                 floor_velocity);
        // defaults, tuned or given, are for the white part
        n.white_position(i) = position ? white_part(n.position(i), settings.errors.correlated_position(i)) : n.position(i);
        n.white_velocity(i) = velocity ? white_part(n.velocity(i), settings.errors.correlated_velocity(i)) : n.velocity(i);
    }
    return n;
}

}  // namespace schuler::filter
