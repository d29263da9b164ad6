// Reports on a receiver's satellites: tables, JSON, text and a page.
#pragma once

#include "schuler/dataset/satellite_views.h"
#include "schuler/report/report.h"

#include <array>
#include <string>
#include <vector>

namespace schuler::report {

struct SatelliteReportInput {
    std::string name, version;
    const dataset::SatelliteViews* views = nullptr;
    double false_alarm = 1e-4, missed_detection = 1e-3;
    std::vector<std::string> warnings{};
};

/// One satellite over all epochs. Unknown values are NaN.
struct SatelliteSummary {
    gnss::SatelliteId satellite;
    std::size_t seen = 0;
    std::array<std::size_t, gnss::fate_count> fates{};  ///< epochs, by gnss::Fate
    double cn0 = not_given;                             ///< dB-Hz, median
    double mean = not_given, rms = not_given;           ///< m, of the residuals of used ranges
    double normalised = not_given;                      ///< RMS of residual over sigma
    double rate_rms = not_given;                        ///< m/s
    std::size_t slips = 0;                              ///< of all carriers, relative to a base
};
/// In order of systems and numbers.
[[nodiscard]] std::vector<SatelliteSummary> satellites_of(const dataset::SatelliteViews& views);

/// Carriers that slipped or were restarted, at each epoch of the carrier-phase solution: their arc differs from the previous one.
[[nodiscard]] std::vector<std::vector<bool>> slips_of(const dataset::CarrierPhase& carrier);

/// gnss.csv: one row per epoch: solution, sigma, satellites, dilution, protection levels; with a base, carrier-phase position.
[[nodiscard]] std::string gnss_csv(const dataset::SatelliteViews& views);
/// satellites.csv: one row per satellite and epoch: direction, C/N0, used or the reason if not.
[[nodiscard]] std::string satellites_csv(const dataset::SatelliteViews& views);
/// residuals.csv: one row per measurement, measured minus modelled, with its sigma.
[[nodiscard]] std::string residuals_csv(const dataset::SatelliteViews& views);

[[nodiscard]] std::string satellite_json(const SatelliteReportInput& input);
[[nodiscard]] std::string satellite_text(const SatelliteReportInput& input);
/// The table of satellites for a page.
[[nodiscard]] TableBlock satellite_table(const dataset::SatelliteViews& views);
[[nodiscard]] ReportInput satellite_page(const SatelliteReportInput& input);

}  // namespace schuler::report
