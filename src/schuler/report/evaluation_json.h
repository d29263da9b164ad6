// JSON of `schuler evaluate`.
#pragma once

#include "schuler/solution/evaluate.h"

#include <string>

namespace schuler::report {

/// The errors and consistency of one trajectory against another, with the fields of summary.json.
[[nodiscard]] std::string evaluation_json(const solution::Evaluation& evaluation, const std::string& solution,
                                          const std::string& reference);

/// Likewise for people.
[[nodiscard]] std::string evaluation_tables(const solution::Evaluation& evaluation);

}  // namespace schuler::report
