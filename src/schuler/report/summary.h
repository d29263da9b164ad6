// The results of a run: summary.json and readable tables.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/bundle.h"

#include <string>
#include <string_view>

namespace schuler::report {

[[nodiscard]] std::string_view integrity_test_name(fusion::IntegrityTest test);

/// summary.json, with the fields of the interface contract; numbers not applicable are null.
[[nodiscard]] std::string summary_json(const solution::ResultBundle& bundle);

/// The same numbers as readable tables.
[[nodiscard]] std::string summary_tables(const solution::ResultBundle& bundle);

}  // namespace schuler::report
