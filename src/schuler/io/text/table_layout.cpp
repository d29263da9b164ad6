#include "schuler/io/text/table.h"

#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/detail/comment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace schuler::io {
namespace {

constexpr std::size_t sample_lines = 50;

struct Line {
    long number;
    std::string text;
};

/// The first lines of a table, with comments separated.
struct FirstLines {
    std::vector<Line> comments, rows;
};

/// A wider table is not a log, and processing it would take too long.
void check_width(const SourcePlace& place, std::string_view line) {
    constexpr std::ptrdiff_t most_columns = 4096;
    for (const char delimiter : {',', ';', '\t', '|', ' '})
        if (std::count(line.begin(), line.end(), delimiter) >= most_columns)
            throw input_error(fmt::format("a line of more than {} columns", most_columns), place,
                              "is it a log, with a row for each time?");
}

FirstLines first_lines(const LineBlocks& blocks, const std::string& name) {
    FirstLines result;
    long number = blocks.first_line();
    for (const char* p = blocks.begin(); p < blocks.end() && result.rows.size() < sample_lines + 2; ++number) {
        const char* stop = std::find(p, blocks.end(), '\n');
        std::string_view line(p, static_cast<std::size_t>(stop - p));
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        p = stop + 1;
        if (detail::is_comment(trimmed(line))) {
            if (result.comments.size() < sample_lines) result.comments.push_back({number, std::string(trimmed(line))});
        } else if (!trimmed(line).empty()) {
            check_width(place_in(name, number), line);
            result.rows.push_back({number, std::string(line)});
        }
    }
    return result;
}

bool is_number(const std::string& field, bool decimal_comma) {
    std::string text = field;
    if (decimal_comma) std::replace(text.begin(), text.end(), ',', '.');
    return !std::isnan(number_from(text)) || detail::calendar_nanoseconds(trimmed(field)).has_value();
}

bool looks_numeric(const std::string& field, bool decimal_comma) {
    return is_missing_value(field) || is_number(field, decimal_comma);
}

/// Fraction of the fields in these lines that are numbers when split at a delimiter.
double numeric_share(const std::vector<Line>& rows, std::size_t first, char delimiter) {
    std::size_t numeric = 0, total = 0;
    for (std::size_t i = first; i < rows.size(); ++i) {
        for (const std::string& field : split_fields(rows[i].text, delimiter)) {
            numeric += looks_numeric(field, delimiter == ';' || delimiter == '\t') ? 1 : 0;
            ++total;
        }
    }
    return total == 0 ? 0.0 : static_cast<double>(numeric) / static_cast<double>(total);
}

/// The delimiter for which most fields are numbers; of equals the one with more fields.
char find_delimiter(const std::vector<Line>& rows) {
    const std::size_t first = rows.size() > 1 ? 1 : 0;             // the first line may be a header
    const std::size_t typical = std::max(first, rows.size() / 2);  // and some more a preamble
    char best = ',';
    double best_share = -1.0;
    std::size_t best_count = 0;
    for (const char candidate : {';', ',', '\t', '|', ' '}) {
        const std::size_t count = split_fields(rows[typical].text, candidate).size();
        const double share = count > 1 ? numeric_share(rows, first, candidate) : -0.5;
        if (share > best_share + 1e-9 || (share > best_share - 1e-9 && count > best_count)) {
            best = candidate;
            best_share = share;
            best_count = count;
        }
    }
    return best;
}

int usual_count(const std::vector<std::vector<std::string>>& rows) {
    std::vector<int> counts;
    for (const auto& row : rows) counts.push_back(static_cast<int>(row.size()));
    int best = 0;
    std::ptrdiff_t best_votes = 0;
    for (const int count : counts) {
        const std::ptrdiff_t votes = std::count(counts.begin(), counts.end(), count);
        if (votes > best_votes || (votes == best_votes && count > best)) {
            best = count;
            best_votes = votes;
        }
    }
    return best;
}

struct FieldCensus {
    std::size_t text = 0, numeric = 0;
};

FieldCensus census(const std::vector<std::string>& fields) {
    FieldCensus c;
    for (const std::string& field : fields) {
        if (is_number(field, true)) ++c.numeric;
        else if (!is_missing_value(field)) ++c.text;
    }
    return c;
}

bool is_header(const std::vector<std::string>& fields, const std::vector<std::string>* below) {
    const FieldCensus c = census(fields);
    if (c.text == 0) return false;
    if (c.numeric == 0) return true;
    const bool first_is_name = !looks_numeric(fields.front(), true);
    return first_is_name && 2 * c.numeric <= fields.size() && below != nullptr && is_number(below->front(), true);
}

/// A header in the comment above the data, as written by numpy.
std::optional<std::vector<std::string>> header_in_comment(const std::string& comment, char delimiter, int columns) {
    const std::size_t start = comment.find_first_not_of("#%/ \t");
    if (start == std::string::npos) return std::nullopt;
    const std::string text = comment.substr(start);
    for (const char d : {delimiter, ',', '\t', ' '}) {
        std::vector<std::string> names = split_fields(text, d);
        if (static_cast<int>(names.size()) == columns && columns > 1 && census(names).numeric == 0) return names;
    }
    return std::nullopt;
}

void drop_trailing_empty(std::vector<std::string>& names) {
    while (!names.empty() && names.back().empty()) names.pop_back();
}

/// Lines of text above the header that are no columns (the logger's version, the time of the start): the header is then the first
/// line with as many names as most lines have fields. They count as comments.
void set_preamble_aside(FirstLines& first, char delimiter) {
    std::vector<std::vector<std::string>> fields;
    for (const Line& row : first.rows) fields.push_back(split_fields(row.text, delimiter));
    const int usual = usual_count(fields);
    constexpr std::size_t fewest_rows = 2, longest = 30;
    const auto has_usual = [&](std::size_t i) { return static_cast<int>(fields[i].size()) == usual; };
    std::size_t header = 0;
    while (header < fields.size() && header < longest && !has_usual(header)) ++header;
    if (header == 0 || header + fewest_rows > fields.size() || usual < 2 || header == longest) return;
    const FieldCensus names = census(fields[header]);
    if (names.numeric > 0 || names.text != fields[header].size() || census(fields[header + 1]).numeric == 0) return;
    first.comments.insert(first.comments.end(), first.rows.begin(), first.rows.begin() + static_cast<std::ptrdiff_t>(header));
    first.rows.erase(first.rows.begin(), first.rows.begin() + static_cast<std::ptrdiff_t>(header));
}

/// Header and line of units; returns the index of the first data line among the rows.
std::size_t read_header(const FirstLines& first, TableLayout& layout) {
    const auto fields_of = [&](std::size_t i) { return split_fields(first.rows[i].text, layout.delimiter); };
    const std::vector<std::string> top = fields_of(0);
    const std::vector<std::string> below = first.rows.size() > 1 ? fields_of(1) : std::vector<std::string>{};
    if (!is_header(top, below.empty() ? nullptr : &below)) {
        const long line = first.rows[0].number;
        if (!first.comments.empty()) {
            const auto above =
                std::find_if(first.comments.rbegin(), first.comments.rend(), [&](const Line& c) { return c.number < line; });
            if (above != first.comments.rend() && above->number == line - 1) {
                if (auto names = header_in_comment(above->text, layout.delimiter, static_cast<int>(top.size()))) {
                    layout.names = std::move(*names);
                    layout.header_line = above->number;
                }
            }
        }
        return 0;
    }
    layout.names = top;
    drop_trailing_empty(layout.names);
    layout.header_line = first.rows[0].number;
    if (below.empty()) return 1;
    const FieldCensus c = census(below);
    if (c.numeric > 0 || c.text == 0 || below.size() < layout.names.size()) return 1;
    const bool dates =
        std::any_of(below.begin(), below.end(), [](const std::string& f) { return f.find(':') != std::string::npos; });
    if (dates) return 1;
    if (below != top) layout.units = below;
    return 2;
}

bool has_decimal_comma(const TableLayout& layout) {
    if (layout.delimiter == ',') return false;
    std::size_t commas = 0, points = 0;
    for (const auto& row : layout.sample) {
        for (const std::string& field : row) {
            if (field.find(',') != std::string::npos && is_number(field, true)) ++commas;
            if (field.find('.') != std::string::npos && is_number(field, false)) ++points;
        }
    }
    return commas > points;
}

}  // namespace

