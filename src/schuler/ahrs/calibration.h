// Calibration of three-axis instruments from the log itself. Readings of a field of constant magnitude lie on an ellipsoid; the
// covariance of the fit shows how well they determine it, and undetermined parameters stay at the prior. The fit is applied only
// if held-out parts of the log agree better with it than without.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace schuler::ahrs {

inline constexpr int ellipsoid_parameters = 9;  ///< offset, then the gain's xx, yy, zz, xy, xz, yz

/// Prior uncertainty, one sigma.
struct EllipsoidPrior {
    double offset_std = 0.0;  ///< in the unit of the readings
    double gain_std = 0.05;   ///< of each element, from the identity
    double noise = 0.0;       ///< of one reading's magnitude, unit of the readings
    double alike = 1.0;       ///< number of successive readings equivalent to one independent reading
};

/// true = gain * (measured - offset). The gain is symmetric: a rotation of the instrument's axes does not affect the magnitude.
struct EllipsoidFit {
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
    Eigen::Matrix3d gain = Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, ellipsoid_parameters, ellipsoid_parameters> covariance =
        Eigen::Matrix<double, ellipsoid_parameters, ellipsoid_parameters>::Zero();
    double size = 0.0;      ///< magnitude of the field, in the unit of the readings
    double residual = 0.0;  ///< one sigma of the calibrated magnitude, same unit
    std::size_t samples = 0;

    [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& measured) const { return gain * (measured - offset); }
    /// One sigma of the offset in its least determined direction, in the unit of the readings.
    [[nodiscard]] double offset_std() const;
};

/// Most probable ellipsoid by iterated least squares with down-weighted outliers. `size`: the true magnitude of the field; if not
/// positive, that of the sphere through the readings. Empty if fewer than four readings are finite or no sphere fits them.
[[nodiscard]] std::optional<EllipsoidFit> fit_ellipsoid(std::span<const Eigen::Vector3d> readings, double size,
                                                        const EllipsoidPrior& prior);

/// Calibrated magnitude minus the true one, and its derivatives with respect to the parameters.
struct SizeError {
    double error = 0.0;
    Eigen::Matrix<double, 1, ellipsoid_parameters> H;
};
[[nodiscard]] SizeError size_error(const EllipsoidFit& fit, const Eigen::Vector3d& measured);

/// Mean specific force (m/s^2) of each 0.5 s interval in which neither instrument moves: readings of gravity for fit_ellipsoid.
[[nodiscard]] std::vector<Eigen::Vector3d> still_forces(std::span<const ImuSample> imu);

/// Result of a calibration. Applied if `fit` is present; `reason` states the result for the held-out parts of the log in any case.
struct JudgedCalibration {
    std::optional<EllipsoidFit> fit;
    std::string reason;
};

/// Fits all parts but one, tests on that part, in rotation. Magnetometer: magnitude of the field, its component along the force
/// (dip), and its rotation compared with the gyro's, over the held-out intervals. `size`: of the Earth's field (T) if known.
[[nodiscard]] JudgedCalibration judge_magnetometer(std::span<const ImuSample> imu, std::span<const MagSample> mag, double size);
/// Accelerometer: magnitude of the force at rest in the held-out attitude; at least five attitudes are required.
[[nodiscard]] JudgedCalibration judge_accelerometer(std::span<const ImuSample> imu, double gravity);

}  // namespace schuler::ahrs
