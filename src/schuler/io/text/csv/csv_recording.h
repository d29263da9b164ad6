// The CSV files of the interface contract: logs of one instrument each to samples in SI, as logged (sensor axes, the file's own
// time axis), in time order.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/columns.h"
#include "schuler/io/text/text_input.h"

#include <Eigen/Core>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace schuler::io {

/// Statements of a data set about one of its files.
struct CsvOptions {
    std::map<std::string, std::string> columns;    ///< canonical name = the file's name, or "#3" for the third column
    std::map<std::string, double> scale;           ///< factor to the canonical unit (see ColumnOverrides)
    std::optional<TimeUnit> time_unit;             ///< of the time column, if not stated by its name
    std::map<std::string, std::string> fix_codes;  ///< code = none, autonomous, differential, rtk_fixed, rtk_float
    std::string quaternion;  ///< "sensor_to_enu" | "body_to_ned"; empty: according to the column name, else body_to_ned
    Eigen::Matrix3d C_sb = Eigen::Matrix3d::Identity();  ///< body to sensor axes, for sensor_to_enu
    Duration time_offset;                                ///< added to every time (start of the week, leap seconds)
};

/// Statistics of the rows of a file.
struct RowCounts {
    std::size_t read = 0;  ///< data rows in the file
    std::size_t used = 0;
    std::size_t bad = 0;           ///< a required value is missing or not a number: skipped
    std::size_t without_fix = 0;   ///< GNSS rows that state or show that there is no fix: skipped
    std::size_t strays = 0;        ///< stamped far from the surrounding rows: skipped
    std::size_t out_of_order = 0;  ///< earlier than a previous row: sorted
    std::size_t duplicates = 0;    ///< same time and values as another row: dropped
    std::size_t same_time = 0;     ///< same time, other values: kept
};

struct ImuTable {
    std::vector<ImuSample> samples;
    ImuKind kind = ImuKind::Rates;  ///< according to the columns found (gyro/accel or dtheta/dv)
    ColumnPlan plan;
    RowCounts rows;
};

struct GnssTable {
    std::vector<GnssFix> fixes;  ///< height as logged: see `height`
    HeightKind height = HeightKind::Unstated;
    std::string fix_table;  ///< interpretation of the fix codes; empty without a fix column
    ColumnPlan plan;
    RowCounts rows;
};

struct BaroTable {
    std::vector<BaroSample> samples;
    HeightKind height = HeightKind::Unstated;
    ColumnPlan plan;
    RowCounts rows;
};

struct MagTable {
    std::vector<MagSample> samples;  ///< field_b in sensor axes
    ColumnPlan plan;
    RowCounts rows;
};

struct ReferenceTable {
    std::vector<ReferenceSample> samples;
    HeightKind height = HeightKind::Unstated;
    bool autopilot = false;  ///< the columns are named as onboard or AHRS estimates
    std::string quaternion;  ///< the convention used, empty without quaternion columns
    ColumnPlan plan;
    RowCounts rows;
};

/// The readers. Rows with a required value missing or absurd (|gyro| > 1e4 rad/s, |accel| > 1000 g, |latitude| > 90 deg, ...),
/// stamped far from the surrounding rows, or with an unknown fix code, are skipped and counted; times that restart with the week
/// or the day are continued; rows out of order are sorted (stable) and counted; exact duplicates are dropped; all is reported in
/// the log, once per kind. Throw Error(Input) with file, line, column and hint: a required column is missing; the first row has
/// no number, or over 5 % of the rows are bad; over 10 % of the rows go back in time; no usable row; the last line is truncated.
[[nodiscard]] ImuTable read_imu_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);
[[nodiscard]] GnssTable read_gnss_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);
[[nodiscard]] BaroTable read_baro_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);
[[nodiscard]] MagTable read_mag_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);
[[nodiscard]] ReferenceTable read_reference_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);

}  // namespace schuler::io
