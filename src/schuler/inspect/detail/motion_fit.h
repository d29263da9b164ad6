// Integrated inertial data fitted to GNSS velocities in short windows, with attitude, biases and time lag unknown: where the
// sensor axes point and how late the GNSS is, without knowing the mounting.
#pragma once

#include "schuler/inspect/detail/motion.h"
#include "schuler/inspect/detail/robust.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::inspect::detail {

/// What the GNSS side of the fit is.
enum class FitSource {
    Velocity,      ///< velocities at their stamps
    Displacement,  ///< mean velocities between consecutive positions
};

/// Directions at one GNSS epoch of a moving vehicle, in sensor axes, from the fitted attitude.
struct Pointing {
    double t;
    double speed;              ///< horizontal, m/s
    Eigen::Vector3d travel_s;  ///< unit vector of the velocity
    Eigen::Vector3d down_s;    ///< unit vector of the vertical
    Eigen::Matrix3d C_ns;      ///< sensor to north-east-down
};

/// How badly one window fits at each lag, in units of its own residual.
struct LagCurve {
    double t;  ///< middle of the window, s
    std::vector<double> horizontal;
};

struct MotionFit {
    int windows = 0;             ///< stretches with enough motion
    double window_length = 0.0;  ///< of those that the lags are from, s
    Agreement horizontal;        ///< lag of the horizontal channels behind the IMU, s (positive: GNSS is late)
    Agreement down;              ///< likewise of the vertical channel
    double rms = 0.0;            ///< of the horizontal residuals at the best lag, median window, m/s
    double motion = 0.0;         ///< of the horizontal velocity about its mean, median window, m/s
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< median over windows, rad/s
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< likewise, m/s^2
    std::vector<LagCurve> curves;                          ///< of the windows, in order of time
    std::vector<Pointing> pointings;  ///< epochs faster than `pointing_speed` in windows that show the heading
};

/// Lags that are tried, s.
inline constexpr double first_lag = -0.48, lag_step = 0.04;
inline constexpr int lag_count = 45;

/// m/s: slower, the direction of travel is noisy.
inline constexpr double pointing_speed = 3.0;

/// Motion of steps and turns shows in 10 s; slow curves of a quiet unit need a minute.
inline constexpr double short_window = 10.0, long_window = 60.0;  // s

/// What the agreement among the windows does not show of their lags, s: a gain error of the gyros turns the fitted velocity by its share
/// of the angle that was turned, which over a part of a curve looks like a lag; at most the share times the window's length over pi.
[[nodiscard]] double lag_by_gain(const MotionFit& fit);

/// In each window of about 10 s the velocity is modelled as v(t) = v0 + g t + C_ns0 u(t - lag), u being the specific force
/// integrated in the sensor axes of the window's start by the gyros; unknown are v0, C_ns0, the biases and the lag. Gauss-Newton
/// on the biases and the attitude (first-order preintegration as Forster et al., IEEE Trans. Robotics 33(1), 2017, eqs. (42) to
/// (44) without the position), a scan over the lag.
/// @param gyro_bias rad/s; bias_known: it was measured at rest or by another fit (else it may be anything up to 3 deg/s)
/// @param gravity m/s^2, local
[[nodiscard]] MotionFit fit_motion(const ImuSeries& imu, const GnssSeries& gnss, FitSource source,
                                   const Eigen::Vector3d& gyro_bias, bool bias_known, double gravity,
                                   double window_length = short_window);

/// How much later the velocity column is than the position column, s: displacements against the integral of the velocity.
/// @param down the vertical channel instead of the horizontal ones
[[nodiscard]] Agreement velocity_behind_position(const GnssSeries& gnss, bool down);

}  // namespace schuler::inspect::detail
