// Logs of several instruments: the form in which containers, or any file with more than one table, are read.
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

/// Origin of the times of a log.
enum class Clock {
    Boot,           ///< the start of the instrument, or unknown
    Gps,            ///< 1980-01-06, without leap seconds
    SecondsOfWeek,  ///< the GPS week
    Unix,           ///< 1970-01-01 UTC
};

/// One instrument: columns with names that state quantity and unit (docs/files.md), as long as the times; NaN if a row has no value.
struct Stream {
    struct Column {
        std::string name;
        std::vector<double> values;
    };

    std::string name;    ///< "imu", "imu1", "gnss", ...: unique within one log
    std::string source;  ///< the message or topic it was formed from
    TableKind kind = TableKind::Imu;
    std::vector<std::int64_t> time_ns;  ///< in the order of the log
    std::vector<Column> columns;
    std::vector<FixType> fix;  ///< of the same length, or empty
    bool own_frame = false;    ///< a trajectory in its own frame, with arbitrary heading and origin
    bool by_arrival = false;   ///< dated by the fixes logged beside it: early by the delay with which the receiver puts these out

    Stream() = default;
    Stream(std::string stream_name, TableKind of_kind, std::string made_of, std::initializer_list<const char*> names);
    /// A row: one value per column.
    void add(std::int64_t ns, std::initializer_list<double> values);
    [[nodiscard]] const Column* find(std::string_view column) const;
    [[nodiscard]] std::size_t rows() const { return time_ns.size(); }
};

/// A log of instruments on one clock.
struct StreamLog {
    std::vector<Stream> streams;
    Clock clock = Clock::Boot;
    std::vector<std::string> contents;  ///< lines for display: version, other content of the log, drop-outs

    [[nodiscard]] const Stream* find(std::string_view name) const;
    /// Adds a stream that has rows, without columns that have no values; a name already in use gets a number.
    void add(Stream stream);
};

/// The column name of such times.
[[nodiscard]] std::string_view time_name(Clock clock);

/// The stream as a table of comma-separated values with a header, accepted by all table readers; numbers with full precision.
[[nodiscard]] std::string table_text(const Stream& stream, Clock clock);

/// Columns of fixes, in degrees, and rows as fixes.
[[nodiscard]] Stream stream_of(const std::vector<GnssFix>& fixes, HeightKind height, std::string source);

/// A path with the name of a stream appended, "log.ulg#imu1"; the name is empty if the path denotes a whole file.
struct StreamPath {
    std::filesystem::path file;
    std::string stream;
};
[[nodiscard]] StreamPath stream_path(const std::filesystem::path& path);

/// The stream of that name in the log of that file. @throws Error(Input) with the names that there are
[[nodiscard]] const Stream& stream_of_log(const StreamLog& log, const StreamPath& where);

/// Opens files and streams of logs as tables. A log is read once, and kept in memory for the lifetime of this object.
class LogFiles {
public:
    /// The file itself, or the table of a stream of it ("log.ulg#imu"). @throws Error(Input) for a stream not in the log, and as its reader
    [[nodiscard]] TextInput open(const std::filesystem::path& path, WarningLog& warnings);

private:
    std::map<std::filesystem::path, StreamLog> logs_;
    std::map<std::filesystem::path, std::string> tables_;
};

}  // namespace schuler::io
