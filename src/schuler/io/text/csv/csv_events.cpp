#include "schuler/io/text/csv/csv_events.h"

#include "schuler/io/atomic_file.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_field.h"
#include "schuler/io/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace schuler::io {

std::vector<NamedInstant> read_events_csv(const TextInput& input) {
    const TableLayout layout = inspect_table(input);
    const auto column = [&](const char* name) {
        const auto found = std::ranges::find(layout.names, name);
        return found == layout.names.end() ? -1 : static_cast<int>(found - layout.names.begin());
    };
    if (column("time_s") < 0)
        throw input_error("needs a column time_s", {layout.file, layout.header_line, 0, "time_s"},
                          "write the header time_s,name");
    // Every line below the header is an event: a unit is one, or a time that cannot be read.
    if (!layout.units.empty()) {
        constexpr std::array<std::string_view, 6> units{"s", "[s]", "(s)", "sec", "second", "seconds"};
        const std::string& unit = layout.units[static_cast<std::size_t>(column("time_s"))];
        if (std::ranges::find(units, unit) == units.end())
            throw input_error(fmt::format("\"{}\" is not a time", unit), {layout.file, layout.header_line + 1, 0, "time_s"},
                              "give seconds on the time axis of the data set, or leave the row out");
    }
    std::vector<FieldRequest> fields{{.column = column("time_s"), .kind = FieldKind::Time, .name = "time_s"}};
    const bool named = column("name") >= 0;
    if (named) fields.push_back({.column = column("name"), .kind = FieldKind::Text, .required = false, .name = "name"});
    TableReader reader(input, layout, fields);
    std::vector<NamedInstant> out;
    while (reader.next()) {
        if (!reader.row_ok()) throw reader.row_error("give seconds on the time axis of the data set, or leave the row out");
        out.push_back({Time{reader.time_ns(0)}, named ? unquoted(reader.text(1), '"') : std::string(), reader.line()});
    }
    if (out.empty())
        throw input_error("has no event", {layout.file, 0, 0, "time_s"}, "give a row an event, or leave out output.events");
    return out;
}

void write_events_csv(const std::filesystem::path& file, std::span<const NamedInstant> events,
                      std::span<const SolutionRow> rows) {
    std::string text = std::string(solution_csv_header()) + ",name\n";
    for (std::size_t i = 0; i < events.size(); ++i) text += solution_csv_row(rows[i]) + "," + csv_field(events[i].name) + "\n";
    write_file(file, text);
}

}  // namespace schuler::io
