// Meaning of the columns of a log: canonical names, synonyms, units stated in names, and the user's own map.
#pragma once

#include "schuler/io/text/number.h"
#include "schuler/io/text/table.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

enum class TableKind { Imu, Gnss, Baro, Mag, Reference, Ranges, Stations };
[[nodiscard]] std::string_view name_of(TableKind kind);  ///< "imu", "gnss", ...: the section of dataset.toml

/// How the meaning of a column was determined.
enum class Certainty {
    Given,    ///< by the user's map
    Exact,    ///< canonical name
    Synonym,  ///< another customary name of the quantity, with its unit
    Guess,    ///< a short or ambiguous name, or no unit in the name
};
[[nodiscard]] std::string_view name_of(Certainty certainty);

/// Reference of a height.
enum class HeightKind { Unstated, Ellipsoidal, Msl, Relative, Autopilot };
[[nodiscard]] std::string_view name_of(HeightKind kind);

/// A column of the file recognised as a canonical quantity: canonical value = number * factor + offset.
struct ColumnMatch {
    std::string canonical;  ///< for example gyro_x_rad_s
    std::string file_name;  ///< as spelt in the file
    int column = -1;        ///< 0-based
    double factor = 1.0;    ///< to the unit in the canonical name
    double offset = 0.0;
    bool unit_stated = false;  ///< by the name, the line of units, or the user
    Certainty certainty = Certainty::Guess;
    TimeUnit time_unit = TimeUnit::Seconds;    ///< of time columns
    HeightKind height = HeightKind::Unstated;  ///< of height columns
    int companion = -1;  ///< column of the hemisphere (angles) or of the fraction of a second or the date (times)
    TimeUnit companion_unit = TimeUnit::Nanoseconds;  ///< of that fraction
    bool companion_date = false;                      ///< the companion of a time of day is its date
    bool degrees_minutes = false;                     ///< of angles: 4806.3456 is 48 deg 6.3456 min, as NMEA writes it
};

/// The request that reads a matched column.
[[nodiscard]] FieldRequest request_of(const ColumnMatch& match);

/// The user's map: canonical name = the file's name (or "#3" for the third column), and factors to the canonical unit.
/// A factor's key is a canonical name, or one without its axis (`gyro_rad_s`, `accel_m_s2`, `mag_ut`) for all three.
struct ColumnOverrides {
    std::map<std::string, std::string> columns;
    std::map<std::string, double> scale;
    std::optional<TimeUnit> time_unit;
};

struct ColumnPlan {
    TableKind kind = TableKind::Imu;
    std::vector<ColumnMatch> matches;  ///< at most one per canonical name
    std::vector<std::string> unused;   ///< names of columns not recognised
    [[nodiscard]] const ColumnMatch* find(std::string_view canonical) const;
};

/// Finds the columns of a kind of table. Throws Error(Input): an override names an unknown canonical name or a column not in the
/// file (the nearest known name is suggested).
[[nodiscard]] ColumnPlan match_columns(const TableLayout& layout, TableKind kind, const ColumnOverrides& overrides = {});

/// The kind of table suggested by the names: the one with all required columns present. nullopt if none is complete.
[[nodiscard]] std::optional<TableKind> guess_table_kind(const TableLayout& layout);

/// True for columns named as the estimate of a filter, or truth: not those of a receiver.
[[nodiscard]] bool is_estimate(std::string_view name);

/// The canonical names of a kind of table, in the order of the documentation, including the optional ones.
[[nodiscard]] std::vector<std::string> canonical_names(TableKind kind);

/// The known name nearest to a misspelt one (edit distance), or empty if none is near.
[[nodiscard]] std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// A unit from its name: factor and offset to the canonical unit of a dimension.
struct UnitFactor {
    double factor;
    double offset = 0.0;
};

/// Lower-case words of a column name: "IMU::UncompAccel::X [m/s^2]" -> imu uncomp accel x m s2.
[[nodiscard]] std::vector<std::string> words_of_name(std::string_view name);

}  // namespace schuler::io
