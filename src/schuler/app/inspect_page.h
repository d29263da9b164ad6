// The result of `inspect` as a page: time bars of all streams, the track, tables.
#pragma once

#include "schuler/inspect/inspect.h"
#include "schuler/report/report.h"

#include <string>

namespace schuler::app {

[[nodiscard]] report::ReportInput inspect_page(const inspect::InspectReport& found, const std::string& version);

}  // namespace schuler::app
