// Tables of numbers without a header line.
#pragma once

#include "schuler/inspect/detail/loaded_file.h"
#include "schuler/io/text/table.h"

namespace schuler::inspect::detail {

/// The formats of the KF-GINS program and similar ones, by value: sets what the file is and its columns. False if it is none of them.
bool recognise_without_header(LoadedFile& file, const io::TableLayout& layout);

}  // namespace schuler::inspect::detail
