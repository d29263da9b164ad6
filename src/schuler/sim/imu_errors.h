// Errors of an inertial measurement unit, added to exact increments.
#pragma once

#include "schuler/math/random.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/inverse_imu.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace schuler::sim {

/// A first-order Gauss-Markov process in three axes, started in its stationary state, exact at any step.
class GaussMarkov {
public:
    /// sigma: stationary, per axis; time: correlation time, s (infinite: a constant).
    GaussMarkov(const Eigen::Vector3d& sigma, double time, math::Random random);
    [[nodiscard]] const Eigen::Vector3d& value() const { return value_; }
    void advance(double dt) { relax(dt / time_); }
    /// Advances by a number of correlation times, for a process whose correlation is not one of time alone.
    void relax(double times);
    /// Adds a disturbance.
    void disturb(const Eigen::Vector3d& by) { value_ += by; }

private:
    Eigen::Vector3d sigma_;
    double time_;
    math::Random random_;
    Eigen::Vector3d value_;
};

/// Three gyros or three accelerometers: the constants of a run, its in-run bias and its noise.
class SensorTriad {
public:
    struct Sigmas {
        double noise, bias, bias_time, turn_on, scale, misalignment, quantum;
    };
    SensorTriad(const Sigmas& sigmas, std::uint64_t seed, const std::string& channel);

    /// Measured increment of a sample of dt seconds; the process advances.
    [[nodiscard]] Eigen::Vector3d measure(const Eigen::Vector3d& exact, double dt);

    /// Turn-on plus in-run bias now.
    [[nodiscard]] Eigen::Vector3d bias() const { return turn_on_ + in_run_.value(); }
    /// I + S + M of ImuErrorModel.
    [[nodiscard]] const Eigen::Matrix3d& gain() const { return gain_; }

private:
    Sigmas sigmas_;
    Eigen::Vector3d turn_on_;
    Eigen::Matrix3d gain_;
    GaussMarkov in_run_;
    math::Random noise_;
    Eigen::Vector3d unsent_ = Eigen::Vector3d::Zero();  ///< below the quantum, kept for the next sample
};

[[nodiscard]] SensorTriad gyro_triad(const sensor::ImuErrorModel& model, std::uint64_t seed);
[[nodiscard]] SensorTriad accel_triad(const sensor::ImuErrorModel& model, std::uint64_t seed);

}  // namespace schuler::sim
