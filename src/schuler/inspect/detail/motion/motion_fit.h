// Inertial data integrated in short windows and fitted to GNSS velocities, with unknown attitude, biases and time lag: gives the
// directions in sensor axes and the lag of the GNSS without knowledge of the mounting.
#pragma once

#include "schuler/inspect/detail/motion/motion.h"
#include "schuler/inspect/detail/robust.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::inspect::detail {

/// GNSS quantity used in the fit.
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

/// Misfit of one window as a function of lag, in units of its own residual.
struct LagCurve {
    double t;  ///< middle of the window, s
    std::vector<double> horizontal;
};

struct MotionFit {
    int windows = 0;             ///< intervals with sufficient motion
    double window_length = 0.0;  ///< of those used for the lags, s
    Agreement horizontal;        ///< lag of the horizontal channels behind the IMU, s (positive: GNSS is late)
    Agreement down;              ///< likewise of the vertical channel
    double rms = 0.0;            ///< of the horizontal residuals at the best lag, median window, m/s
    double motion = 0.0;         ///< of the horizontal velocity about its mean, median window, m/s
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();   ///< median over windows, rad/s
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();  ///< likewise, m/s^2
    std::vector<LagCurve> curves;                          ///< of the windows, in order of time
    std::vector<Pointing> pointings;  ///< epochs faster than `pointing_speed` in windows where the heading is observable
};

/// Tested lags, s.
inline constexpr double first_lag = -0.48, lag_step = 0.04;
inline constexpr int lag_count = 45;

/// m/s: below this speed the direction of travel is too noisy.
inline constexpr double pointing_speed = 3.0;

/// Steps and turns are visible within 10 s; slow curves of a low-noise unit require a minute.
inline constexpr double short_window = 10.0, long_window = 60.0;  // s

/// Error of the lags not shown by the agreement of the windows, s: a gain error of the gyros rotates the fitted velocity by its
/// fraction of the angle turned, which resembles a lag over part of a curve; at most that fraction times the window length over pi.
[[nodiscard]] double lag_by_gain(const MotionFit& fit);

/// In each window of about 10 s the velocity is modelled as v(t) = v0 + g t + C_ns0 u(t - lag), with u the specific force
/// integrated by means of the gyros in the sensor axes at the window's start; unknowns are v0, C_ns0, the biases and the lag.
/// Gauss-Newton for the biases and the attitude (first-order preintegration as in Forster et al., IEEE Trans. Robotics 33(1),
/// 2017, eqs. (42) to (44) without the position), a scan over the lag.
/// @param gyro_bias rad/s; bias_known: it was measured at rest or by another fit (otherwise up to 3 deg/s is possible)
/// @param gravity m/s^2, local
[[nodiscard]] MotionFit fit_motion(const ImuSeries& imu, const GnssSeries& gnss, FitSource source,
                                   const Eigen::Vector3d& gyro_bias, bool bias_known, double gravity,
                                   double window_length = short_window);

/// Delay of the velocity column relative to the position column, s: displacements compared with the integral of the velocity.
/// @param down the vertical channel instead of the horizontal ones
[[nodiscard]] Agreement velocity_behind_position(const GnssSeries& gnss, bool down);

}  // namespace schuler::inspect::detail
