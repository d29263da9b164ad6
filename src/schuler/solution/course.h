// The course of a ship as a sensor of its heading.
#pragma once

#include "schuler/solution/loaded_dataset.h"

namespace schuler::solution {

/// If a ship has no heading sensor, its course over ground replaces it: the bow lies within the leeway angle of the course
/// (`vehicle.leeway_deg`, and what half a metre per second of current adds at the median speed), the slowly varying error of that sensor.
/// A chord of several seconds between fixes averages over the waves; its course is valid in its middle, so that it uses a fix some seconds
/// later. No effect for other vehicles, without leeway, or if the recording has headings.
void use_course(LoadedDataset& data);

}  // namespace schuler::solution
