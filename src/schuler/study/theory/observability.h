// The command `schuler analyze observability`.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/value.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace schuler::study {

/// A scenario, or for gravimetry a steady motion and the criterion for ranks; angles in degrees, as on the command line.
struct ObservabilityRequest {
    std::filesystem::path scenario;  ///< empty: gravimetry
    settings::SettingList above;     ///< of the command line
    std::optional<std::uint64_t> seed;
    double rate = 5.0;                                                              ///< Hz of the inertial unit, upper limit
    double latitude_deg = 55.8114694, longitude_deg = 37.4998612, height = 164.15;  ///< paper E's start
    double vn = 0.0, ve = 0.0, vd = 0.0;                                            ///< m/s
    double heading_deg = 45.0, turn_deg_s = 0.0;
    double correlation_time = 0.0;  ///< of the random part of the disturbance, s; 0: constant
    int polynomial = 0;             ///< degree along the track of the other part
    double tolerance = 0.0;         ///< smallest significant pivot; 0: exact
    bool frozen = false;
    bool rhumb = false;  ///< constant heading and velocity relative to north instead of a great circle
    bool paper = false;  ///< compare the motions of paper E
};

/// Of the states of gravimetry: rank, pivots, and the observable combinations. @throws Error(Input) with the option as key.
[[nodiscard]] report::Outcome analyze_observability(const ObservabilityRequest& request);

}  // namespace schuler::study
