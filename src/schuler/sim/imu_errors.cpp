#include "schuler/sim/imu_errors.h"

#include <cmath>
#include <utility>

namespace schuler::sim {

GaussMarkov::GaussMarkov(const Eigen::Vector3d& sigma, double time, math::Random random)
    : sigma_(sigma), time_(time), random_(std::move(random)), value_(sigma.cwiseProduct(random_.normal3())) {}

void GaussMarkov::relax(double times) {
    const double kept = std::exp(-times);
    const double fresh = std::sqrt(-std::expm1(-2.0 * times));
    value_ = kept * value_ + fresh * sigma_.cwiseProduct(random_.normal3());
}

SensorTriad::SensorTriad(const Sigmas& sigmas, std::uint64_t seed, const std::string& channel)
    : sigmas_(sigmas),
      turn_on_(sigmas.turn_on * math::Random(seed, channel + ".turn_on").normal3()),
      gain_(Eigen::Matrix3d::Identity()),
      in_run_(Eigen::Vector3d::Constant(sigmas.bias), sigmas.bias_time, math::Random(seed, channel + ".in_run")),
      noise_(seed, channel + ".noise") {
    gain_.diagonal() += sigmas.scale * math::Random(seed, channel + ".scale").normal3();
    math::Random misalignment(seed, channel + ".misalignment");
    for (Eigen::Index row = 0; row < 3; ++row) {
        for (Eigen::Index column = 0; column < 3; ++column) {
            if (row != column) gain_(row, column) = sigmas.misalignment * misalignment.normal();
        }
    }
}

Eigen::Vector3d SensorTriad::measure(const Eigen::Vector3d& exact, double dt) {
    const Eigen::Vector3d before = bias();
    in_run_.advance(dt);
    Eigen::Vector3d out =
        gain_ * exact + 0.5 * dt * (before + bias()) + sigmas_.noise * std::sqrt(dt) * noise_.normal3();
    if (sigmas_.quantum > 0.0) {
        const Eigen::Vector3d whole = out + unsent_;
        out = (whole / sigmas_.quantum).array().round().matrix() * sigmas_.quantum;
        unsent_ = whole - out;
    }
    return out;
}

SensorTriad gyro_triad(const sensor::ImuErrorModel& m, std::uint64_t seed) {
    return {{m.gyro_noise, m.gyro_bias, m.gyro_bias_time, m.gyro_turn_on_bias, m.gyro_scale, m.gyro_misalignment, m.gyro_quantum},
            seed, "imu.gyro"};
}

SensorTriad accel_triad(const sensor::ImuErrorModel& m, std::uint64_t seed) {
    return {{m.accel_noise, m.accel_bias, m.accel_bias_time, m.accel_turn_on_bias, m.accel_scale, m.accel_misalignment,
             m.accel_quantum},
            seed, "imu.accel"};
}

}  // namespace schuler::sim
