// Attitude and heading from a data set: the command `schuler ahrs`, in parts that a benchmark may call separately.
#pragma once

#include "schuler/ahrs/magnetometer_axes.h"
#include "schuler/ahrs/run.h"
#include "schuler/analysis/attitude_errors.h"
#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"
#include "schuler/solution/loaded_dataset.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::app {

struct AhrsRequest {
    settings::ProcessRequest common;
    std::string filter = "mekf";  ///< one of attitude_filters()
    bool six_axis = false;
    bool offline = false;
    bool calibrate =
        false;  ///< calibrate magnetometer and accelerometer by an ellipsoid fit to this log, if held-out parts of it confirm the fit
};

/// The filters by the names of --filter.
[[nodiscard]] const std::vector<std::pair<std::string, ahrs::FilterKind>>& attitude_filters();

/// Recordings and settings as input of the attitude filters: body axes, rates, the field if position and date are known.
struct AhrsInput {
    std::vector<ImuSample> imu;
    std::vector<MagSample> mag;
    std::vector<ahrs::SpeedSample> speed;
    ahrs::RunSettings settings;
    bool field_from_model = false;
    ahrs::MagnetometerAxes axes;                         ///< already applied to `mag`
    Eigen::Vector3d magnet_b = Eigen::Vector3d::Zero();  ///< T, constant field of the sensor, already taken off `mag`
    double mag_delay = 0.0;                              ///< s, found and already taken off the times of `mag`
    std::vector<std::string> calibration;                ///< calibrations applied or rejected, with the reason
};

/// @throws Error(Input) for incompatible options.
[[nodiscard]] AhrsInput ahrs_input(const solution::LoadedDataset& data, const AhrsRequest& request, WarningLog& warnings);

/// Rescales the gyro's rates if they are in degrees, or were converted twice, by what accelerometer and magnetometer show of the same
/// rotation; only a warning where that is not clear.
void settle_gyro_unit(AhrsInput& input, WarningLog& warnings);

/// Problems visible in the samples themselves: too low a sampling rate, wrong units, magnetometer axes that differ from the
/// IMU's, a magnetometer missing for long. @throws Error(Input) if no attitude can be computed.
void check_ahrs_input(const AhrsInput& input, WarningLog& warnings);

/// Estimate and reference at the reference epochs with movement, if the reference has an attitude and the estimate is within half
/// a sample in time (it is then interpolated to the reference's time from its neighbours).
[[nodiscard]] std::vector<analysis::AttitudePair> attitude_pairs(const std::vector<ahrs::AttitudeRow>& rows,
                                                                 const std::vector<ReferenceSample>& reference);

/// Reads, filters, evaluates, writes solution.csv, summary.json and report.html. @throws Error
[[nodiscard]] report::Outcome ahrs_dataset(const AhrsRequest& request);

}  // namespace schuler::app
