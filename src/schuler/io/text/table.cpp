#include "schuler/io/text/table.h"

#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/detail/comment.h"
#include "schuler/io/text/detail/companion_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace schuler::io {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Degrees times 100 plus minutes; NaN with sixty minutes or more.
double degrees_of(double value) {
    const double size = std::abs(value), degrees = std::floor(size / 100.0), minutes = size - 100.0 * degrees;
    return minutes < 60.0 ? std::copysign(degrees + minutes / 60.0, value) : nan;
}

const char* without_line_end(const char* start, const char* stop) {
    while (stop > start && is_line_end(stop[-1])) --stop;
    return stop;
}

}  // namespace

TableReader::TableReader(const TextInput& input, const TableLayout& layout, std::vector<FieldRequest> fields)
    : blocks_(input),
      file_(input.name()),
      delimiter_(layout.delimiter),
      decimal_comma_(layout.decimal_comma),
      data_columns_(layout.data_columns),
      first_data_line_(layout.first_data_line),
      requests_(std::move(fields)) {
    for (std::size_t i = 0, n = requests_.size(); i < n; ++i) {
        const FieldRequest& r = requests_[i];
        if (r.companion < 0) continue;
        companions_.emplace_back(i, requests_.size());
        requests_.push_back({.column = r.companion,
                             .kind = r.kind == FieldKind::Time && !r.companion_date ? FieldKind::Time : FieldKind::Text,
                             .unit = r.companion_unit,
                             .required = false,
                             .name = r.name});
    }
    next_field_.assign(requests_.size(), -1);
    numbers_.assign(requests_.size(), nan);
    times_.assign(requests_.size(), no_time);
    texts_.resize(requests_.size());
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        const FieldRequest& r = requests_[i];
        slots_.push_back({r.kind, r.unit, r.factor != 1.0 || r.offset != 0.0, r.factor, r.offset, r.degrees_minutes});
        if (r.column < 0) continue;
        const auto column = static_cast<std::size_t>(r.column);
        if (field_of_column_.size() <= column) field_of_column_.resize(column + 1, -1);
        next_field_[i] = field_of_column_[column];
        field_of_column_[column] = static_cast<int>(i);
    }
}

bool TableReader::next_block() {
    // A last line without line end is in a separate block: keep the required data of the row above.
    if (previous_row_ != nullptr) above_ = detail::last_number({previous_row_, static_cast<std::size_t>(end_ - previous_row_)});
    if (first_data_line_ == 0 || !blocks_.next()) return false;
    if (decimal_comma_) std::replace(blocks_.data(), blocks_.data() + (blocks_.end() - blocks_.begin()), ',', '.');
    p_ = blocks_.begin();
    end_ = blocks_.end();
    line_ = blocks_.first_line() - 1;
    previous_row_ = nullptr;
    return true;
}

bool TableReader::next() {
    for (;;) {
        if (p_ == end_ && !next_block()) return false;
        const char* start = p_;
        const char* p = p_;
        ++line_;
        while (*p == ' ' || *p == '\t') ++p;
        const bool skip = is_line_end(*p) || detail::is_comment({p, 2}) || line_ < first_data_line_;
        if (!skip) {
            problem_field_ = -1;
            p = read_row(delimiter_ == '\t' ? start : p);
            for (std::size_t i = 0; i < slots_.size(); ++i)
                if (slots_[i].degrees_minutes && !std::isnan(numbers_[i])) {
                    numbers_[i] = slots_[i].factor * degrees_of(numbers_[i] / slots_[i].factor);
                    texts_[i] = {};
                }
            if (!companions_.empty()) complete();
        }
        if (*p != '\n') p = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end_ - p)));
        p_ = p + 1;
        if (skip) continue;
        if (p_ == end_ && blocks_.ended_without_newline() && !last_line_complete(start, p)) {
            last_line_dropped_ = true;
            return false;
        }
        previous_row_ = start;
        return true;
    }
}

/// Reads the requested fields of a line; returns its end position, at or before the line end.
const char* TableReader::read_row(const char* p) {
    const std::size_t count = field_of_column_.size();
    std::size_t column = 0;
    for (; column < count; ++column) {
        while (*p == ' ' || (*p == '\t' && delimiter_ != '\t')) ++p;
        if (is_line_end(*p)) break;
        int field = field_of_column_[column];
        const char* stop;
        if (field < 0) {
            std::string_view text;
            stop = field_text(p, text);
        } else {
            do {
                stop = read_field(p, static_cast<std::size_t>(field));
                field = next_field_[static_cast<std::size_t>(field)];
            } while (field >= 0);
        }
        p = (*stop == delimiter_ && delimiter_ != ' ') ? stop + 1 : stop;
    }
    for (; column < count; ++column) {
        for (int field = field_of_column_[column]; field >= 0; field = next_field_[static_cast<std::size_t>(field)]) {
            missing(static_cast<std::size_t>(field), {});
        }
    }
    return p;
}

