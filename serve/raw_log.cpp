#include "serve/raw_log.h"

#include "schuler/core/log.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/columns.h"
#include "schuler/io/text/table.h"
#include "schuler/settings/units_of_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::serve {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t most_columns = 60, most_rows_of_picture = 20'000;

double seconds_of(io::TimeUnit unit) {
    switch (unit) {
        case io::TimeUnit::Milliseconds: return 1e-3;
        case io::TimeUnit::Microseconds: return 1e-6;
        case io::TimeUnit::Nanoseconds: return 1e-9;
        case io::TimeUnit::Seconds: break;
    }
    return 1.0;
}

struct TimeColumn {
    std::size_t column = 0;
    double scale = 1.0;  ///< to seconds
};

TimeColumn time_column(const io::TableLayout& layout, const std::vector<io::FieldRequest>& fields) {
    if (const std::optional<io::TableKind> kind = io::guess_table_kind(layout)) {
        const io::ColumnPlan plan = io::match_columns(layout, *kind);
        const io::ColumnMatch* time = plan.find("time_s");
        if (time != nullptr && static_cast<std::size_t>(time->column) < fields.size())
            return {static_cast<std::size_t>(time->column), seconds_of(time->time_unit)};
    }
    const auto named =
        std::ranges::find_if(fields, [](const io::FieldRequest& f) { return f.name.find("time") != std::string::npos; });
    return {named == fields.end() ? 0 : static_cast<std::size_t>(named - fields.begin()), 1.0};
}

/// The rows of the range with one more at each end, so that lines reach the edges of the plot. Times of a log may go back.
std::pair<std::size_t, std::size_t> range_of(const std::vector<double>& time, const RawRequest& request) {
    if (!(request.to > request.from)) return {0, time.size()};
    const auto inside = [&](double t) { return t >= request.from && t <= request.to; };
    const auto first = std::ranges::find_if(time, inside);
    if (first == time.end()) return {0, 0};
    const auto last = std::find_if(time.rbegin(), time.rend(), inside).base();
    return {static_cast<std::size_t>(first - time.begin()) - (first == time.begin() ? 0 : 1),
            static_cast<std::size_t>(last - time.begin()) + (last == time.end() ? 0 : 1)};
}

/// Of each interval the rows with the minimum and maximum of every column, and the first and last row.
std::vector<std::size_t> extremes(const std::vector<std::vector<double>>& values, std::size_t first, std::size_t last,
                                  std::size_t points) {
    const std::size_t n = last - first, intervals = std::max<std::size_t>(1, points / std::max<std::size_t>(1, values.size()));
    std::vector<std::size_t> out{first, last - 1};
    for (std::size_t k = 0; k < intervals; ++k) {
        const std::size_t begin = first + k * n / intervals, end = first + (k + 1) * n / intervals;
        for (const std::vector<double>& v : values) {
            std::size_t least = end, most = end;
            for (std::size_t r = begin; r < end; ++r) {
                if (!std::isfinite(v[r])) continue;
                if (least == end || v[r] < v[least]) least = r;
                if (most == end || v[r] > v[most]) most = r;
            }
            if (least < end) out.insert(out.end(), {least, most});
        }
    }
    std::ranges::sort(out);
    const auto twice = std::ranges::unique(out);
    out.erase(twice.begin(), twice.end());
    return out;
}

}  // namespace

Json raw_columns(const RawRequest& request) {
    WarningLog warnings;
    io::LogFiles files;
    const io::TextInput input = files.open(request.file, warnings);
    const io::TableLayout layout = io::inspect_table(input);
    std::vector<io::FieldRequest> fields;
    for (int c = 0; c < layout.columns && fields.size() < most_columns; ++c) {
        const auto k = static_cast<std::size_t>(c);
        io::FieldRequest field;
        field.column = c;
        field.name = k < layout.names.size() ? layout.names[k] : fmt::format("column {}", c + 1);
        fields.push_back(field);
    }
    std::vector<std::vector<double>> values(fields.size());
    io::TableReader reader(input, layout, fields);
    while (reader.next())
        for (std::size_t c = 0; c < fields.size(); ++c) values[c].push_back(reader.number(c));
    Json out{{"rows", 0},
             {"thinned", false},
             {"zero", 0.0},
             {"time", ""},
             {"time_s", Json::array()},
             {"columns", Json::object()},
             {"units", Json::object()}};
    if (values.empty() || values.front().empty()) return out;
    const TimeColumn time = time_column(layout, fields);
    const double first_time = values[time.column].front(), zero = std::isfinite(first_time) ? first_time : 0.0;
    std::vector<double> seconds(values[time.column].size());
    std::ranges::transform(values[time.column], seconds.begin(), [&](double t) { return (t - zero) * time.scale; });
    const auto [first, last] = range_of(seconds, request);
    const std::size_t rows = last - first;
    const bool all = request.points == 0 ? rows * fields.size() <= most_raw_values : rows <= request.points;
    std::vector<std::size_t> chosen;
    if (all)
        for (std::size_t r = first; r < last; ++r) chosen.push_back(r);
    else chosen = extremes(values, first, last, request.points == 0 ? most_rows_of_picture : request.points);
    out["rows"] = rows;
    out["thinned"] = chosen.size() < rows;
    out["zero"] = zero * time.scale;
    out["time"] = fields[time.column].name;
    const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
    for (const std::size_t r : chosen) out["time_s"].push_back(number(seconds[r]));
    for (std::size_t c = 0; c < fields.size(); ++c) {
        if (c == time.column) continue;
        const std::string& name = fields[c].name;
        Json column = Json::array();
        for (const std::size_t r : chosen) column.push_back(number(values[c][r]));
        out["columns"][name] = std::move(column);
        const bool stated = c < layout.units.size() && !layout.units[c].empty();
        out["units"][name] = stated ? layout.units[c] : std::string(settings::unit_of_key(name).plain);
    }
    return out;
}

}  // namespace schuler::serve
