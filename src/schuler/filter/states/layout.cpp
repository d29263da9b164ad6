#include "schuler/filter/states/layout.h"

#include <algorithm>

namespace schuler::filter {

Layout::Layout() {
    (void)add("position", "m", 3);
    (void)add("velocity", "m/s", 3);
    (void)add("attitude", "rad", 3);
    (void)add("gyro_bias", "rad/s", 3);
    (void)add("accel_bias", "m/s^2", 3);
}

int Layout::add(std::string_view name, std::string_view unit, int states) {
    if (size + states > estim::max_states || count_ == blocks_.size()) {
        fits_ = false;
        return 0;
    }
    blocks_[count_++] = {name, unit, size, states};
    size += states;
    return size - states;
}

int Layout::driven() const {
    int end = accel_bias + 3;
    if (accel_scale >= 0) end = std::max(end, accel_scale + 3);
    if (accel_misalignment >= 0) end = std::max(end, accel_misalignment + 6);
    if (lever_arm >= 0) end = std::max(end, lever_arm + 3);
    if (gnss_latency >= 0) end = std::max(end, gnss_latency + 1);  // Corrections
    for (const int gravity : {gravity_constant, gravity_random, gravity_slope, gravity_curvature})
        if (gravity >= 0) end = std::max(end, gravity + 3);
    return end;
}

}  // namespace schuler::filter
