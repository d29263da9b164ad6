// A carrier-phase solution of one epoch.
#pragma once

#include "schuler/core/position.h"
#include "schuler/core/samples.h"
#include "schuler/core/time.h"
#include "schuler/gnss/satellite.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace schuler::ppk {

/// Numbered as in RTKLIB.
enum class Quality : std::uint8_t { None = 0, Fixed = 1, Float = 2, Single = 5 };

/// One carrier of one satellite in an epoch, Settings::views. Residuals are differences rover minus base, measured minus modelled
/// at the epoch's position, minus the median of their system and carrier.
struct SignalView {
    gnss::SatelliteId satellite;
    char band = '1';
    double elevation = 0;                                    ///< rad
    double code = not_given, phase = not_given;              ///< m, residuals
    double code_sigma = not_given, phase_sigma = not_given;  ///< m, of a single difference
    bool code_used = false;
    bool whole = false;               ///< its ambiguity is among the fixed integers of the epoch
    int rover_arc = 0, base_arc = 0;  ///< a change of number means that the phase slipped or was lost
};

struct EpochSolution {
    Time tag, time;  ///< by the rover's clock, and GPS time
    Quality quality = Quality::None;
    Ecef position;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< m^2, Earth-fixed
    Eigen::Vector3d velocity = not_given3();               ///< m/s, Earth-fixed; NaN if undetermined
    Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
    int satellites = 0;  ///< common with the base, or of the single-point solution
    int ambiguities = 0, fixed = 0;
    double ratio = 0, success = 0;
    double age = 0;                          ///< s to the base's epoch
    double code_scale = 1, phase_scale = 1;  ///< on the assumed variances, as far as the log shows
    double vertical_ionosphere = 0,
           vertical_weight = 0;       ///< m on L1 by which the measurements were corrected, and its weight, 1/m^2
    int rejected = 0;                 ///< excluded codes, and ambiguities reset because their phases did not fit
    std::vector<SignalView> signals;  ///< empty unless Settings::views
};

}  // namespace schuler::ppk
