// Messages of an autopilot log as logged, one table per message and instance, before their interpretation.
#pragma once

#include "schuler/io/streams.h"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

struct RawTable {
    std::string name;  ///< of the message: "sensor_combined", "IMU"
    int instance = 0;
    std::vector<std::string> fields;
    std::vector<std::vector<double>> values;  ///< one column per field, all of equal length

    [[nodiscard]] const std::vector<double>* find(std::string_view field) const;
    /// The first of several names that exists.
    [[nodiscard]] const std::vector<double>* find(std::initializer_list<std::string_view> names) const;
    [[nodiscard]] std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
};

using RawTables = std::vector<RawTable>;

/// Tables of that message, in order of instance.
[[nodiscard]] std::vector<const RawTable*> tables_named(const RawTables& tables, std::string_view name);

/// Values of another table at the times of this one, interpolated linearly between its rows; NaN more than `reach` beyond a row.
[[nodiscard]] std::vector<double> interpolated(const std::vector<double>& at, const std::vector<double>& times,
                                               const std::vector<double>& values, double reach);

/// Interprets PX4 topics by their names; `timestamp` is in microseconds.
[[nodiscard]] StreamLog px4_streams(const RawTables& tables);
/// The topics read by px4_streams().
[[nodiscard]] bool is_px4_topic(std::string_view name);

/// Interprets ArduPilot messages by their names; `TimeUS` is in microseconds, `TimeMS` in milliseconds.
[[nodiscard]] StreamLog ardupilot_streams(const RawTables& tables);
[[nodiscard]] bool is_ardupilot_message(std::string_view name);

}  // namespace schuler::io
