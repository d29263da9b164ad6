// Evidence that the body moves like a wheeled vehicle.
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace schuler::filter {

/// Direction of motion in body axes while GNSS keeps the velocity accurate.
struct WheelEvidence {
    enum class Verdict : std::uint8_t { Open, Wheels, NoWheels };
    Verdict verdict = Verdict::Open;
    int n = 0;
    double turned = 0.0;                      ///< rad, total turn during the observation
    double mean_side = 0.0, mean_down = 0.0;  ///< tangents of the direction of motion
    double m2_side = 0.0, m2_down = 0.0;      ///< sums of squared deviations

    /// Adds one direction; decides after a minute of motion that includes at least a quarter turn.
    void add(const Eigen::Vector3d& v_b, double turn, double interval);
    [[nodiscard]] double std_side() const { return std::sqrt(m2_side / std::max(1, n - 1)); }
    [[nodiscard]] double std_down() const { return std::sqrt(m2_down / std::max(1, n - 1)); }
};

}  // namespace schuler::filter
