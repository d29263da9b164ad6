// What kind of file this is, by its content.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/text/table.h"

namespace schuler::inspect::detail {

/// Sets kind, table, plan and columns of a file whose path is given, and reads its rows. @throws Error for unreadable content
void recognise_and_read(LoadedFile& file);

/// Reads the rows of a table whose plan is known into the file; problems of rows are reported, not thrown.
void read_table(LoadedFile& file, const io::TableLayout& layout);

/// Reads a log of kind rtklib_pos or nmea through its reader of room io.
void read_receiver_solution(LoadedFile& file);

/// Says what raw measurements or ephemerides hold; times are those of the epochs. False where the file is better read as NMEA.
[[nodiscard]] bool read_raw(LoadedFile& file, io::RawFormat format);

/// Likewise for precise orbits (SP3).
void read_precise_orbits(LoadedFile& file);
/// Extended squitters of 1090 MHz: how many, and which senders stay where they are.
void read_squitters(LoadedFile& file);

/// Times of the rows are judged by their steps: a unit other than the one assumed by name or size, where the rate were absurd.
void judge_time_unit(LoadedFile& file, const io::TableLayout& layout);

}  // namespace schuler::inspect::detail
