// A data set loaded into a recording, with its settings settled: what a run starts from.
#pragma once

#include "schuler/core/aid_samples.h"
#include "schuler/core/fact.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/carrier_phase.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"

#include <set>
#include <vector>

namespace schuler::solution {

/// A recording with what loading has found about its settings.
struct LoadedDataset {
    Recording recording;               ///< times on the data set's own axis
    dataset::CarrierPhase carrier;     ///< whose fixes are those of the recording, where there is a base
    std::vector<NamedInstant> events;  ///< in order of time: those of filter.output_instants
    settings::Config config;
    Time origin;                  ///< zero of the command line's times: first GNSS epoch, else first IMU epoch
    std::set<std::string> given;  ///< keys of the settings that a user or a scenario gave
    std::vector<Fact> facts;      ///< what the files state or show
    fusion::HeightKind logged_height = fusion::HeightKind::Ellipsoidal;  ///< before an undulation was added
    bool true_reference = false;                                         ///< the reference is simulated truth
    double read_seconds = 0.0;
};

/// Reads the files that the settings name and settles what depends on them (heights, start, stop, outages).
/// @throws Error(Input) with file, line, column or key.
[[nodiscard]] LoadedDataset load_dataset(const settings::Dataset& dataset, const settings::Config& config, WarningLog& warnings);

/// Settles times and axes of a recording that is in memory; `given`: keys of the settings that somebody gave.
[[nodiscard]] LoadedDataset settled_dataset(Recording recording, const settings::Config& config, WarningLog& warnings,
                                            std::set<std::string> given = {});

}  // namespace schuler::solution
