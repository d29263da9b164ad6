// Tables in text files: layout by inspection, and a reader of selected columns without allocation per row.
#pragma once

#include "schuler/core/error.h"
#include "schuler/io/text/detail/last_number.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/text_input.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::io {

/// Notation of a table.
struct TableLayout {
    std::string file;                              ///< name used in messages
    char delimiter = ',';                          ///< ',', ';', '\t' or ' ' (any run of blanks)
    bool decimal_comma = false;                    ///< numbers are written as 1,5 (with ';' or tab between columns)
    std::vector<std::string> names;                ///< of the columns; empty without a header line
    std::vector<std::string> units;                ///< from a line of units below the header, else empty
    int columns = 0;                               ///< named ones, or those of the data without a header
    int data_columns = 0;                          ///< fields in most of the data lines
    long header_line = 0;                          ///< 0: none
    long first_data_line = 0;                      ///< 0: no data
    std::vector<std::string> comments;             ///< the first comment lines
    std::vector<std::vector<std::string>> sample;  ///< fields of the first data lines (up to 50)
    std::size_t size_bytes = 0;
    std::size_t estimated_rows = 0;  ///< from the size of the file; 0 if unknown
    bool compressed = false;
};

/// Determines delimiter, header and number of columns from the first lines. Recognises `#` and `%` comments (which may contain a
/// header), CRLF, a byte order mark, quotes, a trailing delimiter, decimal commas, a line of units.
/// Throws Error(Input): as LineBlocks, and if the file is empty.
[[nodiscard]] TableLayout inspect_table(const TextInput& input);

/// Text from between quotes: a quote in it is written twice.
[[nodiscard]] std::string unquoted(std::string_view text, char quote);

/// The fields of one line (without its line end), trimmed and unquoted.
[[nodiscard]] std::vector<std::string> split_fields(std::string_view line, char delimiter);

/// An Angle is a number that may have the letter of its hemisphere (40.09N).
enum class FieldKind { Number, Angle, Time, Text };

/// A column to be read.
struct FieldRequest {
    int column = -1;  ///< 0-based
    FieldKind kind = FieldKind::Number;
    double factor = 1.0;  ///< result = number * factor + offset
    double offset = 0.0;
    TimeUnit unit = TimeUnit::Seconds;  ///< for a Time field
    bool required = true;
    std::string name;    ///< used in messages
    int companion = -1;  ///< column of the letter of the hemisphere of an Angle, or of the fraction of a Time in whole seconds
    TimeUnit companion_unit = TimeUnit::Nanoseconds;  ///< of that fraction
    bool companion_date = false;                      ///< the companion of a Time of day is its date
    bool degrees_minutes = false;                     ///< an Angle of whole degrees times 100 and minutes
};

/// Reads the requested columns row by row. Numbers are the nearest doubles; times are exact nanoseconds. A field of an optional
/// column that is not a number is NaN (a time: missing); in a required one it is a problem of the row.
class TableReader {
public:
    static constexpr std::int64_t no_time = std::numeric_limits<std::int64_t>::min();

    TableReader(const TextInput& input, const TableLayout& layout, std::vector<FieldRequest> fields);

    /// Moves to the next data row; false at the end. Throws Error(Input) for a truncated last line: fewer fields than the table
    /// has columns and no line end. A complete last line without line end is kept unless its last number is shorter than the one
    /// above (it is then dropped and last_line_dropped() is true).
    [[nodiscard]] bool next();

    [[nodiscard]] double number(std::size_t field) const { return numbers_[field]; }
    [[nodiscard]] std::int64_t time_ns(std::size_t field) const { return times_[field]; }
    /// Valid until the next row.
    /// Without the quotes around it; one inside, which is written twice, is still there twice.
    [[nodiscard]] std::string_view text(std::size_t field) const { return texts_[field]; }
    [[nodiscard]] long line() const { return line_; }
    /// False if a required field of this row is missing or not a number.
    [[nodiscard]] bool row_ok() const { return problem_field_ < 0; }
    /// Describes the problem of this row (row_ok() is false), with file, line, column and its name.
    [[nodiscard]] Error row_error(const std::string& hint) const;
    /// The same for a field of this row that is not required, and has no number.
    [[nodiscard]] Error missing_error(std::size_t field, const std::string& hint) const;
    /// An error about a field of this row.
    [[nodiscard]] Error field_error(std::size_t field, const std::string& what, const std::string& hint) const;
    [[nodiscard]] bool last_line_dropped() const { return last_line_dropped_; }
    [[nodiscard]] long last_line() const { return line_; }

private:
    struct Slot {
        FieldKind kind;
        TimeUnit unit;
        bool scaled;
        double factor, offset;
        bool degrees_minutes;
    };
    bool next_block();
    const char* read_row(const char* p);
    const char* read_field(const char* p, std::size_t field);
    const char* field_text(const char* p, std::string_view& text) const;
    [[nodiscard]] bool field_ends_at(const char* p) const;
    void missing(std::size_t field, std::string_view text);
    void complete();
    [[nodiscard]] bool last_line_complete(const char* start, const char* stop) const;

    LineBlocks blocks_;
    std::string file_;
    char delimiter_;
    bool decimal_comma_;
    int data_columns_;
    long first_data_line_;
    std::vector<FieldRequest> requests_;
    std::vector<Slot> slots_;
    std::vector<std::pair<std::size_t, std::size_t>> companions_;  ///< a field and the one that completes it
    std::vector<int> field_of_column_;                             ///< -1: skipped
    std::vector<int> next_field_;                                  ///< another request for the same column, or -1
    std::vector<double> numbers_;
    std::vector<std::int64_t> times_;
    std::vector<std::string_view> texts_;
    const char* p_ = nullptr;
    const char* end_ = nullptr;
    const char* previous_row_ = nullptr;  ///< the previous row in this block
    detail::LastNumber above_;            ///< of the last row before this block
    long line_ = 0;
    int problem_field_ = -1;
    std::string_view problem_text_;
    bool last_line_dropped_ = false;
};

}  // namespace schuler::io
