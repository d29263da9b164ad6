#include "schuler/filter/states/model.h"

#include "schuler/core/fail.h"
#include "schuler/math/chi_square.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::filter {

using Eigen::Vector3d;

Sensors sensors_of(const Recording& recording) {
    int gauges = 0;
    for (const GaugeSample& s : recording.gauges)
        for (int i = gauges; i < 3; ++i)
            if (std::isfinite(s.height(i))) gauges = i + 1;
    return {!recording.baro.empty(),
            !recording.mag.empty(),
            !recording.odometer.empty(),
            !recording.heading.empty(),
            gauges,
            !recording.body_velocity.empty(),
            !recording.ranges.carriers.empty(),
            std::ranges::any_of(recording.ranges.samples,
                                [](const RangeSample& m) { return m.phase_span > 0.0 && !(m.std_rate > 0.0); })};
}

Layout layout_with(const Settings& settings, const Sensors& sensors) {
    Layout L;
    if (settings.scale_factors) {
        L.gyro_scale = L.add("gyro_scale", "1", 3);
        L.accel_scale = L.add("accel_scale", "1", 3);
    }
    if (settings.misalignments) {
        L.gyro_misalignment = L.add("gyro_misalignment", "rad", 6);
        L.accel_misalignment = L.add("accel_misalignment", "rad", 6);
    }
    if (settings.estimate_lever_arm) L.lever_arm = L.add("lever_arm", "m", 3);
    if (!uses_ranges(settings.coupling) && settings.gnss.latency_std > 0.0) L.gnss_latency = L.add("gnss_latency_error", "s", 1);
    if (settings.disturbance.estimate) add_disturbance(settings.disturbance.model, L);
    if (settings.disturbance.keep_before) L.gravity_before = L.add("gravity_before", "m/s^2", 3);
    if (settings.constraints.nonholonomic || settings.constraints.nonholonomic_auto) {
        L.mounting = L.add("mounting", "rad", 2);
        L.axle = L.add("axle", "m", 1);
    }
    if (sensors.baro && settings.baro.use) L.baro_bias = L.add("baro_bias", "m", 1);
    if (sensors.mag && settings.mag.use) {
        L.mag_bias = L.add("mag_heading_offset", "rad", 1);
        if (settings.mag.deviation_std > 0.0) L.hard_iron = L.add("mag_hard_iron", "1", 3);
        if (settings.mag.used_disturbance() > 0.0) L.mag_disturbance = L.add("mag_disturbance", "rad", 1);
    }
    if (sensors.odometer && settings.odometer.use) L.odometer_scale = L.add("odometer_scale", "1", 1);
    if (sensors.heading && settings.heading.use && settings.heading.offset_std > 0.0)
        L.heading_offset = L.add("heading_offset", "rad", 1);
    if (sensors.gauges > 0 && settings.gauges.use && settings.gauges.level_std > 0.0) {
        L.gauges = sensors.gauges;
        L.gauge_level = L.add("gauge_level", "m", L.gauges);
    }
    if (sensors.log && settings.log.use) {
        if (settings.log.scale_std > 0.0) L.log_scale = L.add("log_scale", "1", 1);
        if (settings.log.misalignment_std > 0.0) L.log_misalignment = L.add("log_misalignment", "rad", 2);
    }
    if (uses_ranges(settings.coupling)) {
        L.clock = L.add("clock_bias", "m", 1);
        L.drift = L.add("clock_drift", "m/s", 1);
        if (settings.ranging.use_rates && settings.ranging.errors.rate_span > 0.0)
            L.rate_noise = L.add("range_rate_common_noise", "m/s", 1);
        const bool slow_rates = settings.ranging.use_rates && settings.ranging.errors.satellite.correlated_rate > 0.0;
        if (settings.coupling == Coupling::Deep && settings.ranging.use_rates) {
            constexpr int most = 12;
            const int after = 4 + (slow_rates ? 2 : 1) * Layout::slots;
            L.phases = std::clamp((estim::max_states - after - L.size - 3) / 2, 0, most);
            if (L.phases > 0) {
                L.antenna = L.add("antenna_at_last_phase", "m", 3);
                L.phase = L.add("carrier_phase_error", "m", 2 * L.phases);
            }
        }
        if (settings.coupling == Coupling::Tight && sensors.phase_rates && settings.ranging.use_rates)
            L.antenna = L.add("antenna_at_last_phase", "m", 3);
        if (settings.coupling == Coupling::Tight && sensors.carriers) {
            const int after = 5 + (slow_rates ? 2 : 1) * Layout::slots;
            L.ambiguities = std::clamp(estim::max_states - after - L.size, 0, Layout::most_ambiguities);
            if (L.ambiguities > 0) {
                L.carrier_clock = L.add("carrier_clock", "m", 1);
                L.ambiguity = L.add("carrier_ambiguity", "m", L.ambiguities);
            }
        }
        L.network = L.add("station_network_offset", "m", 1);
        L.intersystem = L.add("intersystem_offset", "m", 3);
        if (slow_rates) L.source_rate = L.add("range_rate_slow_error", "m/s", Layout::slots);
        L.source = L.add("range_slow_error", "m", Layout::slots);
    } else {
        if (settings.gnss.use_velocity && settings.gnss.velocity_latency_std > 0.0)
            L.gnss_velocity_latency = L.add("gnss_velocity_latency_error", "s", 1);
        if (settings.gnss.errors.correlated_position.maxCoeff() > 0.0) L.gnss_position = L.add("gnss_position_error", "m", 3);
        if (settings.gnss.use_velocity && settings.gnss.errors.correlated_velocity.maxCoeff() > 0.0)
            L.gnss_velocity = L.add("gnss_velocity_error", "m/s", 3);
    }
    return L;
}

