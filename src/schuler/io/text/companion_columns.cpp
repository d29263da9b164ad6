#include "schuler/io/text/detail/companion_columns.h"

#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/detail/column_dictionary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace schuler::io {
namespace {

using detail::hemisphere_sign;

/// The cells of a column in the first rows, without empty ones.
std::vector<std::string_view> cells_of(const TableLayout& layout, int column) {
    std::vector<std::string_view> cells;
    const auto at = static_cast<std::size_t>(column);
    for (const std::vector<std::string>& row : layout.sample)
        if (at < row.size() && !is_missing_value(row[at])) cells.emplace_back(row[at]);
    return cells;
}

bool all_whole_below(const TableLayout& layout, int column, double limit) {
    const std::vector<std::string_view> cells = cells_of(layout, column);
    return !cells.empty() && std::ranges::all_of(cells, [&](std::string_view cell) {
        const double x = number_from(cell);
        return x >= 0.0 && x < limit && x == std::floor(x);
    });
}

struct Fraction {
    int column;
    TimeUnit unit;
};

/// The column of the same name as this one of whole seconds, but in a smaller unit and always below a second.
std::optional<Fraction> fraction_of(const TableLayout& layout, int seconds) {
    const auto words_of = [&](std::size_t i) { return words_of_name(layout.names[i]); };
    if (seconds < 0 || static_cast<std::size_t>(seconds) >= layout.names.size()) return std::nullopt;
    std::vector<std::string> stem = words_of(static_cast<std::size_t>(seconds));
    if (stem.empty() || detail::time_unit(stem.back()) != TimeUnit::Seconds) return std::nullopt;
    stem.pop_back();
    constexpr double any = 1e18;
    if (!all_whole_below(layout, seconds, any)) return std::nullopt;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        std::vector<std::string> words = words_of(i);
        const auto unit = words.empty() ? std::nullopt : detail::time_unit(words.back());
        if (!unit || *unit == TimeUnit::Seconds) continue;
        words.pop_back();
        const double second = *unit == TimeUnit::Milliseconds ? 1e3 : *unit == TimeUnit::Microseconds ? 1e6 : 1e9;
        if (words == stem && all_whole_below(layout, static_cast<int>(i), second)) return Fraction{static_cast<int>(i), *unit};
    }
    return std::nullopt;
}

/// The column of the dates that belong to a column of times of day.
int date_of(const TableLayout& layout, int times) {
    const std::vector<std::string_view> cells = cells_of(layout, times);
    const auto is_time_of_day = [](std::string_view cell) {
        constexpr std::size_t hours = 2;
        return cell.find(':') <= hours && detail::calendar_nanoseconds(cell).has_value();
    };
    if (cells.empty() || !std::ranges::all_of(cells, is_time_of_day)) return -1;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const std::vector<std::string> words = words_of_name(layout.names[i]);
        if (std::ranges::find(words, "date") == words.end()) continue;
        const std::vector<std::string_view> dates = cells_of(layout, static_cast<int>(i));
        const auto is_date = [](std::string_view cell) { return detail::days_of_date(cell, false).has_value(); };
        if (!dates.empty() && std::ranges::all_of(dates, is_date)) return static_cast<int>(i);
    }
    return -1;
}

/// How far a name says that the column holds the hemisphere of a coordinate.
enum class Named { No, Perhaps, Clearly };

Named named_hemisphere(const std::string& name, bool lat) {
    std::string text;
    bool coordinate = false;
    for (const std::string& word : words_of_name(name)) {
        text += word;
        coordinate = coordinate || word.starts_with(lat ? "lat" : "lon") || (!lat && word == "lng");
    }
    const std::string_view letters = lat ? "ns" : "ew";
    if (text == letters) return text == name ? Named::Perhaps : Named::Clearly;  // ns is also a number of satellites
    constexpr std::array<std::string_view, 10> ends{"hemi", "hemisphere", "dir", "direction", "indicator",
                                                    "ind",  "cardinal",   "ref", "ns",        "ew"};
    const bool side = std::ranges::any_of(ends, [&](std::string_view end) { return text.ends_with(end); });
    if (coordinate && side) return text.ends_with("ref") ? Named::Perhaps : Named::Clearly;
    if (text.starts_with(letters) && side && text.size() > 4) return Named::Clearly;
    return text.starts_with("hemi") || side ? Named::Perhaps : Named::No;
}

/// True if all cells are letters of this coordinate's hemispheres.
bool has_hemispheres(const std::vector<std::string_view>& cells, bool lat) {
    return !cells.empty() && std::ranges::all_of(cells, [&](std::string_view cell) {
        const char c = static_cast<char>(cell.front() | 0x20);
        return hemisphere_sign(cell) != 0 && (lat ? c == 'n' || c == 's' : c == 'e' || c == 'w');
    });
}

