// The files of a data set, except those of ranges, read into a recording.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/carrier_phase.h"
#include "schuler/dataset/description.h"
#include "schuler/io/text/csv/csv_recording.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace schuler::dataset {

/// Reading options in addition to the description.
struct Reading {
    bool imu = true;                                     ///< false: an IMU log is not required
    bool ranges = false;                                 ///< relative to a base, if there is one
    Eigen::Matrix3d C_bs = Eigen::Matrix3d::Identity();  ///< sensor axes of the IMU to body axes, including the mounting
    std::optional<Eigen::Matrix3d> C_imu_mag;            ///< axes of the magnetometer to those of the IMU, if different
    std::string gauges, log, compass;                    ///< files of survey instruments; empty: none
    std::set<std::string> found;  ///< sections whose file nobody named: one that cannot be read is left out
};

/// The content of the files and the facts stated in them.
struct ReadFiles {
    Recording recording;
    CarrierPhase carrier;             ///< its fixes are those of the recording, if there is a base
    std::optional<ImuKind> imu_kind;  ///< empty without an IMU log
    io::HeightKind fix_height = io::HeightKind::Unstated;
    std::vector<std::string> left_out;  ///< sections of found measurements that cannot be read
};

/// Relative paths are based on `folder`. Times are those of the files, shifted by their offsets; dated fixes are converted to the
/// axis of the other logs. @throws Error(Input) with file, line, column or key.
[[nodiscard]] ReadFiles read_files(const std::filesystem::path& folder, const Description& description, const Reading& reading,
                                   WarningLog& warnings);

/// Converts pressures to heights of the standard atmosphere, if the log has no heights.
void settle_pressures(std::vector<BaroSample>& samples, double sea_level_pressure);

}  // namespace schuler::dataset
