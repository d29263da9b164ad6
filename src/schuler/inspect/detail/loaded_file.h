// A file recognised by its content and read without a dataset.toml.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/inspect/detail/cadence.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/text/columns.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace schuler::inspect::detail {

/// How a file is to be read according to the user.
struct ReadAs {
    std::optional<io::TableKind> kind;  ///< its role; otherwise determined from its content
    io::ColumnOverrides overrides;
    std::map<std::string, std::string> fix_codes;
    double time_offset = 0.0;  ///< s, added to its times
};

/// A table of numbers as logged: canonical columns in canonical units according to their names (units not yet checked by value).
struct LoadedFile {
    FileReport report;
    std::filesystem::path path;
    ReadAs as;
    std::optional<io::TableKind> table;  ///< its possible role in a data set
    io::ColumnPlan plan;
    std::map<std::string, std::string> column_map;       ///< to be written into dataset.toml (files without header)
    std::vector<std::int64_t> time_ns;                   ///< in the order of the file
    std::map<std::string, std::vector<double>> columns;  ///< by canonical name, NaN if missing; same length as time_ns
    std::vector<FixType> fix;                            ///< same length, or empty
    std::vector<std::string> parts;                      ///< names of the files whose rows follow those of this one
    std::string fix_table;                               ///< interpretation of the fix quality codes
    bool fix_by_evidence = false;                        ///< ... determined from the codes present
    std::map<std::string, FixType> fix_codes;            ///< the codes present
    std::optional<io::TimeUnit> time_unit_judged;        ///< if the intervals indicate a unit other than that of the name
    bool beside_imu = false;  ///< fixes or magnetometer of the IMU's own table: one of their own is preferred
    bool computed = false;    ///< no file: fixes from raw measurements, for the analysis only
    bool gps_time = false;    ///< times are GPS time since 1980 (RTKLIB, NMEA): certain
    bool by_arrival = false;  ///< io::Stream::by_arrival
    std::optional<int> week;  ///< of GPS, of the first row, by a column of its own: `week_column`
    std::string week_column;
    Cadence cadence;  ///< times in s after `cadence_origin_ns`
    std::int64_t cadence_origin_ns = 0;

    [[nodiscard]] bool has(const std::string& canonical) const { return columns.contains(canonical); }
    /// The values of a column; throws std::out_of_range if absent (use has()).
    [[nodiscard]] const std::vector<double>& operator[](const std::string& canonical) const { return columns.at(canonical); }
    /// Three columns of one row as a vector; NaN if absent.
    [[nodiscard]] Eigen::Vector3d vector(const std::string& x, const std::string& y, const std::string& z, std::size_t row) const;
    void problem(Level level, std::string text, std::string hint = {});
    void add_to_times(double seconds);
};

/// Rate, gaps and span of the rows; again when some were added.
void take_cadence(LoadedFile& file);
/// Derived properties of the rows of a file: stray stamps, timing, missing values.
void finish(LoadedFile& file);

/// Recognises and reads one file. Never throws on unusual content.
[[nodiscard]] LoadedFile load_file(const std::filesystem::path& path, const std::string& name, const ReadAs& as = {});

}  // namespace schuler::inspect::detail
