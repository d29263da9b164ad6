// Options of an inertial instrument's error model, the same for data sets (as assumed by the filter) and scenarios.
#pragma once

#include "schuler/core/units.h"
#include "schuler/sensor/grades.h"
#include "schuler/settings/option_builders.h"

#include <string_view>

namespace schuler::settings {

/// "imu.grade": sets the whole model; the numbers follow in the table and refine it.
template <class Target, class Name, class Errors>
Option<Target> imu_grade_option(Name grade, Errors errors) {
    OptionSpec s = detail::spec("imu.grade", Shape::Text, "class or device of the IMU; the numbers below refine it");
    for (const std::string_view name : sensor::imu_grade_names()) s.choices.emplace_back(name);
    s.any_spelling = true;
    return {std::move(s),
            [=](Target& t, const Value& v) {
                errors(t) = sensor::imu_grade(*v.text());
                grade(t) = *v.text();
            },
            [=](const Target& t) -> std::optional<Value> { return Value{grade(t)}; }};
}

/// The numbers of the model under `prefix` ("imu."); `errors` is the access to the model in the target.
template <class Target, class Errors>
void add_imu_error_options(OptionTable<Target>& table, const std::string& prefix, Errors errors) {
    using M = sensor::ImuErrorModel;
    const struct {
        const char* name;
        double factor, low, high;
        const char* help;
        double M::*field;
    } rows[] = {
        {"gyro_noise_deg_sqrt_h", units::deg_per_sqrt_hour, 0, 1000, "gyro angle random walk", &M::gyro_noise},
        {"gyro_bias_deg_h", units::deg_per_hour, 0, 1e6, "gyro in-run bias, one sigma", &M::gyro_bias},
        {"gyro_bias_time_s", 1.0, 1e-3, 1e9, "correlation time of the gyro in-run bias", &M::gyro_bias_time},
        {"gyro_turn_on_bias_deg_h", units::deg_per_hour, 0, 1e6, "gyro turn-on bias, one sigma", &M::gyro_turn_on_bias},
        {"gyro_scale_factor_ppm", units::ppm, 0, 1e6, "gyro scale-factor error, one sigma", &M::gyro_scale},
        {"gyro_misalignment_arcsec", units::arcsec, 0, 1e5, "gyro axis misalignment, one sigma", &M::gyro_misalignment},
        {"gyro_quantum_arcsec", units::arcsec, 0, 1e5, "resolution of the angle increments", &M::gyro_quantum},
        {"gyro_rate_walk_deg_h_sqrt_h", units::deg_per_hour / 60.0, 0, 1e6, "random walk of the gyro bias", &M::gyro_rate_walk},
        {"gyro_bias_instability_deg_h", units::deg_per_hour, 0, 1e6, "gyro flicker noise: Allan floor 0.664 of this",
         &M::gyro_flicker},
        {"gyro_temperature_deg_h_k", units::deg_per_hour, 0, 1e6,
         "gyro bias for one kelvin off the calibration temperature, one sigma", &M::gyro_temperature},
        {"gyro_g_deg_h_g", units::deg_per_hour / (1000.0 * units::mg), 0, 1e6, "gyro bias for one g of specific force, one sigma",
         &M::gyro_g},
        {"gyro_range_deg_s", units::deg_per_s, 0, 1e6, "full-scale range of the gyros; 0 = no limit", &M::gyro_range},
        {"accel_noise_m_s_sqrt_h", units::m_s_per_sqrt_hour, 0, 1000, "accelerometer velocity random walk", &M::accel_noise},
        {"accel_bias_mg", units::mg, 0, 1e4, "accelerometer in-run bias, one sigma", &M::accel_bias},
        {"accel_bias_time_s", 1.0, 1e-3, 1e9, "correlation time of the accelerometer in-run bias", &M::accel_bias_time},
        {"accel_turn_on_bias_mg", units::mg, 0, 1e4, "accelerometer turn-on bias, one sigma", &M::accel_turn_on_bias},
        {"accel_scale_factor_ppm", units::ppm, 0, 1e6, "accelerometer scale-factor error, one sigma", &M::accel_scale},
        {"accel_misalignment_arcsec", units::arcsec, 0, 1e5, "accelerometer axis misalignment, one sigma",
         &M::accel_misalignment},
        {"accel_walk_mg_sqrt_h", units::mg / 60.0, 0, 1e4, "random walk of the accelerometer bias", &M::accel_rate_walk},
        {"accel_bias_instability_mg", units::mg, 0, 1e4, "accelerometer flicker noise: Allan floor 0.664 of this",
         &M::accel_flicker},
        {"accel_temperature_mg_k", units::mg, 0, 1e4,
         "accelerometer bias for one kelvin off the calibration temperature, one sigma", &M::accel_temperature},
        {"accel_range_g", 1000.0 * units::mg, 0, 1e6, "full-scale range of the accelerometers; 0 = no limit", &M::accel_range},
        {"accel_quantum_m_s", 1.0, 0, 10, "resolution of the velocity increments", &M::accel_quantum},
    };
    for (const auto& r : rows) {
        table.add(number<Target>(prefix + r.name, r.factor, r.low, r.high, r.help,
                                 [errors, field = r.field](auto& t) -> auto& { return errors(t).*field; }));
    }
}

}  // namespace schuler::settings
