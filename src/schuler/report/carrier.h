// Output of carrier-phase positions.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/dataset/carrier_phase.h"

#include <span>
#include <string>

namespace schuler::report {

/// carrier.csv: quality, satellites, integers and baseline of every epoch.
[[nodiscard]] std::string carrier_csv(const dataset::CarrierPhase& solution);

/// RTKLIB numbers: 1 fixed, 2 float, 5 single.
[[nodiscard]] int quality_number(ppk::Quality quality);

/// solution.csv of the fixes themselves, with columns `q` (1 fixed, 2 float, 5 single) and `satellites` at the end; `latency`:
/// time by which rows precede their fixes, s.
[[nodiscard]] std::string solution_csv_with_quality(std::span<const SolutionRow> rows, const dataset::CarrierPhase& solution,
                                                    double latency);

}  // namespace schuler::report
