// `schuler gnss`: a receiver's satellites, epoch by epoch.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

namespace schuler::app {

struct SatellitesRequest {
    settings::ProcessRequest common;
    double missed_detection = 1e-3;
};

/// Writes gnss.csv, satellites.csv, residuals.csv, report.html and summary.json, with a base carrier.csv too. @throws Error
[[nodiscard]] report::Outcome gnss_dataset(const SatellitesRequest& request);

}  // namespace schuler::app
