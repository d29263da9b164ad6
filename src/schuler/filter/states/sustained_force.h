// How far the specific force on the gyros is from the one that their estimated biases belong to.
#pragma once

#include <Eigen/Core>

namespace schuler::filter {

/// The specific force in body axes now, without vibration, less the usual one: what a g-dependent gyro bias changes by. Plain and copyable.
struct SustainedForce {
    static constexpr double vibration = 1.0;  ///< s: shorter changes, by engines, steps and bumps, average out
    static constexpr double usual = 30.0;     ///< s: longer ones are in the estimated biases

    Eigen::Vector3d now = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();  ///< m/s^2
    double time = 0.0;                                                              ///< s, since the start, at most `usual`

    /// Specific force (body axes, m/s^2) over the last dt (s).
    void add(const Eigen::Vector3d& force, double dt) {
        time = time + dt < usual ? time + dt : usual;
        now += (time > dt ? dt / ((time < vibration ? time : vibration) + dt) : 1.0) * (force - now);
        mean += dt / time * (now - mean);
    }
    /// Square of the change times the time, m^2/s^3, with which white noise causes the same error as a constant in a pull of five seconds.
    [[nodiscard]] double gathered_square() const {
        constexpr double pull = 8.0;  // s
        return pull * (now - mean).squaredNorm();
    }
};

}  // namespace schuler::filter
