// Origin of each setting of a run, as readable text.
#pragma once

#include "schuler/core/fact.h"

#include <string>
#include <vector>

namespace schuler::report {

/// "0.12 +- 0.02 s", "\"frd\"": the value of a fact for display.
[[nodiscard]] std::string fact_text(const Fact& fact);

/// The relevant facts that are given, stated or found, one line each; `notes` adds the evidence.
[[nodiscard]] std::string facts_table(const std::vector<Fact>& facts, bool notes);

}  // namespace schuler::report
