#include "schuler/fusion/layout.h"

#include "schuler/fusion/settings.h"

namespace schuler::fusion {

Layout make_layout(const Settings& settings, bool with_baro, bool with_mag) {
    Layout L;
    const auto block = [&L](int& offset, int states) {
        offset = L.size;
        L.size += states;
    };
    if (settings.scale_factors) {
        block(L.gyro_scale, 3);
        block(L.accel_scale, 3);
    }
    if (settings.misalignments) {
        block(L.gyro_misalignment, 6);
        block(L.accel_misalignment, 6);
    }
    if (settings.aids.nonholonomic || settings.aids.nonholonomic_auto) {
        block(L.mounting, 2);
        block(L.axle, 1);
    }
    if (settings.estimate_lever_arm) block(L.lever_arm, 3);
    if (with_baro && settings.baro.use) block(L.baro_bias, 1);
    if (with_mag && settings.mag.use) block(L.mag_bias, 1);
    if (settings.gnss.errors.correlated_position.maxCoeff() > 0.0) block(L.gnss_position, 3);
    if (settings.gnss.use_velocity && settings.gnss.errors.correlated_velocity.maxCoeff() > 0.0) block(L.gnss_velocity, 3);
    return L;
}

}  // namespace schuler::fusion
