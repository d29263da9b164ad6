// Evidence of a run for and against its solution.
#pragma once

#include "schuler/solution/bundle.h"

#include <vector>

namespace schuler::solution {

/// The warnings of a run and the findings of its result, evaluation and self-check, each under a topic of verdict.cpp.
[[nodiscard]] std::vector<Concern> evidence_of(const ResultBundle& bundle, const WarningLog& warnings);

}  // namespace schuler::solution
