// The numbers of a run: summary.json and tables for people.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/bundle.h"

#include <string>
#include <string_view>

namespace schuler::report {

[[nodiscard]] std::string_view integrity_test_name(fusion::IntegrityTest test);

/// summary.json, with the fields of the interface contract; numbers that do not apply are null.
[[nodiscard]] std::string summary_json(const solution::ResultBundle& bundle);

/// The same numbers as tables for people.
[[nodiscard]] std::string summary_tables(const solution::ResultBundle& bundle);

}  // namespace schuler::report
