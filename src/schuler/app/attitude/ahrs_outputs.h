// Output files of `schuler ahrs`.
#pragma once

#include "schuler/ahrs/magnetometer_axes.h"
#include "schuler/ahrs/run.h"
#include "schuler/analysis/attitude_errors.h"
#include "schuler/analysis/errors.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/loaded_dataset.h"

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::app {

/// Errors relative to an attitude reference; heading with its constant offset removed, as in BROAD.
struct AhrsEvaluation {
    analysis::BroadErrors broad;
    analysis::Spread roll, pitch, heading;  ///< rad
};

struct AhrsBundle {
    std::string name, version, filter;
    bool offline = false, six_axis = false, field_from_model = false;
    double declination = 0.0;  ///< rad, of the model
    ahrs::MagnetometerAxes axes;
    Eigen::Vector3d magnet_b = Eigen::Vector3d::Zero();  ///< T, taken off the readings before
    double mag_delay = 0.0;                              ///< s, of the magnetometer, taken off its times before
    std::vector<std::string> calibration;                ///< calibrations applied or rejected, with the reason
    std::vector<solution::Ignored> ignored;
    std::size_t imu_epochs = 0;
    solution::LoadedDataset data;
    ahrs::RunResult result;
    AhrsEvaluation evaluation;
    std::string config_toml;
    std::vector<std::string> warnings;
    solution::Timing timing;
};

/// Paper B's filters give magnetic heading: rotates the rows by the model's declination.
void turn_to_true_north(AhrsBundle& bundle);

/// solution.csv, report.html and config.toml, as selected by the settings. summary.json is written last by the caller.
[[nodiscard]] std::vector<std::filesystem::path> write_ahrs_outputs(const AhrsBundle& bundle,
                                                                    const std::filesystem::path& folder);

/// summary.json with the fields of the interface contract; null where not applicable.
[[nodiscard]] std::string ahrs_summary_json(const AhrsBundle& bundle);
[[nodiscard]] std::string ahrs_summary_tables(const AhrsBundle& bundle);

/// report.html.
[[nodiscard]] std::string ahrs_report_html(const AhrsBundle& bundle);

}  // namespace schuler::app
