// Units from the magnitude of the numbers, if names do not state them or state an impossible one.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/inspect/detail/motion/motion.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::inspect::detail {

/// A factor to be written as `scale = { key = factor }`.
struct UnitChange {
    std::string key;      ///< canonical name, without axis for three columns ("accel_m_s2")
    double factor = 1.0;  ///< number in the file to canonical unit
    std::string unit;     ///< actual unit of the numbers
    double confidence = 0.0;
    std::string why;
    bool against_name = false;  ///< the name states a different unit
};

/// Checks and rescales the accelerometer columns by their norm (9.8 m/s^2, 1 g, 1000 mg), position and magnetometer columns by
/// the range possible on Earth. Contradictions with a stated unit are problems of the file. Rates that are increments by their
/// magnitude are renamed accordingly (recorded in their column map).
[[nodiscard]] std::vector<UnitChange> judge_units(LoadedFile& file);

/// The lengths and speeds of a table of u-blox navigation solutions (NAV-PVT) as its names and whole numbers show; after the position,
/// whose unit is in `changes`.
void judge_receiver_integers(LoadedFile& file, std::vector<UnitChange>& changes);

/// Checks the gyros of an IMU with valid accelerometers: rotation about the vertical compared with the GNSS course, and the
/// rotation of gravity in sensor axes compared with the integrated rates. Rescales file and series.
[[nodiscard]] std::vector<UnitChange> judge_gyro_unit(LoadedFile& file, ImuSeries& imu, const GnssSeries& gnss);

/// Course rate compared with the gyros' rotation about the vertical: slope near 1 if unit, sign and axes are correct.
struct CourseSlope {
    double slope = 0.0;  ///< course rate / gyro rate
    double correlation = 0.0;
    int epochs = 0;
};
[[nodiscard]] CourseSlope course_slope(const ImuSeries& imu, const GnssSeries& gnss, const Eigen::Vector3d& down_s,
                                       const Eigen::Vector3d& gyro_bias);

struct GyroUnit {
    double factor = 1.0;  ///< to rad/s
    bool sure = false;    ///< the slope lies within 30 % of it
};
/// The unit of the rates from the course: the nearest of rad/s, deg/s, mdeg/s and deg/s converted once too often; empty if the two
/// are not related.
[[nodiscard]] std::optional<GyroUnit> gyro_unit_of(const CourseSlope& course);

}  // namespace schuler::inspect::detail
