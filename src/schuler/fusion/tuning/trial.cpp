#include "schuler/fusion/tuning/trial.h"

#include <algorithm>

namespace schuler::fusion {

Settings plain_settings(const Settings& settings) {
    Settings s = settings;
    s.loop = Loop::Closed;
    s.coupling = Coupling::Loose;
    s.loose_kind = LooseKind::Standard;
    s.integrity.use = s.smooth = s.backward = false;
    s.constraints.nonholonomic = s.constraints.nonholonomic_auto = false;
    s.scale_factors = s.misalignments = s.estimate_lever_arm = s.disturbance.estimate = false;
    return s;
}

Settings trial_settings(const Settings& settings) {
    Settings t = plain_settings(settings);
    t.baro.use = t.mag.use = t.odometer.use = t.heading.use = t.gauges.use = t.log.use = false;
    t.gnss.errors = {};
    t.gnss.latency_std = t.gnss.velocity_latency_std = 0.0;
    return t;
}

RunData gnss_only(const RunData& all) {
    RunData data = all;
    std::erase_if(data.events, [](const Event& e) {
        return e.kind != MeasurementKind::GnssPosition && e.kind != MeasurementKind::GnssVelocity;
    });
    return data;
}

std::size_t increment_at(const RunData& data, Time t) {
    const auto it = std::lower_bound(data.imu.increments.begin(), data.imu.increments.end(), t,
                                     [](const ImuIncrement& i, Time x) { return i.time <= x; });
    return std::min(static_cast<std::size_t>(it - data.imu.increments.begin()), data.imu.increments.size() - 1);
}

}  // namespace schuler::fusion
