// The commands `schuler analyze ...`: theory as a tool. No printing; the interfaces display the returned result.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/theory/equator.h"
#include "schuler/theory/level_dynamics.h"

#include <Eigen/Core>

#include <filesystem>
#include <string>

namespace schuler::study {

/// `analyze equator`: SI units and radians except for the latitude.
struct EquatorRequest {
    double speed = 0.0, height = 0.0, time = 3600.0;
    theory::Vector6 errors = theory::Vector6::Zero();        ///< initial, order of theory::EquatorError
    Eigen::Vector3d misalignment = Eigen::Vector3d::Zero();  ///< rad, about the pole, the start's meridian, east of it
    bool paper = false;
    bool compare = false;
    double latitude_deg = 0.0, north_speed = 0.0, up_speed = 0.0;  ///< for a comparison away from the equator
    bool ellipsoid = false;                                        ///< compare with the paper's e^2 instead of the sphere
    std::filesystem::path output;                                  ///< folder of the comparison's report; empty: out/equator
    std::string version;
};

/// Roots, periods, limits, P(t), errors, verdict; the paper's tables; the comparison with its plot. @throws Error, Input with the
/// option as key.
[[nodiscard]] report::Outcome analyze_equator(const EquatorRequest& request);

/// `analyze schuler`.
struct SchulerRequest {
    double latitude_deg = 50.45, height = 0.0;
    Eigen::Vector3d v_enu = Eigen::Vector3d::Zero();       ///< m/s
    double time = 3600.0;                                  ///< s
    Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< initial errors east, north, up, m
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();    ///< m/s
    Eigen::Vector3d attitude = Eigen::Vector3d::Zero();    ///< about east, north, up, rad
    Eigen::Vector3d gyro_deg_h = Eigen::Vector3d::Zero();  ///< constant errors (measured minus true) east, north, up
    Eigen::Vector3d accel_ug = Eigen::Vector3d::Zero();
    double baro = 0.0;  ///< m
    std::string vertical = "fixed";
    double baro_time = 100.0;  ///< s
    bool paper = false;
    std::filesystem::path output;  ///< folder of a report; empty: none
    std::string version;
};

/// Modes, amplitudes, errors and the vertical channel; paper A's cases. @throws Error as above.
[[nodiscard]] report::Outcome analyze_schuler(const SchulerRequest& request);

}  // namespace schuler::study
