#include "schuler/sim/simulate.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/exact_flight.h"
#include "schuler/sim/faults.h"
#include "schuler/sim/imu_errors.h"
#include "schuler/sim/inverse_imu.h"
#include "schuler/sim/receivers.h"

#include <cmath>
#include <string>

namespace schuler::sim {

namespace {

using detail::require;

bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }
bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }
bool not_negative(const Eigen::Vector3d& v) { return v.allFinite() && v.minCoeff() >= 0.0; }

void check(const Scenario& s) {
    require(is_positive(s.duration) && s.duration <= 1e6, "duration_s", "is not a duration", "give seconds, at most 1e6");
    require(is_positive(s.imu.rate) && s.imu.rate <= 1e5, "imu.rate_hz", "is not a rate", "give a positive number of Hz");
    require(s.duration * s.imu.rate <= 1e8, "imu.rate_hz", "gives more than 1e8 samples", "lower it or the duration");
    require(s.imu.mounting.allFinite(), "imu.mounting_deg", "is not a number", "give roll, pitch and yaw");
    const sensor::ImuErrorModel& m = s.imu.errors;
    for (const double sigma :
         {m.gyro_noise,     m.gyro_bias,         m.gyro_turn_on_bias,  m.gyro_scale,  m.gyro_misalignment,  m.gyro_quantum,
          m.accel_noise,    m.accel_bias,        m.accel_turn_on_bias, m.accel_scale, m.accel_misalignment, m.accel_quantum,
          m.gyro_rate_walk, m.gyro_flicker,      m.gyro_temperature,   m.gyro_g,      m.gyro_range,         m.accel_rate_walk,
          m.accel_flicker,  m.accel_temperature, m.accel_range}) {
        require(not_negative(sigma), "imu", "an error of the instrument is negative or not a number", "errors are one sigma");
    }
    require(m.gyro_bias_time > 0.0 && m.accel_bias_time > 0.0, "imu", "a bias correlation time is not positive", "give seconds");
    require(std::isfinite(s.imu.warm_up) && is_positive(s.imu.warm_up_time), "imu.warm_up_k", "is not a temperature with a time",
            "give kelvin, and seconds for imu.warm_up_time_s");
    const GnssSettings& g = s.gnss;
    require(not_negative(g.rate) && g.rate <= 1000.0, "gnss.rate_hz", "is not a rate", "give Hz, or 0 for no receiver");
    require(g.lever_arm_b.allFinite() && g.lever_arm_b.norm() < 200.0, "gnss.lever_arm_m", "is not a lever arm",
            "give metres forward, right, down");
    require(not_negative(g.white_position) && not_negative(g.errors.correlated_position) && not_negative(g.white_velocity) &&
                not_negative(g.errors.correlated_velocity) && not_negative(g.errors.change_white_position) &&
                not_negative(g.errors.change_correlated_position) && not_negative(g.errors.change_white_velocity) &&
                not_negative(g.errors.change_correlated_velocity),
            "gnss", "a sigma is negative or not a number", "give one sigma north, east, down");
    require(g.errors.correlated_time > 0.0, "gnss.correlated_time_s", "is not positive", "give seconds");
    require(g.errors.correlated_velocity_time > 0.0, "gnss.correlated_velocity_time_s", "is not positive", "give seconds");
    require(not_negative(g.errors.correlated_distance), "gnss.correlated_distance_m", "is negative",
            "give metres, or 0 for none");
    require(not_negative(g.position_latency) && not_negative(g.velocity_latency), "gnss.latency_s", "is negative",
            "give seconds");
    const BaroSettings& b = s.baro;
    require(not_negative(b.rate) && b.rate <= 1000.0, "baro.rate_hz", "is not a rate", "give Hz, or 0 for none");
    require(not_negative(b.white) && not_negative(b.bias) && not_negative(b.bias_walk), "baro", "a sigma is negative",
            "give metres");
    require(!b.pressure || (is_positive(b.sea_level_pressure) && std::abs(b.temperature_offset) < 100.0),
            "baro.sea_level_pressure_pa", "pressure out of range", "give pascals, and kelvin for baro.temperature_offset_k");
    const MagSettings& mag = s.mag;
    require(not_negative(mag.rate) && mag.rate <= 1000.0, "mag.rate_hz", "is not a rate", "give Hz, or 0 for none");
    require(is_positive(mag.field) && not_negative(mag.white) && not_negative(mag.hard_iron) && not_negative(mag.soft_iron) &&
                std::isfinite(mag.declination + mag.inclination),
            "mag", "a number is negative or not one", "give the field and sigmas");
    for (const Fault& f : s.faults)
        require(std::isfinite(f.start + f.duration + f.size) && f.duration >= 0.0 && f.direction.allFinite() &&
                    f.direction.norm() > 0.0,
                "fault", "lacks a finite start, duration, size or direction", "give start_s, kind and size");
    require(is_positive(s.reference_rate) && s.reference_rate <= 1e5, "reference_rate_hz", "is not a rate",
            "give a positive rate");
    for (const SimulatedOutage& outage : s.outages) {
        require(std::isfinite(outage.start) && not_negative(outage.duration), "outage", "is not a time span",
                "give start and duration");
    }
}

