// What is reported of a receiver's satellites: tables, JSON, text and a page.
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

/// One satellite over all epochs. What is not known is NaN.
struct SatelliteSummary {
    gnss::SatelliteId satellite;
    std::size_t seen = 0;
    std::array<std::size_t, gnss::fate_count> fates{};  ///< epochs, by gnss::Fate
    double cn0 = not_given;                             ///< dB-Hz, median
    double mean = not_given, rms = not_given;           ///< m, of the residuals of used ranges
    double normalised = not_given;                      ///< RMS of residual over sigma
    double rate_rms = not_given;                        ///< m/s
    std::size_t slips = 0;                              ///< of all carriers, against a base
};
/// In the order of systems and numbers.
[[nodiscard]] std::vector<SatelliteSummary> satellites_of(const dataset::SatelliteViews& views);

/// Which carriers slipped or were restarted, for each epoch of the carrier-phase solution: its arc differs from the one before.
[[nodiscard]] std::vector<std::vector<bool>> slips_of(const dataset::CarrierPhase& carrier);

/// gnss.csv: an epoch a row: solution, sigma, satellites, dilution, protection levels; with a base, its carrier-phase position too.
[[nodiscard]] std::string gnss_csv(const dataset::SatelliteViews& views);
/// satellites.csv: a satellite at an epoch a row: direction, C/N0, used or why not.
[[nodiscard]] std::string satellites_csv(const dataset::SatelliteViews& views);
/// residuals.csv: a measurement a row, measured minus modelled, with its sigma.
[[nodiscard]] std::string residuals_csv(const dataset::SatelliteViews& views);

[[nodiscard]] std::string satellite_json(const SatelliteReportInput& input);
[[nodiscard]] std::string satellite_text(const SatelliteReportInput& input);
/// The table of satellites for a page.
[[nodiscard]] TableBlock satellite_table(const dataset::SatelliteViews& views);
[[nodiscard]] ReportInput satellite_page(const SatelliteReportInput& input);

}  // namespace schuler::report
