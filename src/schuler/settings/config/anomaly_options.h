// [[anomaly]] of scenarios (simulated) and data sets (injected): the same notation for both.
#pragma once

#include "schuler/settings/option_table.h"
#include "schuler/sim/anomaly.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::settings {

/// Entries of [[anomaly]]. @throws Error(Input) without a place.
[[nodiscard]] std::vector<sim::AnomalyPart> anomalies_from(const ValueList& tables);
/// The inverse; empty if there are none.
[[nodiscard]] std::optional<Value> value_of(const std::vector<sim::AnomalyPart>& parts);
[[nodiscard]] OptionSpec anomaly_spec(const std::string& help);

}  // namespace schuler::settings
