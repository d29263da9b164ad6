// Recognition of the kind of a file from its content.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/inspect/given.h"
#include "schuler/io/formats.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/text/table.h"

namespace schuler::inspect::detail {

/// Sets kind, table, plan and columns of a file whose path is given, and reads its rows. @throws Error for unreadable content
void recognise_and_read(LoadedFile& file);

/// Reads the rows of a table with a known plan into the file; problems of rows are reported, not thrown.
void read_table(LoadedFile& file, const io::TableLayout& layout);

/// True for the table of an IMU or of fixes that is named for a companion log whose columns it has too: it may still take its own role.
[[nodiscard]] bool is_table_of_another(const std::filesystem::path& path, io::TableKind named);

/// How a file was recognised and its columns interpreted, one line each.
[[nodiscard]] std::vector<std::string> explained_columns(const LoadedFile& file);

/// Takes over the columns of a stream.
void take_stream(LoadedFile& file, const io::Stream& stream, io::Clock clock);
/// Reads a file that is a single log of its format: RTKLIB .pos, NMEA.
void read_one_stream(LoadedFile& file, const io::Format& format);
/// All streams of a log, named "FILE#STREAM"; the log itself with its error if it cannot be read. Never throws on content.
[[nodiscard]] std::vector<LoadedFile> load_streams(const std::filesystem::path& path, const std::string& name,
                                                   const io::Format& format);
/// A stream with a given role; without a role if it does not exist.
[[nodiscard]] LoadedFile load_given_stream(const std::filesystem::path& path, const std::string& name, const ReadAs& as);

/// Fixes computed from raw measurements, as a log.
[[nodiscard]] LoadedFile load_computed(const ComputedFixes& computed);

/// Describes the content of raw measurements or ephemerides; times are those of the epochs. False if the file is rather NMEA.
[[nodiscard]] bool read_raw(LoadedFile& file, io::RawFormat format);

/// The same for precise orbits (SP3).
void read_precise_orbits(LoadedFile& file);
/// The same for calibrations of antennas (ANTEX).
void read_antennas(LoadedFile& file);
/// Extended squitters of 1090 MHz: their number, and the stationary senders.
void read_squitters(LoadedFile& file);

/// Checks the time unit by the intervals: selects another unit than that from name or magnitude if the rate would be absurd.
void judge_time_unit(LoadedFile& file, const io::TableLayout& layout);

}  // namespace schuler::inspect::detail
