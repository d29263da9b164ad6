// What is written of carrier-phase positions.
#pragma once

#include "schuler/app/carrier_phase.h"
#include "schuler/core/nav_state.h"

#include <span>
#include <string>

namespace schuler::app {

/// solution.csv of the fixes themselves, with columns `q` (1 fixed, 2 float, 5 single) and `satellites` at the end; `latency`: by which rows
/// are earlier than their fixes, s.
[[nodiscard]] std::string solution_csv_with_quality(std::span<const SolutionRow> rows, const CarrierPhase& solution, double latency);

}  // namespace schuler::app
