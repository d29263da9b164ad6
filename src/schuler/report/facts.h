// How each setting of a run is known, for people.
#pragma once

#include "schuler/core/fact.h"

#include <string>
#include <vector>

namespace schuler::report {

/// "0.12 +- 0.02 s", "\"frd\"": the value of a fact for people.
[[nodiscard]] std::string fact_text(const Fact& fact);

/// The facts that are given, stated or found and are news, a line each; `notes` adds the evidence.
[[nodiscard]] std::string facts_table(const std::vector<Fact>& facts, bool notes);

}  // namespace schuler::report
