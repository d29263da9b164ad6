#include "schuler/sim/receivers.h"

#include "schuler/earth/atmosphere.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/faults.h"
#include "schuler/sim/imu_errors.h"
#include "schuler/sim/inverse_imu.h"

#include <algorithm>
#include <cmath>

namespace schuler::sim {

namespace {

bool silent(const Scenario& scenario, Channel channel, double t) {
    return std::any_of(scenario.outages.begin(), scenario.outages.end(), [&](const SimulatedOutage& outage) {
        return outage.channel == channel && t > outage.start && t < outage.start + outage.duration;
    });
}

Eigen::Vector3d root_sum(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a.cwiseAbs2() + b.cwiseAbs2()).cwiseSqrt();
}

/// Number of epochs at k / rate, k = 0, 1, ... up to the end of the scenario.
std::size_t epochs(double rate, double duration) {
    return rate > 0.0 ? static_cast<std::size_t>(std::floor(duration * rate + 1e-6)) + 1 : 0;
}

}  // namespace

Eigen::Vector3d stated_position_sigma(const GnssSettings& s) { return root_sum(s.white_position, s.errors.correlated_position); }
Eigen::Vector3d stated_velocity_sigma(const GnssSettings& s) { return root_sum(s.white_velocity, s.errors.correlated_velocity); }

PointMotion point_motion(const earth::Earth& earth, const Kinematics& imu, const Eigen::Vector3d& lever_arm_b) {
    if (lever_arm_b.isZero(0.0)) return {imu.position, imu.v_eb_n};
    const Eigen::Matrix3d C_en = earth::C_en(imu.position.lat, imu.position.lon);
    const Eigen::Matrix3d C_nb = math::dcm_from_rpy(imu.rpy);
    const Ecef r = earth::ecef_from_geodetic(earth.ellipsoid, imu.position);
    const Geodetic point = earth::geodetic_from_ecef(earth.ellipsoid, Ecef{r.r + C_en * (C_nb * lever_arm_b)});
    const Eigen::Vector3d w_en_n = earth::terms_at(earth, imu.position, imu.v_eb_n).w_en_n;
    const Eigen::Vector3d w_eb_b = body_rate(imu.rpy, imu.rpy_rate) + C_nb.transpose() * w_en_n;
    const Eigen::Vector3d v_e = C_en * (imu.v_eb_n + C_nb * w_eb_b.cross(lever_arm_b));
    return {point, earth::C_en(point.lat, point.lon).transpose() * v_e};
}

std::vector<GnssFix> simulate_gnss(const Scenario& scenario, const TruthPath& path, std::vector<GnssTruth>& truth) {
    const GnssSettings& s = scenario.gnss;
    math::Random white_position(scenario.seed, "gnss.white_position"), white_velocity(scenario.seed, "gnss.white_velocity");
    const sensor::GnssErrorModel& slow = s.errors;
    GaussMarkov slow_position(slow.correlated_position, slow.correlated_time, math::Random(scenario.seed, "gnss.slow_position"));
    GaussMarkov slow_velocity(slow.correlated_velocity, slow.correlated_velocity_time,
                              math::Random(scenario.seed, "gnss.slow_velocity"));
    math::Random change(scenario.seed, "gnss.constellation_change");
    auto next_change = s.constellation_changes.begin();
    ChannelFaults faults(scenario, Channel::Gnss);
    std::vector<GnssFix> fixes;
    for (std::size_t k = 0; k < epochs(s.rate, scenario.duration); ++k) {
        const double t = static_cast<double>(k) / s.rate;
        if (k > 0) {
            const double ground_speed = path.at(t).v_eb_n.head<2>().norm();
            slow_position.relax(slow.position_decay(ground_speed) / s.rate);
            slow_velocity.advance(1.0 / s.rate);
        }
        // Drawn in outages too: withholding fixes must not change the remaining ones.
        Eigen::Vector3d dr = s.white_position.cwiseProduct(white_position.normal3());
        Eigen::Vector3d dv = s.white_velocity.cwiseProduct(white_velocity.normal3());
        if (next_change != s.constellation_changes.end() && *next_change <= t + 1e-9) {
            while (next_change != s.constellation_changes.end() && *next_change <= t + 1e-9) ++next_change;
            slow_position.disturb(slow.change_correlated_position.cwiseProduct(change.normal3()));
            slow_velocity.disturb(slow.change_correlated_velocity.cwiseProduct(change.normal3()));
            dr += slow.change_white_position.cwiseProduct(change.normal3());
            dv += slow.change_white_velocity.cwiseProduct(change.normal3());
        }
        dr += slow_position.value() + faults.offset(t);
        dv += slow_velocity.value() + faults.velocity_offset(t);
        if (silent(scenario, Channel::Gnss, t) || faults.any(FaultKind::Dropout, t)) continue;
        const double at_position = t - s.position_latency, at_velocity = t - s.velocity_latency;
        if (std::min(at_position, at_velocity) < -1e-9) continue;  // before the start of the flight
        const PointMotion point = point_motion(scenario.earth, path.at(at_position), s.lever_arm_b);
        const PointMotion moving =
            at_velocity == at_position ? point : point_motion(scenario.earth, path.at(at_velocity), s.lever_arm_b);
        GnssFix fix;
        fix.time = scenario.origin + Duration::from_seconds(t);
        fix.position = earth::moved_by_ned(scenario.earth, point.position, dr);
        fix.velocity_n = moving.v_n + dv;
        fix.std_position = stated_position_sigma(s);
        fix.std_velocity = stated_velocity_sigma(s);
        fix.fix = s.fix;
        if (faults.any(FaultKind::Freeze, t) && !fixes.empty()) {
            fix.position = fixes.back().position;
            fix.velocity_n = fixes.back().velocity_n;
        }
        fixes.push_back(fix);
        truth.push_back({fix.time, slow_position.value(), slow_velocity.value()});
    }
    return fixes;
}

