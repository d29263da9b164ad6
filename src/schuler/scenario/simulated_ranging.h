// Raw ranges of a scenario.
#pragma once

#include "schuler/core/time.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/sim/ranging.h"

#include <optional>

namespace schuler::scenario {

/// Ranges of a scenario with the ephemerides used to generate them; empty if it has none.
struct SimulatedRanging {
    sim::SimulatedRanges ranges;
    gnss::Navigation navigation;
    Time gps;  ///< GPS time of the scenario's first instant
};
[[nodiscard]] std::optional<SimulatedRanging> simulate_ranging(const settings::ScenarioConfig& scenario);

}  // namespace schuler::scenario
