// The columns of a log before anything is processed, for drawing.
#pragma once

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>

namespace schuler::serve {

struct RawRequest {
    std::filesystem::path file;   ///< also of one instrument of a log: log.ulg#imu
    double from = 0.0, to = 0.0;  ///< s after the first row; equal: all
    std::size_t points = 3000;    ///< approximate number of rows; 0: every row, up to `most_raw_values` numbers
};

/// More are decimated even if every row is requested: a child of the server holds all of them as text.
inline constexpr std::size_t most_raw_values = 2'000'000;

/// {rows: in the range, thinned, zero: time of the first row, time: its name, time_s, columns: {name: []}, units: {name: unit}}; the
/// minimum and maximum of every column in each interval are kept. A unit is empty if neither the name nor a line of units states it.
/// @throws Error(Input)
[[nodiscard]] nlohmann::ordered_json raw_columns(const RawRequest& request);

}  // namespace schuler::serve
