// `schuler gnss`: satellites of a receiver by epoch.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

namespace schuler::app {

struct SatellitesRequest {
    settings::ProcessRequest common;
    double missed_detection = 1e-3;
};

/// Writes gnss.csv, satellites.csv, residuals.csv, report.html and summary.json, and with a base also carrier.csv. @throws Error
[[nodiscard]] report::Outcome gnss_dataset(const SatellitesRequest& request);

}  // namespace schuler::app