namespace {

/// Noise that drives the errors while the filter runs.
sensor::ImuErrorModel driving(const ImuSettings& imu) {
    sensor::ImuErrorModel errors = imu.errors;
    const double gyro = imu.gyro_noise_scale.value_or(1.0), accel = imu.accel_noise_scale.value_or(1.0);
    for (double* x : {&errors.gyro_noise, &errors.gyro_bias, &errors.gyro_rate_walk, &errors.gyro_flicker}) *x *= gyro;
    for (double* x : {&errors.accel_noise, &errors.accel_bias, &errors.accel_rate_walk, &errors.accel_flicker}) *x *= accel;
    return errors;
}

}  // namespace

Layout make_layout(const Settings& settings, const Recording& recording) {
    Layout layout = layout_with(settings, sensors_of(recording));
    if (!layout.fits())
        fail(input_error(fmt::format("the filter would have more than {} states", estim::max_states),
                         {.file = {}, .key = "filter.misalignments"},
                         "leave out misalignments, scale factors, the lever arm or the receiver's slow errors"));
    return layout;
}

void set_limits(RunData& data, const Settings& settings) {
    const ConstraintSettings& constraints = settings.constraints;
    const bool open = constraints.gate_probability == 0.0;
    for (int dof = 1; dof <= 3; ++dof) {
        data.gates.chi_square[dof] =
            open ? std::numeric_limits<double>::infinity() : math::chi_square_quantile(1.0 - constraints.gate_probability, dof);
    }
    data.gates.recovery_time = constraints.recovery_time;
    data.gates.recovery_count = constraints.recovery_count;
    if (settings.integrity.use) data.slow_limits = slow_limits(settings.integrity);
    data.declination = settings.mag.used_declination();
}

