// Units from the sizes of the numbers, where names do not state them or state what cannot be.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/inspect/detail/motion.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::inspect::detail {

/// A factor to be written as `scale = { key = factor }`.
struct UnitChange {
    std::string key;      ///< canonical name, without axis for three columns ("accel_m_s2")
    double factor = 1.0;  ///< number in the file to canonical unit
    std::string unit;     ///< what the numbers are
    double confidence = 0.0;
    std::string why;
    bool against_name = false;  ///< the name states another unit
};

/// Judges and rescales the accelerometer columns by the norm (9.8 m/s^2, 1 g, 1000 mg), position and magnetometer columns by
/// what can be on Earth. Contradictions with a stated unit are problems of the file. Rates that are increments by their size are
/// renamed to them (their column map says so).
[[nodiscard]] std::vector<UnitChange> judge_units(LoadedFile& file);

/// Judges the gyros of an IMU whose accelerometers are in order: turning about the vertical against the GNSS course, and the
/// turning of gravity in sensor axes against the integrated rates. Rescales file and series.
[[nodiscard]] std::vector<UnitChange> judge_gyro_unit(LoadedFile& file, ImuSeries& imu, const GnssSeries& gnss);

/// Course rate against the gyros' turning about the vertical: slope near 1 where unit, sign and axes are right.
struct CourseSlope {
    double slope = 0.0;  ///< course rate / gyro rate
    double correlation = 0.0;
    int epochs = 0;
};
[[nodiscard]] CourseSlope course_slope(const ImuSeries& imu, const GnssSeries& gnss, const Eigen::Vector3d& down_s,
                                       const Eigen::Vector3d& gyro_bias);

/// Factor from the rates' unit to rad/s by the course: 1, that of degrees, or its inverse; nothing where the two are not related.
[[nodiscard]] std::optional<double> gyro_unit_of(const CourseSlope& course);

}  // namespace schuler::inspect::detail
