// Origin of each setting of a run, with the values in force; and the settings that repeat the run.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"

#include <string>
#include <vector>

namespace schuler::solution {

/// Replaces settings to be estimated by the values found in the run, so that the settings repeat it.
void take_in_force(settings::Config& config, const fusion::Findings& findings);

/// All settings in force, as TOML that repeats the run.
[[nodiscard]] std::string config_in_force(const LoadedDataset& data);

/// The settings that describe the data, in the order of dataset.toml, each with its value in force.
[[nodiscard]] std::vector<Fact> facts_of(const ResultBundle& bundle);

/// True if it is not a default, nor a given value equal to the default.
[[nodiscard]] bool is_news(const Fact& fact);

}  // namespace schuler::solution
