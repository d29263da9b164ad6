// JSON of `schuler evaluate`.
#pragma once

#include "schuler/solution/evaluate.h"

#include <string>

namespace schuler::report {

/// The errors and consistency of one trajectory relative to another, with the fields of summary.json.
[[nodiscard]] std::string evaluation_json(const solution::Evaluation& evaluation, const std::string& solution,
                                          const std::string& reference);

/// The same as readable text.
[[nodiscard]] std::string evaluation_tables(const solution::Evaluation& evaluation);

}  // namespace schuler::report
