// What kind of file this is, by its content.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/io/formats.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/text/table.h"

namespace schuler::inspect::detail {

/// Sets kind, table, plan and columns of a file whose path is given, and reads its rows. @throws Error for unreadable content
void recognise_and_read(LoadedFile& file);

/// Reads the rows of a table whose plan is known into the file; problems of rows are reported, not thrown.
void read_table(LoadedFile& file, const io::TableLayout& layout);

/// How a file was recognised and what its columns were taken for, a line each.
[[nodiscard]] std::vector<std::string> explained_columns(const LoadedFile& file);

/// Takes the columns of a stream.
void take_stream(LoadedFile& file, const io::Stream& stream, io::Clock clock);
/// Reads a file that is one log of its own format: RTKLIB .pos, NMEA.
void read_one_stream(LoadedFile& file, const io::Format& format);
/// Every stream of a log of several, named "FILE#STREAM"; the log itself with what is wrong with it where it cannot be read. Never throws on content.
[[nodiscard]] std::vector<LoadedFile> load_streams(const std::filesystem::path& path, const std::string& name,
                                                   const io::Format& format);
/// A stream whose role is given; without a role where it is not there.
[[nodiscard]] LoadedFile load_given_stream(const std::filesystem::path& path, const std::string& name, const ReadAs& as);

/// Says what raw measurements or ephemerides hold; times are those of the epochs. False where the file is better read as NMEA.
[[nodiscard]] bool read_raw(LoadedFile& file, io::RawFormat format);

/// Likewise for precise orbits (SP3).
void read_precise_orbits(LoadedFile& file);
/// Extended squitters of 1090 MHz: how many, and which senders stay where they are.
void read_squitters(LoadedFile& file);

/// Times of the rows are judged by their steps: a unit other than the one assumed by name or size, where the rate were absurd.
void judge_time_unit(LoadedFile& file, const io::TableLayout& layout);

}  // namespace schuler::inspect::detail
