// Error models of satellite receivers' own solutions by name.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/sensor/gnss_errors.h"

#include <Eigen/Core>

#include <string_view>
#include <vector>

namespace schuler::sensor {

/// Errors of the fixes of a receiver under an open sky, north, east, down, one sigma, SI units: white noise, and slowly varying errors.
struct GnssReceiver {
    Eigen::Vector3d white_position = Eigen::Vector3d::Zero();  ///< m
    Eigen::Vector3d white_velocity = Eigen::Vector3d::Zero();  ///< m/s
    GnssErrorModel errors;
    FixType fix = FixType::Autonomous;
    double rate = 0.0;  ///< Hz, of a receiver with one rate of its own; 0: a setting
};

/// The model of a kind of receiver ("autonomous", "rtk") or of a product ("duostar1000", ...). Case, '-' and '_' are ignored.
/// @throws Error(Input) that lists the known names.
[[nodiscard]] GnssReceiver gnss_receiver(std::string_view name);

/// The known names.
[[nodiscard]] std::vector<std::string_view> gnss_receiver_names();

}  // namespace schuler::sensor
