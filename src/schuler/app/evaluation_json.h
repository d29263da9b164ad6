// JSON of `schuler evaluate`.
#pragma once

#include "schuler/app/evaluate.h"

#include <string>

namespace schuler::app {

/// The errors and consistency of one trajectory against another, with the fields of summary.json.
[[nodiscard]] std::string evaluation_json(const Evaluation& evaluation, const std::string& solution,
                                          const std::string& reference);

/// Likewise for people.
[[nodiscard]] std::string evaluation_tables(const Evaluation& evaluation);

}  // namespace schuler::app
