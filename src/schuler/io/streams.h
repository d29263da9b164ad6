// Logs of several instruments: what a container, or any file that holds more than one table, is read into.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/io/text/columns.h"
#include "schuler/io/text/text_input.h"

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace schuler::io {

/// What the times of a log count from.
enum class Clock {
    Boot,           ///< the start of the instrument, or nothing known
    Gps,            ///< 1980-01-06, without leap seconds
    SecondsOfWeek,  ///< the GPS week
    Unix,           ///< 1970-01-01 UTC
};

/// One instrument: columns with a name each that states quantity and unit (docs/files.md), as long as the times; NaN where a row has no value.
struct Stream {
    struct Column {
        std::string name;
        std::vector<double> values;
    };

    std::string name;    ///< "imu", "imu1", "gnss", ...: of one log each once
    std::string source;  ///< the message or topic that it was made of
    TableKind kind = TableKind::Imu;
    std::vector<std::int64_t> time_ns;  ///< in the order of the log
    std::vector<Column> columns;
    std::vector<FixType> fix;  ///< as long, or empty
    bool own_frame = false;    ///< a trajectory in a frame of its own, whose heading and origin mean nothing elsewhere

    Stream() = default;
    Stream(std::string stream_name, TableKind of_kind, std::string made_of, std::initializer_list<const char*> names);
    /// A row: one value a column.
    void add(std::int64_t ns, std::initializer_list<double> values);
    [[nodiscard]] const Column* find(std::string_view column) const;
    [[nodiscard]] std::size_t rows() const { return time_ns.size(); }
};

/// A log of instruments on one clock.
struct StreamLog {
    std::vector<Stream> streams;
    Clock clock = Clock::Boot;
    std::vector<std::string> contents;  ///< lines for people: version, what else is in the log, drop-outs

    [[nodiscard]] const Stream* find(std::string_view name) const;
    /// Adds a stream that has rows, without the columns that have no value; a name that is taken gets a number.
    void add(Stream stream);
};

/// The name of a column of such times.
[[nodiscard]] std::string_view time_name(Clock clock);

/// The stream as a table of comma-separated values with a header, which every reader of such tables takes; numbers to their last bit.
[[nodiscard]] std::string table_text(const Stream& stream, Clock clock);

/// Columns of fixes, in degrees, and rows as fixes.
[[nodiscard]] Stream stream_of(const std::vector<GnssFix>& fixes, HeightKind height, std::string source);

/// A path with the name of a stream behind it, "log.ulg#imu1"; the name is empty where the path names a file as it is.
struct StreamPath {
    std::filesystem::path file;
    std::string stream;
};
[[nodiscard]] StreamPath stream_path(const std::filesystem::path& path);

/// Opens files and streams of logs as tables. A log is read once, and stays in memory as long as this.
class LogFiles {
public:
    /// The file itself, or the table of a stream of it ("log.ulg#imu"). @throws Error(Input) for a stream that the log has not, and as its reader
    [[nodiscard]] TextInput open(const std::filesystem::path& path, WarningLog& warnings);

private:
    std::map<std::filesystem::path, StreamLog> logs_;
    std::map<std::filesystem::path, std::string> tables_;
};

}  // namespace schuler::io
