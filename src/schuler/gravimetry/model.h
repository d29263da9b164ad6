// The error model of the gravi-inertial complex [PaperE]: 27 states in Earth-fixed axes, more where the disturbance of gravity
// is given slopes. math.md section 4, turned to error = estimate minus truth for every state, sensor errors included.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

namespace schuler::gravimetry {

/// First of three components each. All are in Earth-fixed axes but the inertial sensors' errors (body axes) and the disturbance
/// (DisturbanceAxes).
enum StateIndex : int {
    position = 0,         ///< m
    velocity = 3,         ///< m/s
    attitude = 6,         ///< phi, rad: C_est = (I - [phi x]) C
    accel_bias = 9,       ///< m/s^2
    gyro_bias = 12,       ///< rad/s
    gnss_position = 15,   ///< systematic error of the receiver, m
    gnss_velocity = 18,   ///< m/s
    systematic = 21,      ///< constant part of the disturbance, m/s^2
    random = 24,          ///< its random part, m/s^2
    slope = 27,           ///< of the systematic part (polynomial) or of the random one, m/s^2 per metre along the track
    curvature = 30,       ///< second derivative of the same, m/s^2 per square metre
    height_bias = 33,     ///< one component for each of max_gauges: constant error of a depth gauge or barometer, m
    heading_bias = 36,    ///< one component: of a compass, rad
    log_scale = 37,       ///< one component: of a log of velocity in body axes
    log_misalignment = 38,///< two components: of the same about the right and down axes, rad
};
inline constexpr int max_gauges = 3;
/// Room for every model; 40 so that columns are whole vectors. States that a model does not have keep zero variance.
inline constexpr int max_states = 40;
using StateVector = Eigen::Matrix<double, max_states, 1>;
using StateMatrix = Eigen::Matrix<double, max_states, max_states>;
using NoiseMatrix = Eigen::Matrix<double, max_states, 15>;
using GnssRows = Eigen::Matrix<double, 6, max_states>;

enum class DisturbanceKind {
    Constant,           ///< the systematic part alone
    FirstOrder,         ///< and a first-order Gauss-Markov process: the paper's
    RampAndFirstOrder,  ///< constant + ramp + first order (no more than the polynomial where sigma is zero)
    QuadraticAndFirstOrder,   ///< constant + ramp + parabola + first order
    SecondOrder,        ///< constant + second-order Gauss-Markov, correlation (1 + x) exp(-x), x = distance / length
    ThirdOrder,         ///< constant + third order, (1 + x + x^2/3) exp(-x): smooth enough for a slope of a slope
};

/// In which axes the disturbance's components follow their model. The paper's are Earth-fixed: what is constant in them turns
/// against the vertical as the vehicle moves. A field of the ground, and every simulated one here, is told east, north and up.
enum class DisturbanceAxes { LocalLevel, EarthFixed };

/// How the disturbance of gravity changes along the track.
struct DisturbanceModel {
    DisturbanceKind kind = DisturbanceKind::Constant;
    double length = 0.0;    ///< correlation length of the random part, m (s where `by_time`); infinity: it is constant
    Eigen::Vector3d sigma_n = Eigen::Vector3d::Zero();   ///< of the random part, north, east, down, m/s^2
    bool by_time = false;   ///< the process runs with time, as the paper's mu = 1/length, instead of along the track
    DisturbanceAxes axes = DisturbanceAxes::LocalLevel;   ///< of the states (north, east, down, or Earth-fixed)

    /// Throws Error(Input) naming the value that is unusable.
    void check() const;
    /// Error states of the model: 27, 30 or 33.
    [[nodiscard]] int states() const;
    /// Of the polynomial along the track that the systematic part is.
    [[nodiscard]] int degree() const {
        return kind == DisturbanceKind::QuadraticAndFirstOrder ? 2 : kind == DisturbanceKind::RampAndFirstOrder ? 1 : 0;
    }
    /// Metres along the track (seconds where by_time) in a second at an Earth-fixed velocity.
    [[nodiscard]] double pace(const Eigen::Vector3d& v_eb_e) const { return by_time ? 1.0 : v_eb_e.norm(); }
    /// The disturbance's components to Earth-fixed axes, at a place with this C_en.
    [[nodiscard]] Eigen::Matrix3d to_earth_fixed(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? C_en : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    }
    /// North, east, down to the disturbance's axes.
    [[nodiscard]] Eigen::Matrix3d from_local_level(const Eigen::Matrix3d& C_en) const {
        return axes == DisturbanceAxes::LocalLevel ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : C_en;
    }
    /// Stationary covariance of (value, slope, curvature) of a component with unit sigma; orders that are not there are zero.
    [[nodiscard]] Eigen::Matrix3d stationary() const;
};

/// White noise of the inertial sensors and the random walks of their biases, one axis.
struct SensorNoise {
    double gyro_psd = 0.0;         ///< rad^2/s
    double accel_psd = 0.0;        ///< m^2/s^3
    double gyro_bias_psd = 0.0;    ///< rad^2/s^3; 0: constant, as [PaperE] has it
    double accel_bias_psd = 0.0;   ///< m^2/s^5
};

/// Where F is taken: of an instant, or means over a step.
struct Motion {
    Ecef position;
    Eigen::Vector3d v_eb_e = Eigen::Vector3d::Zero();        ///< m/s
    Eigen::Matrix3d C_eb = Eigen::Matrix3d::Identity();
    Eigen::Vector3d f_e = Eigen::Vector3d::Zero();           ///< specific force, m/s^2
};

/// F: dx/dt = F x + G w. Derivatives of `advanced` (survey_state.h), but for the turn of a local-level disturbance with an error
/// of position: 1.6e-11 1/s^2 for 10 mGal, a hundred-thousandth of the gravity gradient. That gradient is that of the Earth's
/// gravity model, its centrifugal part included.
[[nodiscard]] StateMatrix gravity_error_dynamics(const earth::Earth& earth, const DisturbanceModel& disturbance, const Motion& motion);

/// G for w = (gyro noise, accelerometer noise, disturbance, accelerometer and gyro bias walks) of unit densities, the sensors'
/// measured minus true: columns are scaled by the roots of the densities of `noise` and of the disturbance model.
[[nodiscard]] NoiseMatrix gravity_noise_input(const earth::Earth& earth, const DisturbanceModel& disturbance,
                                              const SensorNoise& noise, const Motion& motion);

/// Derivative of the random part's (value, slope, curvature) by distance along the track: `advanced` and F share it.
[[nodiscard]] Eigen::Matrix3d random_part_dynamics(const DisturbanceModel& disturbance);

/// H of (position, velocity) of a receiver, computed minus measured, Earth-fixed axes. lever_arm_b: IMU to antenna, m;
/// w_eb_b: rate of the body against the Earth, rad/s.
[[nodiscard]] GnssRows gravity_gnss_rows(const Eigen::Matrix3d& C_eb, const Eigen::Vector3d& lever_arm_b,
                                         const Eigen::Vector3d& w_eb_b);

}  // namespace schuler::gravimetry
