// Steps shared by process, run and montecarlo: layers of settings, simulation, fusion, evaluation. No files are written.
#pragma once

#include "schuler/fusion/run_filter.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/loaded_dataset.h"

#include <functional>

namespace schuler::solution {

/// A simulated data set with the settings `over` its own; ready for processing. `flown`: see sim::simulate.
[[nodiscard]] ResultBundle simulated_bundle(const settings::ScenarioConfig& scenario, const settings::SettingList& over,
                                            WarningLog& warnings, const settings::ScenarioConfig* assumed = nullptr,
                                            const sim::ExactFlight* flown = nullptr);

/// Output rate (Hz) of the filter for the evaluation, 0 = every IMU epoch, independent of the rate written later.
[[nodiscard]] double internal_rate(const LoadedDataset& data);

/// Fills result, evaluation and the computing time of the filter. `rows`: see fusion::run_filter. @throws Error
void fuse_and_evaluate(ResultBundle& bundle, WarningLog& warnings, double output_rate,
                       const std::function<void(double)>& progress, const fusion::RowSink& rows = {});

}  // namespace schuler::solution
