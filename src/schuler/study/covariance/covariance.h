// `schuler analyze covariance`: prediction of a filter's errors without Monte Carlo.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/value.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace schuler::study {

struct CovarianceRequest {
    std::filesystem::path scenario, output;
    settings::SettingList above;  ///< of the command line
    std::optional<std::uint64_t> seed;
    double rate = 5.0;             ///< Hz of the inertial unit, upper limit
    double outage = 0.0;           ///< s; not 0: GNSS is withheld for this time at the end
    std::string find;              ///< a key of the scenario
    std::optional<double> target;  ///< m
    std::string version;
};

/// True covariance with the gains of the filter compared with the covariance stated by the filter, and the contribution of each
/// error source; with `find` the value of a key at which the horizontal error reaches the target. @throws Error
[[nodiscard]] report::Outcome analyze_covariance(const CovarianceRequest& request);

}  // namespace schuler::study
