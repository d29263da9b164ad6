// The survey's filter backward in time, and its separation from the forward one.
#pragma once

#include "schuler/gravimetry/detail/survey_pass.h"

namespace schuler::gravimetry::detail {

/// Fills `backward` and `separation` of a result. `rows`: of its forward epochs. The backward filter starts at the last one with ten
/// times its sigmas of position, velocity and attitude, and otherwise like the forward one.
/// @throws Error(Computation) if it diverges.
void run_backward(const filter::RunData& data, const filter::Settings& settings, const filter::Start& start,
                  const SurveyOptions& options, const std::vector<DisturbanceRows>& rows, SurveyResult& result);

}  // namespace schuler::gravimetry::detail
