// The steps that process, run and montecarlo share: settings in layers, simulation, fusion, evaluation. Nothing is written.
#pragma once

#include "schuler/fusion/run_filter.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/loaded_dataset.h"

#include <functional>

namespace schuler::solution {

/// A simulated data set with the settings `over` those it describes itself by; ready to be fused.
[[nodiscard]] ResultBundle simulated_bundle(const settings::ScenarioConfig& scenario, const settings::SettingList& over,
                                            WarningLog& warnings, const settings::ScenarioConfig* assumed = nullptr);

/// Rate (Hz) at which the filter reports for the evaluation, 0 = every IMU epoch, whatever is written afterwards.
[[nodiscard]] double internal_rate(const LoadedDataset& data);

/// Fills result, evaluation and the time of the filter. `rows`: see fusion::run_filter. @throws Error
void fuse_and_evaluate(ResultBundle& bundle, WarningLog& warnings, double output_rate,
                       const std::function<void(double)>& progress, const fusion::RowSink& rows = {});

}  // namespace schuler::solution
