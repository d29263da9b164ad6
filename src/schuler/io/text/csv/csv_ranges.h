// ranges.csv and stations.csv of the interface contract: pseudoranges to satellites and ground stations, station positions.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/io/text/csv/csv_recording.h"

#include <string>
#include <vector>

namespace schuler::io {

/// A station and its surveyed position (ellipsoidal height).
struct StationRow {
    std::string id;
    Geodetic position;
};

struct RangesTable {
    RangingLog log;
    ColumnPlan plan;
    RowCounts rows;
};

/// Reads ranges.csv. Rows out of order are sorted; of duplicates of a source at one time the first is used; rows with an invalid
/// pseudorange (outside 0 to 1e9 m) are skipped; all is reported in the log. @throws Error(Input) as the other readers.
[[nodiscard]] RangesTable read_ranges_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);

/// Reads stations.csv. @throws Error(Input): a missing column, a duplicate id, a position not on the Earth.
[[nodiscard]] std::vector<StationRow> read_stations_csv(const TextInput& input, const CsvOptions& options, WarningLog& log);

/// ranges.csv, lengths to 1e-6 m.
[[nodiscard]] std::string ranges_csv(const RangingLog& log);
[[nodiscard]] std::string stations_csv(const std::vector<StationRow>& stations);

}  // namespace schuler::io
