// The command `schuler analyze observability`.
#pragma once

#include "schuler/report/outcome.h"

namespace schuler::study {

/// A steady motion and how ranks are decided; angles in degrees, as at the command line.
struct ObservabilityRequest {
    double latitude_deg = 55.8114694, longitude_deg = 37.4998612, height = 164.15;  ///< paper E's start
    double vn = 0.0, ve = 0.0, vd = 0.0;                                            ///< m/s
    double heading_deg = 45.0, turn_deg_s = 0.0;
    double correlation_time = 0.0;  ///< of the random part of the disturbance, s; 0: constant
    int polynomial = 0;             ///< degree along the track of the other part
    double tolerance = 0.0;         ///< smallest pivot that counts; 0: exact
    bool frozen = false;
    bool rhumb = false;  ///< constant heading and velocity against north instead of a great circle
    bool paper = false;  ///< the motions of paper E beside each other
};

/// Rank, pivots, and the combinations that are seen. @throws Error(Input) with the option as key.
[[nodiscard]] report::Outcome analyze_observability(const ObservabilityRequest& request);

}  // namespace schuler::study
