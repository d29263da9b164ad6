// What the gravimetric filter estimates, its mechanization, and how errors are applied to it.
#pragma once

#include "schuler/gravimetry/model.h"
#include "schuler/ins/increments.h"

#include <Eigen/Core>

namespace schuler::gravimetry {

/// Nominal state. `parameters` from `accel_bias` on: what sensors show beyond the truth, and the disturbance (gravity less normal
/// gravity, in the axes of its model); the first nine are unused.
struct SurveyState {
    NavStateEcef nav;
    StateVector parameters = StateVector::Zero();

    /// Disturbance of gravity in the axes of its model, m/s^2.
    [[nodiscard]] Eigen::Vector3d disturbance() const {
        return parameters.segment<3>(systematic) + parameters.segment<3>(random);
    }
};

/// Position and velocity of an antenna, Earth-fixed axes; sigmas of their white errors north, east, down.
struct AntennaFix {
    Time time;
    Eigen::Vector3d position, velocity;   ///< m, m/s
    Eigen::Vector3d sigma_position_n = Eigen::Vector3d::Ones();             ///< m
    Eigen::Vector3d sigma_velocity_n = Eigen::Vector3d::Constant(0.05);     ///< m/s; infinite: not measured
};

/// The increment less the estimated sensor errors.
[[nodiscard]] ImuIncrement without_sensor_errors(const SurveyState& state, const ImuIncrement& raw);

/// One step of the mechanization in Earth-fixed axes, the estimated disturbance added to normal gravity; the random part follows
/// its model along the track. `increment` is free of sensor errors.
[[nodiscard]] SurveyState advanced(const earth::Earth& earth, const DisturbanceModel& disturbance, const SurveyState& state,
                                   const ins::CompensatedIncrement& increment);

/// Computed minus measured: position and velocity of the antenna. w_ib_b: rate of the body less the estimated errors, rad/s.
[[nodiscard]] Eigen::Matrix<double, 6, 1> gnss_innovation(const earth::Earth& earth, const SurveyState& state,
                                                          const Eigen::Vector3d& lever_arm_b, const Eigen::Vector3d& w_ib_b,
                                                          const AntennaFix& fix);

/// The state with the error dx (estimate minus truth) removed, and the estimate that has it.
[[nodiscard]] SurveyState corrected(const SurveyState& estimate, const StateVector& dx);
[[nodiscard]] SurveyState perturbed(const SurveyState& truth, const StateVector& dx);

}  // namespace schuler::gravimetry
