#include "schuler/sim/imu_errors.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::sim {

GaussMarkov::GaussMarkov(const Eigen::Vector3d& sigma, double time, math::Random random)
    : sigma_(sigma),
      time_(time),
      random_(std::move(random)),
      value_(sigma.cwiseProduct(random_.normal3())),
      none_(sigma.isZero(0.0)) {}

void GaussMarkov::relax(double times) {
    if (none_) return;     // its random numbers are no one else's
    if (times != step_) {  // the same at every sample of an instrument
        step_ = times;
        kept_ = std::exp(-times);
        fresh_ = std::sqrt(-std::expm1(-2.0 * times));
    }
    value_ = kept_ * value_ + fresh_ * sigma_.cwiseProduct(random_.normal3());
}

Flicker::Flicker(double instability, std::uint64_t seed, const std::string& channel) {
    // Time constants a factor r apart with equal variance s^2 give the density s^2 / (2 f ln r): s^2 = B^2 ln r / pi.
    constexpr double ratio = 4.0, shortest = 0.1, longest = 1e5;
    if (!(instability > 0.0)) return;
    const Eigen::Vector3d sigma = Eigen::Vector3d::Constant(instability * std::sqrt(std::log(ratio) / std::numbers::pi));
    for (double time = shortest; time < longest; time *= ratio)
        parts_.emplace_back(sigma, time, math::Random(seed, channel + "." + std::to_string(parts_.size())));
}

Eigen::Vector3d Flicker::value() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const GaussMarkov& part : parts_) sum += part.value();
    return sum;
}

void Flicker::advance(double dt) {
    for (GaussMarkov& part : parts_) part.advance(dt);
}

SensorTriad::SensorTriad(const Sigmas& sigmas, std::uint64_t seed, const std::string& channel)
    : sigmas_(sigmas),
      turn_on_(sigmas.turn_on * math::Random(seed, channel + ".turn_on").normal3()),
      gain_(Eigen::Matrix3d::Identity()),
      in_run_(Eigen::Vector3d::Constant(sigmas.bias), sigmas.bias_time, math::Random(seed, channel + ".in_run")),
      flicker_(sigmas.flicker, seed, channel + ".flicker"),
      noise_(seed, channel + ".noise"),
      walk_(seed, channel + ".walk"),
      by_warmth_(sigmas.temperature * math::Random(seed, channel + ".temperature").normal3()) {
    math::Random g(seed, channel + ".g");
    for (Eigen::Index i = 0; i < 9; ++i) by_g_(i) = sigmas.cross * g.normal();
    gain_.diagonal() += sigmas.scale * math::Random(seed, channel + ".scale").normal3();
    math::Random misalignment(seed, channel + ".misalignment");
    for (Eigen::Index row = 0; row < 3; ++row) {
        for (Eigen::Index column = 0; column < 3; ++column) {
            if (row != column) gain_(row, column) = sigmas.misalignment * misalignment.normal();
        }
    }
}

Eigen::Vector3d SensorTriad::measure(const Eigen::Vector3d& exact, double dt, const Surroundings& around) {
    const Eigen::Vector3d before = bias();
    in_run_.advance(dt);
    flicker_.advance(dt);
    if (sigmas_.rate_walk > 0.0) walked_ += sigmas_.rate_walk * std::sqrt(dt) * walk_.normal3();
    if (sigmas_.temperature > 0.0) warm_ = around.warmth * by_warmth_;
    Eigen::Vector3d out = gain_ * exact + 0.5 * dt * (before + bias()) + sigmas_.noise * std::sqrt(dt) * noise_.normal3();
    if (sigmas_.cross > 0.0) out += by_g_ * around.dv;
    if (sigmas_.range > 0.0) out = out.cwiseMax(-sigmas_.range * dt).cwiseMin(sigmas_.range * dt);
    if (sigmas_.quantum > 0.0) {
        const Eigen::Vector3d whole = out + unsent_;
        out = (whole / sigmas_.quantum).array().round().matrix() * sigmas_.quantum;
        unsent_ = whole - out;
    }
    return out;
}

SensorTriad gyro_triad(const sensor::ImuErrorModel& m, std::uint64_t seed) {
    return {{m.gyro_noise, m.gyro_bias, m.gyro_bias_time, m.gyro_turn_on_bias, m.gyro_scale, m.gyro_misalignment, m.gyro_quantum,
             m.gyro_rate_walk, m.gyro_flicker, m.gyro_temperature, m.gyro_g, m.gyro_range},
            seed,
            "imu.gyro"};
}

SensorTriad accel_triad(const sensor::ImuErrorModel& m, std::uint64_t seed) {
    return {{m.accel_noise, m.accel_bias, m.accel_bias_time, m.accel_turn_on_bias, m.accel_scale, m.accel_misalignment,
             m.accel_quantum, m.accel_rate_walk, m.accel_flicker, m.accel_temperature, 0.0, m.accel_range},
            seed,
            "imu.accel"};
}

}  // namespace schuler::sim
