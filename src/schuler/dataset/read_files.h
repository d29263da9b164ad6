// The files of a data set, but those of ranges, read into a recording.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/carrier_phase.h"
#include "schuler/dataset/description.h"
#include "schuler/io/text/csv_recording.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace schuler::dataset {

/// What reading asks for beside the description.
struct Reading {
    bool imu = true;                                     ///< false: it may do without an IMU log
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< sensor axes of the IMU to body axes, mounting included
    std::optional<Eigen::Matrix3d> C_imu_mag;            ///< axes of the magnetometer to those of the IMU, where they differ
    std::string gauges, log, compass;                    ///< files of instruments of a survey; empty: none
};

/// What the files hold, and what they state of it.
struct ReadFiles {
    Recording recording;
    CarrierPhase carrier;             ///< whose fixes are those of the recording, where there is a base
    std::optional<ImuKind> imu_kind;  ///< nothing without an IMU log
    io::HeightKind fix_height = io::HeightKind::Unstated;
};

/// Relative paths start at `folder`. Times are those of the files, moved by their offsets; dated fixes are put on the axis of the other logs.
/// @throws Error(Input) with file, line, column or key.
[[nodiscard]] ReadFiles read_files(const std::filesystem::path& folder, const Description& description, const Reading& reading,
                                   WarningLog& warnings);

/// Pressures as heights of the standard atmosphere, where the log has no heights.
void settle_pressures(std::vector<BaroSample>& samples, double sea_level_pressure);

}  // namespace schuler::dataset
