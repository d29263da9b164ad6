// A survey: the one filter with the states of the integrated gravimetric system along prepared data, forward and back, to the disturbance of
// gravity at the fixes.
#pragma once

#include "schuler/filter/states/model.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <vector>

namespace schuler::gravimetry {

/// An estimate after a fix, with what else was measured at its time.
struct SurveyEpoch {
    Time time;
    NavStateEcef nav;
    Eigen::Vector3d disturbance_n;  ///< gravity less normal gravity, north, east, down, m/s^2
    Eigen::Vector3d sigma_disturbance_n;
    Eigen::Vector3d sigma_random_n;                      ///< of its random part alone: of what changes along the track
    Eigen::Vector3d sigma_attitude_n;                    ///< rad
    Eigen::Vector3d sigma_velocity_n, sigma_position_n;  ///< m/s, m
    Eigen::Vector3d accel_bias, gyro_bias, sigma_accel_bias, sigma_gyro_bias;  ///< body axes, m/s^2 and rad/s
    Eigen::Vector3d f_n = Eigen::Vector3d::Zero();  ///< mean specific force since the fix before, of the forward filter, m/s^2
    double nis = 0.0;                               ///< squares of the fix's innovations by their variance, of the forward filter
    int measured = 0;                               ///< degrees of freedom of that; none where the fix was refused
    std::size_t fix = 0;                            ///< index into Recording::gnss
};

struct SurveyResult {
    std::vector<SurveyEpoch> forward;
    std::vector<SurveyEpoch> smoothed;        ///< empty where not asked for; as many as forward otherwise
    std::vector<filter::AidRecord> aids;      ///< of the forward filter
    std::vector<filter::LayoutBlock> states;  ///< the filter's, beyond navigation
    std::vector<filter::ParameterRow> parameters, smoothed_parameters;  ///< of these, as many as forward and smoothed
    std::vector<filter::CovarianceRow> covariances;  ///< of the forward filter, where Settings::covariance_rows asks for it
};

/// What gravi-inertial estimation needs of settings for navigation: the preset gravity27. Loose coupling in Earth-fixed axes with the
/// disturbance as states. Left out is what is not known to the size of a milligal, or would correct by other means than an optimal
/// update: standing still and wheels, magnetometer, odometer, the barometer's wandering bias, fixes used in parts, integrity control.
[[nodiscard]] filter::Settings gravity27(filter::Settings settings, const filter::DisturbanceSettings& disturbance);

struct SurveyOptions {
    bool smooth = true;
    std::vector<Time> steps{};  ///< rising: the systematic part of the disturbance may have changed there by its prior
    std::size_t stretch = 512;  ///< increments that the smoother replays at once; one filter is kept a stretch
    std::function<void(double)> progress{};
};

/// Runs it, from the first measurement after the start on. Settings as gravity27 returns them. @throws Error(Input) where no fix lies among the increments,
/// Error(Computation) where the filter diverges.
[[nodiscard]] SurveyResult run_survey(const filter::RunData& data, const filter::Settings& settings, const filter::Start& start,
                                      const SurveyOptions& options);

}  // namespace schuler::gravimetry