std::string unquoted(std::string_view text, char quote) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        out += text[i];
        if (text[i] == quote && i + 1 < text.size() && text[i + 1] == quote) ++i;
    }
    return out;
}

std::vector<std::string> split_fields(std::string_view line, char delimiter) {
    std::vector<std::string> fields;
    const auto is_blank = [&](char c) { return c == ' ' || c == '\r' || (c == '\t' && delimiter != '\t'); };
    std::size_t p = 0;
    bool after_delimiter = false;
    for (;;) {
        while (p < line.size() && is_blank(line[p])) ++p;
        if (p >= line.size()) {
            if (after_delimiter) fields.emplace_back();
            return fields;
        }
        std::string field;
        if (line[p] == '"' || line[p] == '\'') {
            std::size_t close = line.find(line[p], p + 1);
            while (close < line.size() - 1 && line[close + 1] == line[p]) close = line.find(line[p], close + 2);
            const std::size_t stop = close == std::string_view::npos ? line.size() : close;
            field = unquoted(trimmed(line.substr(p + 1, stop - p - 1)), line[p]);
            p = std::min(line.size(), stop + 1);
        }
        const std::size_t start = p;
        while (p < line.size() && (delimiter == ' ' ? !is_blank(line[p]) : line[p] != delimiter)) ++p;
        field += trimmed(line.substr(start, p - start));
        fields.push_back(std::move(field));
        after_delimiter = delimiter != ' ' && p < line.size();
        if (after_delimiter) ++p;
    }
}

