// Errors of an inertial measurement unit, added to exact increments.
#pragma once

#include "schuler/math/random.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/inverse_imu.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

namespace schuler::sim {

/// A first-order Gauss-Markov process in three axes, initially stationary, exact for any step.
class GaussMarkov {
public:
    /// sigma: stationary, per axis; time: correlation time, s (infinite: a constant).
    GaussMarkov(const Eigen::Vector3d& sigma, double time, math::Random random);
    [[nodiscard]] const Eigen::Vector3d& value() const { return value_; }
    void advance(double dt) { relax(dt / time_); }
    /// Advances by a number of correlation times, for a process whose correlation does not depend on time alone.
    void relax(double times);
    /// Adds a disturbance.
    void disturb(const Eigen::Vector3d& by) {
        value_ += by;
        none_ = false;
    }

private:
    Eigen::Vector3d sigma_;
    double time_;
    math::Random random_;
    Eigen::Vector3d value_;
    bool none_;           ///< zero sigma, and nothing has disturbed it
    double step_ = -1.0;  ///< correlation times of the last step, and its factors
    double kept_ = 1.0, fresh_ = 0.0;
};

/// 1/f noise in three axes between 1e-5 and 1 Hz: Gauss-Markov processes of equal sigma with correlation times a factor of four
/// apart. Their sum has the density B^2 / (2 pi f) of [IEEE952] within 2 %.
class Flicker {
public:
    Flicker(double instability, std::uint64_t seed, const std::string& channel);
    [[nodiscard]] Eigen::Vector3d value() const;
    void advance(double dt);

private:
    std::vector<GaussMarkov> parts_;  ///< none without bias instability
};

/// Three gyros or three accelerometers: the constants of a run, the varying biases and the noise.
class SensorTriad {
public:
    struct Sigmas {
        double noise, bias, bias_time, turn_on, scale, misalignment, quantum;
        double rate_walk = 0.0, flicker = 0.0, temperature = 0.0, cross = 0.0, range = 0.0;
    };
    /// Disturbances acting on an instrument.
    struct Surroundings {
        double warmth = 0.0;                           ///< K above the calibration temperature
        Eigen::Vector3d dv = Eigen::Vector3d::Zero();  ///< velocity increment of the sample, for the g-dependent errors of a gyro
    };
    SensorTriad(const Sigmas& sigmas, std::uint64_t seed, const std::string& channel);

    /// Measured increment of a sample of dt seconds; the processes advance.
    [[nodiscard]] Eigen::Vector3d measure(const Eigen::Vector3d& exact, double dt, const Surroundings& around);
    [[nodiscard]] Eigen::Vector3d measure(const Eigen::Vector3d& exact, double dt) { return measure(exact, dt, {}); }

    /// Total current bias except the g-dependent one.
    [[nodiscard]] Eigen::Vector3d bias() const { return turn_on_ + in_run_.value() + walked_ + warm_ + flicker_.value(); }
    /// I + S + M of ImuErrorModel.
    [[nodiscard]] const Eigen::Matrix3d& gain() const { return gain_; }

private:
    Sigmas sigmas_;
    Eigen::Vector3d turn_on_;
    Eigen::Matrix3d gain_;
    GaussMarkov in_run_;
    Flicker flicker_;
    math::Random noise_, walk_;
    Eigen::Vector3d walked_ = Eigen::Vector3d::Zero(), warm_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d by_warmth_;  ///< per kelvin
    Eigen::Matrix3d by_g_;
    Eigen::Vector3d unsent_ = Eigen::Vector3d::Zero();  ///< below the quantum, carried over to the next sample
};

[[nodiscard]] SensorTriad gyro_triad(const sensor::ImuErrorModel& model, std::uint64_t seed);
[[nodiscard]] SensorTriad accel_triad(const sensor::ImuErrorModel& model, std::uint64_t seed);

}  // namespace schuler::sim
