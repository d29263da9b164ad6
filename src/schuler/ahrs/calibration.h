// Three-axis instruments calibrated from the log itself. Readings of a field of constant size lie on an ellipsoid; how much of it they
// show is the fit's covariance, what they do not show stays at the prior, and a judge applies the fit only where parts of the log that
// were held out agree better with it than without.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace schuler::ahrs {

inline constexpr int ellipsoid_parameters = 9;  ///< offset, then the gain's xx, yy, zz, xy, xz, yz

/// What is known before any reading, one sigma.
struct EllipsoidPrior {
    double offset_std = 0.0;  ///< in the unit of the readings
    double gain_std = 0.05;   ///< of each element, from the identity
    double noise = 0.0;       ///< of one reading's size, unit of the readings
    double alike = 1.0;       ///< neighbouring readings that tell no more than one
};

/// true = gain * (measured - offset). The gain is symmetric: a rotation of the instrument's axes does not show in the size.
struct EllipsoidFit {
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, ellipsoid_parameters, ellipsoid_parameters> covariance =
        Eigen::Matrix<double, ellipsoid_parameters, ellipsoid_parameters>::Zero();
    double size = 0.0;      ///< of the field, in the unit of the readings
    double residual = 0.0;  ///< one sigma of the calibrated size, same unit
    std::size_t samples = 0;

    [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& measured) const { return gain * (measured - offset); }
    /// One sigma of the offset's worst direction, in the unit of the readings.
    [[nodiscard]] double offset_std() const;
};

/// Most probable ellipsoid by iterated least squares, readings far off weighed down. `size`: the true size of the field; not positive:
/// the size of the sphere through the readings. Nothing where fewer than four readings are finite or no sphere goes through them.
[[nodiscard]] std::optional<EllipsoidFit> fit_ellipsoid(std::span<const Eigen::Vector3d> readings, double size,
                                                        const EllipsoidPrior& prior);

/// Size of the calibrated field less the true size, and its derivative by the parameters.
struct SizeError {
    double error = 0.0;
    Eigen::Matrix<double, 1, ellipsoid_parameters> H;
};
[[nodiscard]] SizeError size_error(const EllipsoidFit& fit, const Eigen::Vector3d& measured);

/// Mean specific force (m/s^2) of each stretch of 0.5 s in which neither instrument moves: readings of gravity for fit_ellipsoid.
[[nodiscard]] std::vector<Eigen::Vector3d> still_forces(std::span<const ImuSample> imu);

/// What became of a calibration. Applied where `fit` is there; `reason` says what the held-out parts of the log showed, either way.
struct JudgedCalibration {
    std::optional<EllipsoidFit> fit;
    std::string reason;
};

/// Fit on all but one part, tested on that part, in turns. Magnetometer: size of the field, its part along the specific force (dip),
/// and its turning against the gyro's, each over the held-out stretches. `size`: of the Earth's field (T) where known.
[[nodiscard]] JudgedCalibration judge_magnetometer(std::span<const ImuSample> imu, std::span<const MagSample> mag, double size);
/// Accelerometer: size of the force at rest in the held-out attitude; at least five attitudes are needed.
[[nodiscard]] JudgedCalibration judge_accelerometer(std::span<const ImuSample> imu, double gravity);

}  // namespace schuler::ahrs