TableLayout inspect_table(const TextInput& input) {
    LineBlocks blocks(input);
    TableLayout layout;
    layout.file = input.name();
    layout.size_bytes = blocks.size_on_disk();
    layout.compressed = blocks.compressed();
    if (!blocks.next())
        throw input_error("is empty", place_in(input.name()), "check that the log was written and copied completely");
    FirstLines first = first_lines(blocks, input.name());
    if (first.rows.empty())
        throw input_error("has no data, only blank lines or comments", place_in(input.name()), "check that it is the right file");

    layout.delimiter = find_delimiter(first.rows);
    set_preamble_aside(first, layout.delimiter);
    for (const Line& c : first.comments) layout.comments.push_back(c.text);
    const std::size_t data = read_header(first, layout);
    double bytes = 0.0;
    for (std::size_t i = data; i < first.rows.size() && layout.sample.size() < sample_lines; ++i) {
        layout.sample.push_back(split_fields(first.rows[i].text, layout.delimiter));
        bytes += static_cast<double>(first.rows[i].text.size() + 1);
    }
    if (data < first.rows.size()) layout.first_data_line = first.rows[data].number;
    layout.data_columns = usual_count(layout.sample);
    layout.columns = layout.names.empty() ? layout.data_columns : static_cast<int>(layout.names.size());
    layout.decimal_comma = has_decimal_comma(layout);
    if (!layout.sample.empty() && !layout.compressed) {
        layout.estimated_rows = static_cast<std::size_t>(1.01 * static_cast<double>(layout.size_bytes) /
                                                         (bytes / static_cast<double>(layout.sample.size()))) +
                                1;
    }
    return layout;
}

}  // namespace schuler::io
