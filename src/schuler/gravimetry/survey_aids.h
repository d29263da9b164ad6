// What a survey can measure beside satellites: heights by pressure gauges, velocity through the water or over the bottom in body
// axes, heading by a compass. Every instrument's constant errors are states.
#pragma once

#include "schuler/gravimetry/survey_state.h"

namespace schuler::gravimetry {

/// Height above the ellipsoid by a depth gauge, barometer or altimeter, its unknown level being a state of its own. Two gauges on
/// a line along the body tell pitch, a third one beside it tells roll.
struct HeightFix {
    Time time;
    double height = 0.0;  ///< m
    double sigma = 1.0;  ///< white part, m
    int gauge = 0;  ///< which of max_gauges
};

/// Velocity of a log (Doppler or other) against the Earth, at its lever arm, in body axes.
struct BodyVelocityFix {
    Time time;
    Eigen::Vector3d velocity_b;  ///< m/s
    Eigen::Vector3d sigma_b = Eigen::Vector3d::Constant(0.01);  ///< m/s; infinite: not measured
};

/// Heading by a magnetic or gyro compass, true north.
struct HeadingFix {
    Time time;
    double heading = 0.0;  ///< rad
    double sigma = 0.01;  ///< rad
};

/// Computed minus measured, m. lever_arm_b: IMU to gauge, m.
[[nodiscard]] double height_innovation(const earth::Earth& earth, const SurveyState& state, const Eigen::Vector3d& lever_arm_b,
                                       const HeightFix& fix);
/// Its row: innovation = h . error.
[[nodiscard]] StateVector gravity_height_row(const earth::Earth& earth, const SurveyState& state,
                                             const Eigen::Vector3d& lever_arm_b, int gauge);

/// Computed minus measured, m/s: the log shows (1 + scale) (v + misalignment x v), misaligned about the right and down axes
/// (about the forward axis nothing changes for what moves forward). w_ib_b: rate of the body less the estimated errors, rad/s.
[[nodiscard]] Eigen::Vector3d body_velocity_innovation(const earth::Earth& earth, const SurveyState& state,
                                                       const Eigen::Vector3d& lever_arm_b, const Eigen::Vector3d& w_ib_b,
                                                       const BodyVelocityFix& fix);
using BodyVelocityRows = Eigen::Matrix<double, 3, max_states>;
[[nodiscard]] BodyVelocityRows gravity_body_velocity_rows(const earth::Earth& earth, const SurveyState& state,
                                                          const Eigen::Vector3d& lever_arm_b, const Eigen::Vector3d& w_ib_b);

/// Computed minus measured, rad, within half a turn. Pitch is not near 90 degrees.
[[nodiscard]] double heading_innovation(const earth::Earth& earth, const SurveyState& state, const HeadingFix& fix);
[[nodiscard]] StateVector gravity_heading_row(const earth::Earth& earth, const SurveyState& state);

}  // namespace schuler::gravimetry