int hemisphere_of(const TableLayout& layout, const ColumnMatch& coordinate) {
    const bool lat = coordinate.canonical == "lat_deg";
    int best = -1, best_rank = 0;
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        const int column = static_cast<int>(i);
        if (column == coordinate.column) continue;
        const Named named = named_hemisphere(layout.names[i], lat);
        const bool beside = std::abs(column - coordinate.column) == 1;
        if (named == Named::No && !beside) continue;
        const std::vector<std::string_view> cells = cells_of(layout, column);
        const bool letters = has_hemispheres(cells, lat);
        const bool text = std::ranges::any_of(cells, [](std::string_view c) { return std::isnan(number_from(c)); });
        if (named == Named::Clearly && text && !letters)
            throw input_error(fmt::format("'{}' is no hemisphere of the {}", cells.front(), lat ? "latitude" : "longitude"),
                              place_in(layout.file, layout.first_data_line, column + 1, layout.names[i]),
                              lat ? "write N or S, or signed latitudes" : "write E or W, or signed longitudes");
        if (!letters && !(named == Named::Clearly && cells.empty())) continue;
        const int rank = 1 + (beside ? 1 : 0) + (named == Named::Clearly ? 2 : 0);
        if (rank > best_rank) {
            best = column;
            best_rank = rank;
        }
    }
    return best;
}

}  // namespace

FieldRequest request_of(const ColumnMatch& match) {
    FieldRequest request;
    request.column = match.column;
    request.kind = match.canonical.find("time") != std::string::npos              ? FieldKind::Time
                   : match.canonical == "lat_deg" || match.canonical == "lon_deg" ? FieldKind::Angle
                   : match.canonical == "fix"                                     ? FieldKind::Text
                                                                                  : FieldKind::Number;
    request.factor = match.factor;
    request.offset = match.offset;
    request.unit = match.time_unit;
    request.companion = match.companion;
    request.companion_unit = match.companion_unit;
    request.companion_date = match.companion_date;
    request.degrees_minutes = match.degrees_minutes;
    request.name = match.file_name;
    return request;
}

namespace detail {

bool is_fraction_of_seconds(const TableLayout& layout, int column) {
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
        if (static_cast<int>(i) == column) continue;
        const std::optional<Fraction> fraction = fraction_of(layout, static_cast<int>(i));
        if (fraction && fraction->column == column) return true;
    }
    return false;
}

bool holds_dates(const TableLayout& layout, int column) {
    const std::vector<std::string_view> cells = cells_of(layout, column);
    return !cells.empty() && std::ranges::all_of(cells, [](std::string_view cell) {
        return cell.find_first_of("-/.") < cell.find(':') && calendar_nanoseconds(cell).has_value();
    });
}

double repeated_share(const TableLayout& layout, int column) {
    if (fraction_of(layout, column)) return 0.0;
    std::size_t steps = 0, repeated = 0;
    const auto at = static_cast<std::size_t>(column);
    for (std::size_t i = 1; i < layout.sample.size(); ++i) {
        const std::vector<std::string>&a = layout.sample[i - 1], &b = layout.sample[i];
        if (at >= a.size() || at >= b.size()) continue;
        ++steps;
        if (a[at] == b[at]) ++repeated;
    }
    return steps == 0 ? 0.0 : static_cast<double>(repeated) / static_cast<double>(steps);
}

void find_companions(ColumnPlan& plan, const TableLayout& layout) {
    for (ColumnMatch& match : plan.matches) {
        if (match.canonical == "lat_deg" || match.canonical == "lon_deg") {
            match.companion = hemisphere_of(layout, match);
        } else if (match.canonical == "time_s" && match.time_unit == TimeUnit::Seconds) {
            if (const std::optional<Fraction> fraction = fraction_of(layout, match.column)) {
                match.companion = fraction->column;
                match.companion_unit = fraction->unit;
            } else if (const int date = date_of(layout, match.column); date >= 0) {
                match.companion = date;
                match.companion_date = true;
            }
        }
    }
    std::vector<int> taken;
    for (const ColumnMatch& match : plan.matches)
        if (match.companion >= 0) taken.push_back(match.companion);
    std::erase_if(plan.matches, [&](const ColumnMatch& match) {
        return match.certainty != Certainty::Given && std::ranges::find(taken, match.column) != taken.end();
    });
}

int hemisphere_sign(std::string_view text) {
    std::string word(trimmed(text));
    std::ranges::transform(word, word.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (word == "n" || word == "e" || word == "north" || word == "east") return 1;
    return word == "s" || word == "w" || word == "south" || word == "west" ? -1 : 0;
}

double angle_with_hemisphere(std::string_view text) {
    text = trimmed(text);
    int sign = 0;
    if (!text.empty()) sign = hemisphere_sign(text.substr(text.size() - 1));
    if (sign != 0) text.remove_suffix(1);
    else if (!text.empty() && (sign = hemisphere_sign(text.substr(0, 1))) != 0) text.remove_prefix(1);
    text = trimmed(text);
    constexpr std::string_view degree = "\xc2\xb0";
    if (text.ends_with(degree)) text = trimmed(text.substr(0, text.size() - degree.size()));
    const double value = number_from(text);
    return sign < 0 ? -std::abs(value) : value;
}

}  // namespace detail
}  // namespace schuler::io
