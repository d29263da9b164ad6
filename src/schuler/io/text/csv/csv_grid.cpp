#include "schuler/io/text/csv/csv_grid.h"

#include "schuler/core/units.h"
#include "schuler/io/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace schuler::io {

GeodeticGrid read_grid_csv(const TextInput& input, const std::vector<std::string>& columns, double factor) {
    const TableLayout layout = inspect_table(input);
    std::vector<std::string> names{"lat_deg", "lon_deg"};
    names.insert(names.end(), columns.begin(), columns.end());
    std::vector<FieldRequest> fields;
    for (const std::string& name : names) {
        const auto found = std::ranges::find(layout.names, name);
        if (found == layout.names.end())
            throw input_error(fmt::format("a grid needs a column {}", name), {layout.file, layout.header_line, 0, name},
                              fmt::format("write the header {}", fmt::join(names, ",")));
        fields.push_back({.column = static_cast<int>(found - layout.names.begin()), .name = name});
    }
    TableReader reader(input, layout, fields);
    std::map<std::pair<double, double>, Eigen::Vector3d> points;  // in order of latitude, then longitude
    std::vector<double> lat, lon;
    while (reader.next()) {
        if (!reader.row_ok()) throw reader.row_error("give a number, or leave the whole file out");
        const double degrees[] = {reader.number(0), reader.number(1)};
        for (std::size_t k = 0; k < 2; ++k)
            if (!(std::abs(degrees[k]) <= (k == 0 ? 90.0 : 360.0)))
                throw reader.field_error(k, "is not a valid position on the Earth", "give degrees");
        Eigen::Vector3d value = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < columns.size(); ++k) value(static_cast<int>(k)) = factor * reader.number(k + 2);
        if (!value.allFinite()) throw reader.field_error(2, "is not finite", "give a number");
        if (!points.emplace(std::pair(degrees[0], degrees[1]), value).second)
            throw reader.field_error(0, "and lon_deg are those of a point above", "give every point once");
        lat.push_back(degrees[0]);
        lon.push_back(degrees[1]);
    }
    for (std::vector<double>* axis : {&lat, &lon}) {
        std::ranges::sort(*axis);
        axis->erase(std::unique(axis->begin(), axis->end()), axis->end());
    }
    if (lat.size() < 2 || lon.size() < 2)
        throw input_error(fmt::format("has {} latitudes and {} longitudes", lat.size(), lon.size()), {layout.file, 0, 0, {}},
                          "a grid has at least two of each");
    std::vector<Eigen::Vector3d> values;
    for (const double a : lat)
        for (const double o : lon) {
            const auto point = points.find({a, o});
            if (point == points.end())
                throw input_error(
                    fmt::format("lacks the point lat_deg {:g}, lon_deg {:g}", a, o), {layout.file, 0, 0, {}},
                    "a grid has a value for every latitude at every longitude; write both with the same digits everywhere");
            values.push_back(point->second);
        }
    for (std::vector<double>* axis : {&lat, &lon})
        for (double& x : *axis) x *= units::deg;
    return {std::move(lat), std::move(lon), std::move(values)};
}

}  // namespace schuler::io
