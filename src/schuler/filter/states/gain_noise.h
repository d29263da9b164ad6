// Noise of gain errors that are not states.
#pragma once

#include "schuler/core/units.h"
#include "schuler/filter/states/inertial_filter.h"

#include <algorithm>

namespace schuler::filter {

/// Scale factors and misalignments that are not states act during rotation and where the specific force differs from that at rest, whose
/// effect is absorbed by the biases: modelled as white noise that causes, after a manoeuvre of `manoeuvre` seconds, the same error.
[[nodiscard]] inline BridgeNoise gain_noise(const InertialModel& model, const ImuIncrement& increment) {
    constexpr double manoeuvre = 10.0;  // s
    const double dt2 = increment.dt * increment.dt, g0 = units::g0;
    const double beyond_rest = std::max(0.0, increment.dv.squaredNorm() / dt2 - g0 * g0);
    const double turning = increment.dtheta.squaredNorm() / dt2;
    return {model.gyro_gain * model.gyro_gain * turning * manoeuvre,
            model.accel_gain * model.accel_gain * beyond_rest * manoeuvre};
}

}  // namespace schuler::filter