ReferenceSample reference_at(const Kinematics& k, Time time) {
    ReferenceSample sample;
    sample.time = time;
    sample.position = k.position;
    sample.velocity_n = k.v_eb_n;
    sample.rpy = k.rpy;
    sample.movement = k.v_eb_n.norm() > 0.05 || k.rpy_rate.norm() > 1e-3;
    return sample;
}

}  // namespace

SimulatedData simulate(const Scenario& s) { return simulate(s, nullptr); }

SimulatedData simulate(const Scenario& s, const ExactFlight* flown) {
    check(s);
    if (flown != nullptr && !flown->is_of(s)) flown = nullptr;
    const std::unique_ptr<const TruthPath> path = make_path(s.path, s.earth.ellipsoid);
    SensorTriad gyro = gyro_triad(s.imu.errors, s.seed), accel = accel_triad(s.imu.errors, s.seed);
    const Eigen::Matrix3d C_sb = math::dcm_from_rpy(s.imu.mounting).transpose();

    SimulatedData out;
    out.imu_kind = s.imu.kind;
    out.gyro_gain = gyro.gain();
    out.accel_gain = accel.gain();
    const std::size_t samples = imu_samples(s), references = reference_epochs(s);
    const bool disturbed = s.disturbed();
    const AnomalyTrack anomaly = disturbed ? AnomalyTrack(s.anomaly, s.anomaly_field, *path, s.duration, s.seed)
                                           : AnomalyTrack({}, 0.0, s.duration, s.seed);
    double distance = 0.0;
    out.recording.imu.reserve(samples);
    out.recording.reference.reserve(references);
    out.sensor_truth.reserve(references);

    const auto tell_until = [&](double t) {  // adds reference epochs up to t with the current biases
        for (;;) {
            const double next = static_cast<double>(out.recording.reference.size()) / s.reference_rate;
            if (next > t + 1e-9 || out.recording.reference.size() == references) return;
            const Time time = s.origin + Duration::from_seconds(next);
            const Kinematics motion = flown != nullptr ? flown->reference(out.recording.reference.size()) : path->at(next);
            out.recording.reference.push_back(reference_at(motion, time));
            const double gone = disturbed ? distance - (t - next) * motion.v_eb_n.norm() : 0.0;
            out.sensor_truth.push_back({time, gyro.bias(), accel.bias(), anomaly.at(gone, next)});
        }
    };
    tell_until(0.0);
    const ChannelFaults faults(s, Channel::Imu);
    const double dt = 1.0 / s.imu.rate;
    const double unit = s.imu.kind == ImuKind::Rates ? s.imu.rate : 1.0;
    for (std::size_t k = 1; k <= samples; ++k) {
        const double t = static_cast<double>(k) / s.imu.rate;
        ExactIncrement exact = flown != nullptr ? flown->increment(k - 1)
                                                : exact_increment(s.earth, *path, static_cast<double>(k - 1) / s.imu.rate, t);
        if (disturbed) {  // an accelerometer senses the reaction to gravity: deviations from the model enter negatively
            const Kinematics middle = path->at(t - 0.5 * dt);
            const double step = dt * middle.v_eb_n.norm();
            exact.dv -= dt * (math::dcm_from_rpy(middle.rpy).transpose() * anomaly.at(distance + 0.5 * step, t - 0.5 * dt));
            distance += step;
        }
        const double warmth = -s.imu.warm_up * std::expm1(-t / s.imu.warm_up_time);
        const Eigen::Vector3d exact_dv = C_sb * exact.dv;
        Eigen::Vector3d dtheta = gyro.measure(C_sb * exact.dtheta, dt, {warmth, exact_dv});
        Eigen::Vector3d dv = accel.measure(exact_dv, dt, {warmth, Eigen::Vector3d::Zero()});
        if (!s.faults.empty()) {
            dtheta += dt * faults.sensor_offset(FaultKind::Gyro, t);
            dv += dt * faults.sensor_offset(FaultKind::Accel, t);
            const double most = dt * faults.sensor_offset(FaultKind::Saturate, t).norm();
            if (most > 0.0) dtheta = dtheta.cwiseMax(-most).cwiseMin(most);
        }
        const Time stamp = s.origin + Duration::from_seconds(t);
        if (faults.any(FaultKind::Freeze, t) && !out.recording.imu.empty())
            out.recording.imu.push_back({stamp, out.recording.imu.back().gyro, out.recording.imu.back().accel});
        else if (!faults.any(FaultKind::Dropout, t)) out.recording.imu.push_back({stamp, unit * dtheta, unit * dv});
        tell_until(t);
    }
    tell_until(s.duration);
    out.recording.gnss = simulate_gnss(s, *path, out.gnss_truth);
    out.recording.baro = simulate_baro(s, *path, out.baro_truth);
    out.recording.mag = simulate_mag(s, *path);
    return out;
}

}  // namespace schuler::sim