std::vector<BaroSample> simulate_baro(const Scenario& scenario, const TruthPath& path, std::vector<BaroTruth>& truth) {
    const BaroSettings& s = scenario.baro;
    math::Random white(scenario.seed, "baro.white"), walk(scenario.seed, "baro.walk"), constant(scenario.seed, "baro.bias");
    double bias = s.bias * constant.normal();
    ChannelFaults faults(scenario, Channel::Baro);
    std::vector<BaroSample> samples;
    for (std::size_t k = 0; k < epochs(s.rate, scenario.duration); ++k) {
        const double t = static_cast<double>(k) / s.rate;
        if (k > 0 && s.bias_time > 0.0) {
            const double kept = std::exp(-1.0 / (s.rate * s.bias_time));
            bias = kept * bias + std::sqrt(1.0 - kept * kept) * s.bias * walk.normal();
        } else if (k > 0) {
            bias += s.bias_walk * std::sqrt(1.0 / s.rate) * walk.normal();
        }
        const double error = bias + s.white * white.normal() + faults.offset(t).x();
        if (silent(scenario, Channel::Baro, t) || faults.any(FaultKind::Dropout, t)) continue;
        BaroSample sample;
        sample.time = scenario.origin + Duration::from_seconds(t);
        const double h = path.at(t).position.h;
        double weather = 0.0;  // difference of the day's air from the height of the standard atmosphere
        if (s.pressure) {
            const auto pressure = [&s](double height) {
                return earth::static_pressure(earth::geopotential_from_geometric(height), s.sea_level_pressure,
                                              s.temperature_offset);
            };
            sample.pressure = pressure(h + error);
            weather = earth::geometric_from_geopotential(earth::geopotential_height_from_pressure(pressure(h))) - h;
        } else {
            sample.height = h + error;
        }
        if (faults.any(FaultKind::Freeze, t) && !samples.empty()) {
            sample.height = samples.back().height;
            sample.pressure = samples.back().pressure;
        }
        samples.push_back(sample);
        truth.push_back({sample.time, bias + weather});
    }
    return samples;
}

std::vector<MagSample> simulate_mag(const Scenario& scenario, const TruthPath& path) {
    const MagSettings& s = scenario.mag;
    math::Random white(scenario.seed, "mag.white"), iron(scenario.seed, "mag.iron");
    const Eigen::Vector3d hard = s.hard_iron * iron.normal3();
    Eigen::Matrix3d soft = Eigen::Matrix3d::Identity();
    for (Eigen::Index i = 0; i < 9; ++i) soft(i) += s.soft_iron * iron.normal();
    const double level = s.field * std::cos(s.inclination);
    const Eigen::Vector3d field_n(level * std::cos(s.declination), level * std::sin(s.declination),
                                  s.field * std::sin(s.inclination));
    const Eigen::Matrix3d C_sb = math::dcm_from_rpy(scenario.imu.mounting).transpose();
    std::vector<MagSample> samples;
    for (std::size_t k = 0; k < epochs(s.rate, scenario.duration); ++k) {
        const double t = static_cast<double>(k) / s.rate;
        const Eigen::Vector3d field_b = math::dcm_from_rpy(path.at(t).rpy).transpose() * field_n;
        samples.push_back(
            {scenario.origin + Duration::from_seconds(t), C_sb * (soft * field_b + hard) + s.white * white.normal3()});
    }
    return samples;
}

}  // namespace schuler::sim
