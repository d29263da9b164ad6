// Gyro bias for filters without such a state: the mean of the rates while the sensor is at rest.
#pragma once

#include "schuler/ahrs/settings.h"

#include <Eigen/Core>

namespace schuler::ahrs {

class RestBias {
public:
    explicit RestBias(const RestSettings& settings) : settings_(settings) {}

    /// One sample (rad/s, m/s^2) over dt (s); no magnetic quantity is used.
    void feed(double dt, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& force_b) {
        constexpr double block = 0.05;  // s; single samples are too noisy to show rest
        rate_ += rate_b * dt;
        force_ += force_b * dt;
        duration_ += dt;
        if (duration_ < block) return;
        const Eigen::Vector3d rate = rate_ / duration_, force = force_ / duration_;
        if (!watching_) {
            slow_rate_ = rate;
            slow_force_ = force;
            watching_ = true;
        }
        const bool quiet = (rate - slow_rate_).norm() < settings_.rate_change &&
                           (force - slow_force_).norm() < settings_.force_change && slow_rate_.norm() < settings_.largest_rate;
        const double gain = duration_ / (settings_.memory + duration_);
        slow_rate_ += gain * (rate - slow_rate_);
        slow_force_ += gain * (force - slow_force_);
        quiet_ = quiet ? quiet_ + duration_ : 0.0;
        turned_ = quiet ? (turned_ + rate_).eval() : Eigen::Vector3d::Zero().eval();
        if (quiet_ >= settings_.after) bias_ = turned_ / quiet_;
        rate_.setZero();
        force_.setZero();
        duration_ = 0.0;
    }
    [[nodiscard]] const Eigen::Vector3d& bias() const { return bias_; }  ///< rad/s; zero until the first rest

private:
    RestSettings settings_;
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero(), rate_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d slow_rate_ = Eigen::Vector3d::Zero(), slow_force_ = Eigen::Vector3d::Zero(),
                    turned_ = Eigen::Vector3d::Zero();
    double duration_ = 0.0, quiet_ = 0.0;
    bool watching_ = false;
};

}  // namespace schuler::ahrs
