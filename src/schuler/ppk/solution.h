// A carrier-phase solution of one epoch.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/samples.h"
#include "schuler/core/time.h"

#include <Eigen/Core>

#include <cstdint>

namespace schuler::ppk {

/// As RTKLIB numbers them.
enum class Quality : std::uint8_t { None = 0, Fixed = 1, Float = 2, Single = 5 };

struct EpochSolution {
    Time tag, time;               ///< by the rover's clock, and GPS time
    Quality quality = Quality::None;
    Ecef position;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();            ///< m^2, Earth-fixed
    Eigen::Vector3d velocity = not_given3();                         ///< m/s, Earth-fixed; NaN where nothing says it
    Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
    int satellites = 0;           ///< in common with the base, or of the single-point solution
    int ambiguities = 0, fixed = 0;
    double ratio = 0, success = 0;
    double age = 0;               ///< s to the base's epoch
    int rejected = 0;             ///< codes left out, and ambiguities begun anew because their phases did not fit
};

}  // namespace schuler::ppk
