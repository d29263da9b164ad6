// states.csv: estimate and sigma of every state of the filter that is not part of solution.csv.
#pragma once

#include "schuler/filter/result.h"

#include <span>
#include <string>

namespace schuler::report {

/// One row per row of `rows` (at most 1 Hz): time_s, then each component of each block after position, velocity and attitude, as
/// NAME_UNIT and std_NAME_UNIT in SI units; components of a block with several are numbered from 1: gyro_bias_1_rad_s.
[[nodiscard]] std::string states_csv(std::span<const filter::LayoutBlock> states, std::span<const filter::ParameterRow> rows);

}  // namespace schuler::report