/// Adds fractions to whole seconds and dates to times of day, and gives angles the sign of their hemisphere; the value is missing if that is.
void TableReader::complete() {
    for (const auto& [field, other] : companions_) {
        if (slots_[field].kind == FieldKind::Time) {
            constexpr std::int64_t second = 1'000'000'000;
            if (times_[field] == no_time) continue;
            if (requests_[field].companion_date) {
                constexpr std::int64_t day = 86'400 * second;
                if (const auto days = detail::days_of_date(texts_[other], false)) times_[field] += *days * day;
                else missing(field, texts_[other]);
                continue;
            }
            if (times_[other] < 0 || times_[other] >= second) missing(field, {});
            else times_[field] += times_[other];
        } else if (!std::isnan(numbers_[field])) {
            const int sign = detail::hemisphere_sign(texts_[other]);
            if (sign == 0) missing(field, texts_[other]);
            else if (sign < 0) numbers_[field] = -std::abs(numbers_[field]);
        }
    }
}

bool TableReader::field_ends_at(const char* p) const {
    return *p == delimiter_ || is_line_end(*p) || (delimiter_ == ' ' && *p == '\t');
}

const char* TableReader::read_field(const char* p, std::size_t field) {
    const Slot& slot = slots_[field];
    if (slot.kind != FieldKind::Text) {
        Decimal d;
        const char* number_end = scan_decimal(p, d);
        if (number_end != nullptr) {
            const char* stop = number_end;
            while (!field_ends_at(stop) && (*stop == ' ' || *stop == '\t')) ++stop;
            if (field_ends_at(stop)) [[likely]] {
                if (slot.kind != FieldKind::Time) {
                    const double value = value_of(d, p, number_end);
                    numbers_[field] = slot.scaled ? value * slot.factor + slot.offset : value;
                    if (std::isnan(value)) missing(field, {p, static_cast<std::size_t>(number_end - p)});
                } else if (!nanoseconds_of(d, slot.unit, p, number_end, times_[field])) {
                    missing(field, {p, static_cast<std::size_t>(number_end - p)});
                }
                return stop;
            }
        }
    }
    std::string_view text;
    const char* stop = field_text(p, text);
    if (slot.kind == FieldKind::Text) {
        texts_[field] = text;
        if (text.empty()) missing(field, text);
    } else if (slot.kind != FieldKind::Time) {
        // a number in quotation marks, or one with its hemisphere
        const double value = slot.kind == FieldKind::Angle ? detail::angle_with_hemisphere(text) : number_from(text);
        numbers_[field] = value * slot.factor + slot.offset;
        if (std::isnan(value)) missing(field, text);
    } else if (!nanoseconds_from(text, slot.unit, times_[field])) {
        if (const auto ns = detail::calendar_nanoseconds(text)) times_[field] = *ns;
        else missing(field, text);
    }
    return stop;
}

/// The text of the field at p, without surrounding blanks and quotes; returns its end.
const char* TableReader::field_text(const char* p, std::string_view& text) const {
    const char* start = p;
    if (*p == '"' || *p == '\'') {
        const char* close = p + 1;
        while (!is_line_end(*close) && (*close != *start || close[1] == *start)) close += *close == *start ? 2 : 1;
        if (*close == *start) {
            text = trimmed({start + 1, static_cast<std::size_t>(close - start - 1)});
            p = close + 1;
            while (!field_ends_at(p)) ++p;
            return p;
        }
    }
    while (!field_ends_at(p)) ++p;
    text = trimmed({start, static_cast<std::size_t>(p - start)});
    return p;
}

void TableReader::missing(std::size_t field, std::string_view text) {
    numbers_[field] = nan;
    times_[field] = no_time;
    texts_[field] = slots_[field].kind == FieldKind::Text ? std::string_view{} : text;
    if (requests_[field].required &&
        (problem_field_ < 0 || requests_[field].column < requests_[static_cast<std::size_t>(problem_field_)].column)) {
        problem_field_ = static_cast<int>(field);
        problem_text_ = text;
    }
}

/// For a file without a final line end. Throws if fields are missing; false if the last number appears truncated.
bool TableReader::last_line_complete(const char* start, const char* stop) const {
    stop = without_line_end(start, stop);
    const std::size_t fields = split_fields({start, static_cast<std::size_t>(stop - start)}, delimiter_).size();
    if (static_cast<int>(fields) < data_columns_) {
        SourcePlace place{file_, line_, static_cast<long>(fields), {}};
        throw input_error(fmt::format("the file is cut here: {} of {} columns and no line end", fields, data_columns_), place,
                          fmt::format("copy the file again, or delete line {}", line_));
    }
    return !detail::may_be_cut(above_, detail::last_number({start, static_cast<std::size_t>(stop - start)}));
}

static std::string why_missing(std::string_view text) {
    constexpr std::size_t most = 40;
    return text.empty() ? "the value is missing" : fmt::format("'{}' is not a number", text.substr(0, most));
}

Error TableReader::row_error(const std::string& hint) const {
    return field_error(static_cast<std::size_t>(std::max(problem_field_, 0)), why_missing(problem_text_), hint);
}

Error TableReader::missing_error(std::size_t field, const std::string& hint) const {
    return field_error(field, why_missing(texts_[field]), hint);
}

Error TableReader::field_error(std::size_t field, const std::string& what, const std::string& hint) const {
    const FieldRequest& r = requests_[field];
    return input_error(what, {file_, line_, r.column + 1, r.name}, hint);
}

}  // namespace schuler::io
