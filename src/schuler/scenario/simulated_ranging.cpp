#include "schuler/scenario/simulated_ranging.h"

#include "schuler/settings/scenario/sections.h"

#include <utility>

namespace schuler::scenario {

std::optional<SimulatedRanging> simulate_ranging(const settings::ScenarioConfig& s) {
    if (!(s.ranging.rate > 0.0)) return std::nullopt;
    SimulatedRanging out;
    sim::RangingSettings r = settings::ranging_settings(s);
    const auto path = sim::make_path(s.sim.path, s.sim.earth.ellipsoid);
    const sim::RangingScenario frame = settings::ranging_frame(s);
    out.gps = frame.gps;
    out.ranges = sim::simulate_ranges(frame, *path, r);
    out.navigation = std::move(r.navigation);
    return out;
}

}  // namespace schuler::scenario
