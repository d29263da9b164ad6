// The course of a ship as a sensor of its heading.
#pragma once

#include "schuler/solution/loaded_dataset.h"

namespace schuler::solution {

/// Where a ship has no sensor of the heading, its course over ground takes that place: the bow lies within the leeway angle of it
/// (`vehicle.leeway_deg`), which is the constant error of that sensor. A chord of several seconds between fixes averages over the waves.
/// Does nothing for other vehicles, without leeway, and where the recording has headings.
void use_course(LoadedDataset& data);

}  // namespace schuler::solution
