// The state of every source over time: when it was used, refused, left out, or silent.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/loaded_dataset.h"

#include <string>
#include <string_view>
#include <vector>

namespace schuler::solution {

enum class SourceState {
    Used,
    Refused,        ///< by its gate
    Distrusted,     ///< by the integrity monitor, or used less a jump of the receiver
    LeftOut,        ///< before the run: no fix, frozen, strayed, another height than the barometer's
    Withheld,       ///< by the user, in an outage
    Hanging,        ///< inertial unit: values that repeat to the last digit
    Silent,         ///< no samples for three times the usual step, one second at least (inertial unit: a gap)
    PartlyRefused,  ///< used and refused to and fro
    PartlyUsed      ///< to and fro between being used and another state that is no refusal
};
[[nodiscard]] std::string_view name_of(SourceState state);

/// A source was in one state from its first sample in it to the last one; a silence lasts from the sample before to the one after it.
struct HealthInterval {
    std::string_view source;  ///< as files call it: "imu", "gnss_position", "baro", ...
    SourceState state = SourceState::Used;
    Time from{}, to{};
    std::size_t samples = 0;  ///< none of a silence
    std::size_t used = 0;     ///< of them, in state Used
};

/// In order of source, the inertial unit first, and time, from the begin of the forward solution to its end: a source that came later or
/// was lost is silent there. States that last for no more than a second and two samples (a single refused fix) are counted with the one around
/// them where they are under a tenth of the samples there; where there are more, one interval tells that the state changes to and fro.
/// Vehicle constraints and ranges are no sources here: constraints have no log, ranges one a satellite.
[[nodiscard]] std::vector<HealthInterval> health_of(const LoadedDataset& data, const fusion::Result& result);

}  // namespace schuler::solution
