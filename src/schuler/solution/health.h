// The state of every source over time: used, rejected, excluded or silent.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/loaded_dataset.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::solution {

enum class SourceState {
    Used,
    Refused,        ///< by its gate
    Distrusted,     ///< by the integrity monitor, or used after removing a jump of the receiver
    LeftOut,        ///< before the run: no fix, frozen, strayed, height inconsistent with the barometer
    Withheld,       ///< by the user, in an outage
    Hanging,        ///< inertial unit: values that repeat to the last digit
    Silent,         ///< no samples for three times the usual interval, at least one second (inertial unit: a gap)
    PartlyRefused,  ///< alternately used and rejected
    PartlyUsed      ///< alternately used and in another state that is not a rejection
};
[[nodiscard]] std::string_view name_of(SourceState state);

/// A source was in one state from its first sample in it to the last one; a silence lasts from the sample before to the one after it.
struct HealthInterval {
    std::string_view source;  ///< as named in files: "imu", "gnss_position", "baro", ...
    SourceState state = SourceState::Used;
    Time from{}, to{};
    std::size_t samples = 0;  ///< none in a silence
    std::size_t used = 0;     ///< number of those in state Used
};

/// In order of source, the inertial unit first, and time, from the start of the forward solution to its end: a source that
/// appeared later or was lost is silent there. States no longer than a second and two samples (a single rejected fix) are merged
/// with the surrounding one if they are under a tenth of its samples; if there are more, one interval indicates alternating
/// states. Vehicle constraints and ranges are not sources here: constraints have no log, ranges have one per satellite.
[[nodiscard]] std::vector<HealthInterval> health_of(const LoadedDataset& data, const fusion::Result& result);

/// Where the velocities of the receiver were refused for longer than a wrong navigation would have taken to show: it was at fault. None if that is
/// so for more than a fifth of them: such velocities do not describe the change of the positions.
[[nodiscard]] std::vector<HealthInterval> disputes_of(std::span<const HealthInterval> health);

}  // namespace schuler::solution
