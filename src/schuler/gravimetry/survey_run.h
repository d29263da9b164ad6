// A survey from increments and fixes to the disturbance along the track: forward filter and fixed-interval smoother.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/gravimetry/settings.h"
#include "schuler/gravimetry/survey_aids.h"

#include <cstddef>
#include <vector>

namespace schuler::gravimetry {

struct SurveyInput {
    NavStateEcef start;                  ///< at the start of the first increment
    std::vector<ImuIncrement> imu;       ///< body axes, without gaps
    std::vector<AntennaFix> fixes;       ///< rising times
    std::vector<HeightFix> heights{};    ///< rising times, gauge by gauge of one time; may be empty, like the next two
    std::vector<BodyVelocityFix> velocities{};
    std::vector<HeadingFix> headings{};
    std::vector<Time> steps{};           ///< rising: the systematic part of the disturbance may have changed there
};

/// An estimate after a fix.
struct SurveyEpoch {
    Time time;
    NavStateEcef nav;
    Eigen::Vector3d disturbance_n;       ///< gravity less normal gravity, north, east, down, m/s^2
    Eigen::Vector3d sigma_disturbance_n;
    Eigen::Vector3d sigma_random_n;      ///< of its random part alone: of what changes along the track
    Eigen::Vector3d sigma_attitude_n;    ///< rad
    Eigen::Vector3d sigma_velocity_n, sigma_position_n;      ///< m/s, m
    Eigen::Vector3d accel_bias, gyro_bias, sigma_accel_bias, sigma_gyro_bias;   ///< body axes, m/s^2 and rad/s
    Eigen::Vector3d f_n;                 ///< mean specific force since the fix before, of the forward filter, m/s^2
    double nis = 0.0;  ///< squares of the fix's innovations by their variance, of the forward filter
    int measured = 0;  ///< degrees of freedom of that
};

struct SurveyResult {
    std::vector<SurveyEpoch> forward;
    std::vector<SurveyEpoch> smoothed;   ///< empty where not asked for; as many as forward otherwise
};

/// A fix is used at the last increment that ends at most half a sample after it, moved there by the velocity. Smoothing
/// keeps 24 kB for each of `stretch` measurements and one filter a stretch: longer logs are filtered twice, a stretch at a time.
/// @throws Error(Input) where increments do not follow each other or no fix lies among them.
[[nodiscard]] SurveyResult run_survey(const SurveySettings& settings, const SurveyInput& input, bool smooth,
                                      std::size_t stretch = 16384);

}  // namespace schuler::gravimetry
