#include "schuler/io/text/detail/sample_rows.h"

#include "schuler/io/place.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::io::detail {
namespace {

constexpr double bad_share = 0.05, leading_share = 0.5;
constexpr double back_share = 0.10;

std::string names_of(const TableLayout& layout) {
    std::string text;
    for (std::size_t i = 0; i < layout.names.size() && i < 40; ++i) text += (i > 0 ? ", " : "") + layout.names[i];
    return text;
}

std::string seconds_text(std::int64_t ns) { return fmt::format("{:.9g} s", static_cast<double>(ns) * 1e-9); }

}  // namespace

SampleColumns::SampleColumns(const TextInput& input, TableKind kind, const CsvOptions& options)
    : input_(input),
      layout_(inspect_table(input)),
      plan_(match_columns(layout_, kind, {options.columns, options.scale, options.time_unit})) {
    if (layout_.names.empty() && options.columns.empty()) {
        throw input_error(
            "there is no header line that names the columns", place_in(input.name(), 1),
            fmt::format("put one first (time_s, ...), or number them: [{}] columns = {{ time_s = \"#1\", ... }}", section()));
    }
    if (layout_.first_data_line == 0) {
        throw input_error("there are no rows below the header", place_in(input.name(), layout_.header_line),
                          "check that the log was written and copied completely");
    }
}

Error SampleColumns::missing(const std::string& canonical) const {
    const std::string have = layout_.names.empty() ? fmt::format("{} unnamed columns", layout_.columns) : names_of(layout_);
    return input_error(
        "there is no such column, nor one known to mean it", place_in(layout_.file, layout_.header_line, 0, canonical),
        fmt::format("specify it: [{}] columns = {{ {} = \"NAME\" }}; the file has: {}", section(), canonical, have));
}

std::size_t SampleColumns::add(const std::string& canonical, bool required, double si, FieldKind kind) {
    const ColumnMatch* match = plan_.find(canonical);
    if (match == nullptr) {
        if (required) throw missing(canonical);
        return absent;
    }
    FieldRequest request = request_of(*match);
    if (request.kind != FieldKind::Angle) request.kind = kind;
    request.factor = match->factor * si;
    // A column in the SI unit (radians) must remain exactly as written, without a factor (180/pi)(pi/180).
    if (std::abs(request.factor - 1.0) < 1e-15) request.factor = 1.0;
    request.offset = match->offset * si;
    request.required = required;
    requests_.push_back(std::move(request));
    return requests_.size() - 1;
}

void RowAudit::warn(std::string_view topic, const std::string& text, std::size_t count) const {
    if (count > 0) log_.add(fmt::format("{}.{}", section_, topic), fmt::format("{}: {}", file_, text), count);
}

static std::string hint_of_bad_row(const std::string& section) {
    return fmt::format("is it the right column? write [{0}] columns = {{ ... }}, or delete the row", section);
}

void RowAudit::bad_row(const TableReader& reader) {
    const std::string hint = hint_of_bad_row(section_);
    if (counts_.bad++ == 0) {
        first_bad_line_ = reader.line();
        first_bad_.push_back(reader.row_error(hint));
    }
    if (counts_.bad == counts_.read) ++leading_;
}

void RowAudit::bad_row(const TableReader& reader, std::size_t field) {
    if (counts_.bad++ == 0) {
        first_bad_line_ = reader.line();
        first_bad_.push_back(reader.missing_error(field, hint_of_bad_row(section_)));
    }
    if (counts_.bad == counts_.read) ++leading_;
}

void RowAudit::absurd(const Error& error, const TableReader& reader) {
    if (counts_.bad++ == 0) first_bad_line_ = reader.line();
    if (absurd_++ == 0) first_absurd_.push_back(error);
    constexpr std::size_t enough = 200;  // sufficient to distinguish a wrong unit from an outlier without reading the whole file
    if (absurd_ > enough && 2 * absurd_ > counts_.read) throw first_absurd_.front();
}

void RowAudit::rolled_over(const TimeRepair& repair) {
    warn("rollover", fmt::format("the time restarts after {:.0f} s: continued", static_cast<double>(repair.period) * 1e-9),
         repair.rollovers);
}

void RowAudit::clock_away(const TimeRepair& repair, long line) {
    warn(
        "clock_away",
        fmt::format("rows, the first in line {}, are stamped by a clock that was off by {} for a while: moved back to where they "
                    "lie evenly between the others",
                    line, seconds_text(repair.step)),
        repair.away);
}

void RowAudit::finish(const TableReader& reader) {
    // an instrument that starts late has no values in its first rows: these show nothing about the column
    const auto all = static_cast<double>(counts_.read), leading = static_cast<double>(leading_);
    if (leading > leading_share * all || static_cast<double>(counts_.bad) - leading > bad_share * (all - leading)) {
        if (first_bad_.empty()) throw first_absurd_.front();
        const Error& first = first_bad_.front();
        throw input_error(
            fmt::format("{} ({} of {} rows have this or another value missing)", first.reason(), counts_.bad, counts_.read),
            first.place(), first.hint());
    }
    if (counts_.used == 0) {
        const std::string why =
            counts_.without_fix > 0 ? fmt::format("none of the {} rows has a fix", counts_.read) : "there is no usable row";
        const std::string hint =
            counts_.without_fix > 0 ? "check [gnss] fix_codes" : "check that the log was written and copied completely";
        throw input_error(why, place_in(file_), hint);
    }
    if (static_cast<double>(counts_.out_of_order) > back_share * static_cast<double>(counts_.used)) {
        throw input_error(
            fmt::format("time goes back from {} to {}, and {} of {} rows are earlier than one before them",
                        seconds_text(first_back_from_), seconds_text(first_back_to_), counts_.out_of_order, counts_.used),
            place_in(file_, first_back_line_, 0, "time"),
            "is it several logs in one file, or the wrong time column? split or name it");
    }
    warn("stray",
         fmt::format("rows skipped whose stamp lies far from those around them, the first in line {}", first_stray_line_),
         counts_.strays);
    warn("bad_rows",
         fmt::format("rows skipped because a value is missing or beyond any instrument, the first in line {}", first_bad_line_),
         counts_.bad);
    warn("out_of_order", fmt::format("rows earlier than one before them, sorted in, the first in line {}", first_back_line_),
         counts_.out_of_order);
    if (reader.last_line_dropped()) warn("cut", cut_text(reader.line()), 1);
}

}  // namespace schuler::io::detail
