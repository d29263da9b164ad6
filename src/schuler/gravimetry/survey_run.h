// A survey: the filter with the states of the integrated gravimetric system, run along prepared data forward and backward to
// obtain the gravity disturbance at the fixes.
#pragma once

#include "schuler/filter/states/model.h"

#include <Eigen/Core>

#include <cstddef>
#include <functional>
#include <vector>

namespace schuler::gravimetry {

/// An estimate after a fix, with other measured quantities of that time.
struct SurveyEpoch {
    Time time;
    NavStateEcef nav;
    Eigen::Vector3d disturbance_n;  ///< gravity minus normal gravity, north, east, down, m/s^2
    Eigen::Vector3d sigma_disturbance_n;
    Eigen::Vector3d sigma_random_n;  ///< of its random part alone, which varies along the track
    Eigen::Vector3d change_n = not_given3(), sigma_change_n = not_given3();    ///< since before the last step, if `keep_before`
    Eigen::Vector3d sigma_attitude_n;                                          ///< rad
    Eigen::Vector3d sigma_velocity_n, sigma_position_n;                        ///< m/s, m
    Eigen::Vector3d accel_bias, gyro_bias, sigma_accel_bias, sigma_gyro_bias;  ///< body axes, m/s^2 and rad/s
    Eigen::Vector3d f_n = Eigen::Vector3d::Zero();  ///< mean specific force since the previous fix, of the forward filter, m/s^2
    double nis = 0.0;                               ///< normalised innovation squared of the fix, of the forward filter
    int measured = 0;                               ///< its degrees of freedom; none if the fix was rejected
    std::size_t fix = 0;                            ///< index into Recording::gnss
};

/// Disturbance of the forward filter, which has used the fixes up to an epoch, minus that of the backward one, which has used the
/// later ones: north, east, down, m/s^2. What both take from their common priors (of the disturbance itself, of the instruments'
/// constant errors) cancels, and does so in the sigma.
struct SurveySeparation {
    Time time;
    Eigen::Vector3d difference_n, sigma_n;
};

struct SurveyResult {
    std::vector<SurveyEpoch> forward;
    std::vector<SurveyEpoch> backward;  ///< before the fixes of the epochs, without f_n, nis and fix; empty if not requested
    std::vector<SurveySeparation> separation;             ///< at the same times
    std::vector<SurveyEpoch> smoothed;                    ///< empty if not requested; otherwise with one entry per forward epoch
    std::vector<filter::MeasurementRecord> measurements;  ///< of the forward filter
    std::vector<filter::LayoutBlock> states;              ///< of the filter, except navigation
    std::vector<filter::ParameterRow> parameters, smoothed_parameters;     ///< of these, as many as forward and smoothed
    std::vector<filter::CovarianceRow> covariances, smoothed_covariances;  ///< likewise, if Settings::covariance_rows requests it
};

/// Settings for gravity estimation derived from those for navigation: the preset gravity27. Loose coupling in Earth-fixed axes
/// with the disturbance as states. Excluded are measurements not accurate to a milligal, or that correct by other means than an optimal
/// update: zero velocity and wheels, magnetometer, odometer, the barometer's bias walk, fixes used in parts, integrity control.
[[nodiscard]] filter::Settings gravity27(filter::Settings settings, const filter::DisturbanceSettings& disturbance);

struct SurveyOptions {
    bool smooth = true;
    bool backward = false;      ///< also a filter backward in time (filter/update/reversed.h)
    std::vector<Time> steps{};  ///< ascending: when the systematic part of the disturbance may have changed by its prior
    std::size_t stretch = 512;  ///< increments replayed at once by the smoother; one filter is kept per segment
    std::function<void(double)> progress{};
};

/// Runs the survey, starting at the first measurement after the start. Settings as returned by gravity27. @throws Error(Input) if
/// no fix lies within the increments, Error(Computation) if the filter diverges.
[[nodiscard]] SurveyResult run_survey(const filter::RunData& data, const filter::Settings& settings, const filter::Start& start,
                                      const SurveyOptions& options);

}  // namespace schuler::gravimetry
