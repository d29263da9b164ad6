// A survey's filter along its increments, forward or in reversed time, and its estimate at an epoch.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/gravimetry/survey_run.h"

#include <Eigen/Core>

#include <vector>

namespace schuler::gravimetry::detail {

using SurveyFrame = filter::EarthFixedFrame;
using SurveyFilter = filter::InertialFilter<SurveyFrame>;
using SurveyFilterRun = filter::FilterRun<SurveyFrame>;

/// P_n: covariance of position, velocity and attitude, local level.
[[nodiscard]] SurveyEpoch survey_epoch(const filter::InertialModel& model, const SurveyFilter& filter, const filter::Matrix9& P_n,
                                       std::size_t fix);

/// Covariance of the disturbance, north, east, down, with every state.
using DisturbanceRows = Eigen::Matrix<double, 3, Eigen::Dynamic>;
[[nodiscard]] DisturbanceRows disturbance_rows(const filter::InertialModel& model, const SurveyFilter& filter);

/// At the start. Measurements at the start itself are used before the rate of the body is known, so they are not.
[[nodiscard]] SurveyFilterRun begin_survey(const filter::InertialModel& model, const filter::RunData& data,
                                           const filter::Settings& settings, const filter::Start& start);

/// Runs to the end, with checkpoints if required.
std::vector<SurveyFilterRun> run_along(const filter::Pass<SurveyFrame>& pass, const filter::RunData& data,
                                       const filter::Settings& settings, const filter::InertialModel& model, SurveyFilterRun& run,
                                       const SurveyOptions& options, bool keep, filter::PassObserver<SurveyFrame>& observer);

}  // namespace schuler::gravimetry::detail