InertialModel make_model(const Settings& settings, const Layout& layout) {
    InertialModel model(settings.earth, layout, driving(settings.imu));
    model.loop = settings.loop;
    model.disturbance = settings.disturbance.model;
    const BaroSettings& baro = settings.baro;
    model.set_process(layout.baro_bias, 1,
                      baro.bias_time > 0.0 ? StateProcess::markov(baro.bias_std, baro.bias_time)
                                           : StateProcess{0.0, baro.bias_walk * baro.bias_walk});
    constexpr double leeway_time = 600.0;  // s, in which wind, current and the course relative to them change
    if (settings.heading.by_course) {
        model.leeway_std = settings.heading.offset_std;
        model.set_process(layout.heading_offset, 1, StateProcess::markov(settings.heading.offset_std, leeway_time));
    }
    model.set_process(layout.mag_bias, 1, {0.0, settings.mag.bias_walk * settings.mag.bias_walk});
    constexpr double disturbance_time = 10.0;  // s, in which a vehicle turns or changes its power
    if (layout.mag_disturbance >= 0)
        model.set_process(layout.mag_disturbance, 1, StateProcess::markov(settings.mag.used_disturbance(), disturbance_time));
    // Loggers and receivers do not keep it to the millisecond: the estimate is forgotten, by some hundredths of a second per minute.
    const auto latency = [](double sigma) {
        constexpr double wander = 0.02, time = 60.0;  // s
        return StateProcess::markov(sigma, time * std::max(1.0, std::pow(sigma / wander, 2)));
    };
    if (layout.gnss_latency >= 0) model.set_process(layout.gnss_latency, 1, latency(settings.gnss.latency_std));
    if (layout.gnss_velocity_latency >= 0)
        model.set_process(layout.gnss_velocity_latency, 1, latency(settings.gnss.velocity_latency_std));
    model.gnss = settings.gnss.errors;
    for (int i = 0; i < 3; ++i) {
        const sensor::GnssErrorModel& g = model.gnss;
        if (layout.gnss_position >= 0)
            model.set_process(layout.gnss_position + i, 1, StateProcess::markov(g.correlated_position(i), g.correlated_time));
        if (layout.gnss_velocity >= 0)
            model.set_process(layout.gnss_velocity + i, 1,
                              StateProcess::markov(g.correlated_velocity(i), g.correlated_velocity_time));
    }
    if (uses_ranges(settings.coupling)) {
        const sensor::RangingErrorModel& e = settings.ranging.errors;
        model.clock_psd = e.clock.phase_psd();
        model.drift_psd = e.clock.frequency_psd();
        model.set_process(layout.network, 1, StateProcess::markov(e.network, e.network_time));
        model.set_process(layout.source_rate, Layout::slots,
                          StateProcess::markov(e.satellite.correlated_rate, e.satellite.correlated_rate_time));
        // Effects without states: fixes are too noisy to reveal them, ranges at ten hertz are not.
        const sensor::ImuErrorModel& imu = settings.imu.errors;
        model.gyro_gain =
            std::hypot(layout.gyro_scale < 0 ? imu.gyro_scale : 0.0, layout.gyro_misalignment < 0 ? imu.gyro_misalignment : 0.0);
        model.accel_gain = std::hypot(layout.accel_scale < 0 ? imu.accel_scale : 0.0,
                                      layout.accel_misalignment < 0 ? imu.accel_misalignment : 0.0);
    }
    model.gyro_g = settings.imu.errors.gyro_g * settings.imu.gyro_noise_scale.value_or(1.0);
    model.gyro_vibration = settings.imu.gyro_vibration.value_or(0.0) * settings.imu.gyro_noise_scale.value_or(1.0);
    model.accel_vibration = settings.imu.accel_vibration.value_or(0.0) * settings.imu.accel_noise_scale.value_or(1.0);
    model.found_mounting_std = settings.imu.found_mounting_std;
    model.lever_arm_b = settings.gnss.lever_arm_b;
    model.found_lever_arm_std = settings.gnss.found_lever_arm_std;
    model.at_antenna = settings.output_at_antenna && model.eccentric();
    const auto bound = [&model](int offset, double sigma) { model.floor.segment<3>(offset).setConstant(sigma * sigma); };
    bound(Layout::position, settings.constraints.floor_position);
    bound(Layout::velocity, settings.constraints.floor_velocity);
    bound(Layout::attitude, settings.constraints.floor_attitude);
    bound(Layout::gyro_bias, settings.constraints.floor_gyro_bias);
    bound(Layout::accel_bias, settings.constraints.floor_accel_bias);
    return model;
}

}  // namespace schuler::filter
