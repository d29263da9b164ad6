// Specific force integrated in the sensor axes of a start sample, with its derivatives with respect to the biases.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::inspect::detail {

struct Preintegral {
    Eigen::Vector3d u;                ///< integral of R f, m/s (R: sensor axes now to sensor axes at the start)
    Eigen::Matrix3d u_by_gyro_bias;   ///< s * m/s
    Eigen::Matrix3d u_by_accel_bias;  ///< s

    [[nodiscard]] static Preintegral zero();
    void add(const Preintegral& other, double weight);
};

/// The integrals at every IMU sample of an interval, for one pair of biases (rad/s, m/s^2), and between samples.
class PreintegratedPath {
public:
    PreintegratedPath(const ImuSeries& imu, std::size_t first, std::size_t last, const Eigen::Vector3d& gyro_bias,
                      const Eigen::Vector3d& accel_bias);
    /// Linear between samples; constant beyond the ends.
    [[nodiscard]] Preintegral at(double t) const;
    /// R at the last sample not after t.
    [[nodiscard]] const Eigen::Matrix3d& rotation_at(double t) const;

private:
    std::vector<double> t_;
    std::vector<Preintegral> at_sample_;
    std::vector<Eigen::Matrix3d> rotation_;
};

}  // namespace schuler::inspect::detail
