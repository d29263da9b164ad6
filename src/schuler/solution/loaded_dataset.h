// A data set loaded into a recording, with final settings: the input of a run.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/core/instrument_logs.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/carrier_phase.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"

#include <set>
#include <vector>

namespace schuler::solution {

/// A recording with the findings of loading about its settings.
struct LoadedDataset {
    Recording recording;               ///< times on the data set's own axis
    dataset::CarrierPhase carrier;     ///< its fixes are those of the recording, if there is a base
    std::vector<NamedInstant> events;  ///< in time order: those of filter.output_instants
    settings::Config config;
    Time origin;                  ///< zero of the command line's times: first GNSS epoch, else first IMU epoch
    std::set<std::string> given;  ///< keys of the settings given by a user or a scenario
    std::vector<Fact> facts;      ///< stated or shown by the files
    fusion::HeightKind logged_height = fusion::HeightKind::Ellipsoidal;  ///< before an undulation was added
    bool true_reference = false;                                         ///< the reference is simulated truth
    double read_seconds = 0.0;
};

/// Reads the files named by the settings and completes the dependent settings (heights, start, stop, outages).
/// @throws Error(Input) with file, line, column or key.
[[nodiscard]] LoadedDataset load_dataset(const settings::Dataset& dataset, const settings::Config& config, WarningLog& warnings);

/// Determines times and axes of a recording in memory; `given`: keys of the given settings.
[[nodiscard]] LoadedDataset settled_dataset(Recording recording, const settings::Config& config, WarningLog& warnings,
                                            std::set<std::string> given = {});

}  // namespace schuler::solution
