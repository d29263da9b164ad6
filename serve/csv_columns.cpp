#include "serve/csv_columns.h"

#include "schuler/io/text/table.h"

#include <array>

namespace schuler::serve {
namespace {

constexpr std::array groups{CsvGroup{"gravity.csv", "/gravity"}, CsvGroup{"epochs.csv", "/ensemble"},
                            CsvGroup{"solution.csv", "/attitude", true}, CsvGroup{"carrier.csv", "/carrier", false, true}};

/// Units denoted by parts of a name; longer ones first.
// clang-format off
constexpr std::pair<const char*, const char*> unit_marks[] = {{"_deg_h", "deg/h"}, {"_m_s", "m/s"}, {"_mgal", "mGal"},
                                                              {"_deg", "deg"},     {"_ppm", "ppm"}, {"_ug", "ug"},
                                                              {"_mg", "mg"},       {"_m", "m"}};
// clang-format on

std::string unit_of(const std::string& name) {
    for (const auto& [mark, unit] : unit_marks) {
        const std::size_t at = name.find(mark);
        if (at == std::string::npos) continue;
        const std::string rest = name.substr(at + std::string(mark).size());
        if (rest.empty() || rest == "_rms" || rest == "_median" || rest.starts_with("_q")) return unit;
    }
    return "1";
}

}  // namespace

std::span<const CsvGroup> csv_groups() { return groups; }

ColumnTable csv_columns(const std::filesystem::path& file, bool time) {
    const io::TextInput input(file);
    const io::TableLayout layout = io::inspect_table(input);
    ColumnTable out;
    std::vector<io::FieldRequest> fields;
    for (int c = 0; c < layout.columns; ++c) {
        const std::string& name = layout.names.at(static_cast<std::size_t>(c));
        if ((name == "time_s") != time) continue;
        io::FieldRequest field;
        field.column = c;
        field.required = time;
        field.name = name;
        fields.push_back(field);
        out.names.push_back(time ? "time" : name);
        out.units.push_back(time ? "s" : unit_of(name));
    }
    out.columns.resize(fields.size());
    io::TableReader reader(input, layout, fields);
    while (reader.next())
        for (std::size_t c = 0; c < fields.size(); ++c) out.columns[c].push_back(reader.number(c));
    return out;
}

}  // namespace schuler::serve
